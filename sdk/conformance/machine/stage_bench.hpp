/// Plays the runtime for one stage: calls it as a host does, keeps what it publishes, writes and saves.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench.hpp"
#include "feed.hpp"
#include "temporary_folder.hpp"
#include "watch.hpp"

namespace pelorus::conformance {

using Bytes = std::vector<unsigned char>;

/// What a call answered.
struct Answer {
    plr_status status = PLR_OK;
    std::string told;  ///< `PLR_E_DATA: message`
    bool is_ok() const noexcept { return status == PLR_OK; }
    bool is_refusal() const noexcept { return status == PLR_E_DATA; }
};

struct PlayOptions {
    std::filesystem::path folder;  ///< result folder; empty: one of its own
    unsigned threads = 1;
    unsigned watch = 0;                    ///< watch::Concern, in receive, emit and finish
    bool keeps_published = true;           ///< false: counted and thrown away
    std::uint32_t extra_struct_bytes = 0;  ///< see Surroundings
    std::optional<plr_key> key;
};
/// Plays with a result folder that others have had or will have.
inline PlayOptions in_folder(const TemporaryFolder& folder) {
    PlayOptions options;
    options.folder = folder.path();
    return options;
}

/// A stage that is run, step by step.
class StagePlayer {
public:
    explicit StagePlayer(const Bench& bench, PlayOptions options = {});
    ~StagePlayer();
    StagePlayer(const StagePlayer&) = delete;
    StagePlayer& operator=(const StagePlayer&) = delete;

    const Instance& instance() const noexcept { return *instance_; }
    Services& services() noexcept { return services_; }
    bool is_source() const noexcept { return table().emit != nullptr; }
    bool saves() const noexcept { return table().save != nullptr; }
    std::filesystem::path folder() const { return services_.output_folder; }
    std::map<std::string, std::string> files() const;

    Answer receive(std::uint32_t port, const plr_message& message);
    plr_next next();
    Answer emit(std::int64_t arrival);
    Answer finish();
    /// Fails the check where it cannot.
    Bytes save();
    Answer load(const Bytes& bytes);
    /// The clock of the run (ns): where a resumed one begins, and where it has come to.
    void set_time(std::int64_t time) noexcept { last_time_ = time; }
    std::int64_t time() const noexcept { return last_time_; }
    /// Ends the instance, finished or not.
    void destroy() { instance_.reset(); }

    /// receive; fails the check for any answer but PLR_OK and PLR_E_DATA.
    Answer deliver(const Delivery& delivery);
    /// The next event of a source, if there is one now; fails the check unless it is emitted well.
    bool emit_next();
    /// finish; fails the check unless it went well.
    void finish_well();

    const std::vector<PublishedMessage>& published() const noexcept { return services_.published; }
    /// The first thing that the watch saw, and in which call.
    watch::Offence offence;
    std::string offence_in;
    /// Which allocation of the next receive, emit or finish fails, see watch::fail_allocation; negative: none.
    std::int64_t failing_allocation = -1;

private:
    const plr_stage& table() const noexcept { return instance_->table<plr_stage>(); }
    template <class Body> Answer call(const char* function, std::int64_t time, bool publishes, Body&& body);

    PlayOptions options_;
    std::unique_ptr<TemporaryFolder> own_folder_;
    Services services_;
    std::unique_ptr<Instance> instance_;
    std::vector<std::uint64_t> scratch_;
    std::int64_t last_time_ = 0;
};

/// What a stage is made to do: deliveries, and events of a source, in turn.
struct Script {
    std::vector<Delivery> deliveries;
    std::size_t events = 0;  ///< at most so many, of a source
    std::size_t steps() const noexcept { return std::max(deliveries.size(), events); }
};
/// A script of plain messages for the subject, without ports that need not be connected and answer PLR_E_UNSUPPORTED.
Script plain_script(const Bench& bench, const FeedOptions& options = {});
/// Plays steps first to last - 1.
void play(StagePlayer& player, const Script& script, std::size_t first, std::size_t last);
void play(StagePlayer& player, const Script& script);

/// What a whole run leaves.
struct Trace {
    std::vector<PublishedMessage> published;
    std::map<std::string, std::string> files;
};
Trace trace_of(StagePlayer& player);
/// Where two runs differ, in words; "" where they do not.
std::string difference_of(const Trace& one, const Trace& other);
/// Where two states saved differ: `byte 12 of 40`; "" where they do not.
std::string difference_of(const Bytes& one, const Bytes& other);

}  // namespace pelorus::conformance
