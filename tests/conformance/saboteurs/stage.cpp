// A stage that passes scans on, their ids counted, with what any stage may do wrong.
#include <chrono>
#include <cstdlib>
#include <list>

#include <pelorus/pelorus.hpp>

#include "defect.h"

namespace {

using Bytes = std::vector<unsigned char>;

struct Saboteur : pelorus::Stage<Saboteur> {
    static constexpr const char* kind = "registration";
    using Base = pelorus::Stage<Saboteur>;

    std::string frame;
    const plr_parallel* parallel = nullptr;
    double ignored = 0, more = 0;

    // What evolves.
    std::uint64_t passed = 0;
    std::int64_t newest = 0, gaps = 0;     // ns
    std::vector<double> last_measurement;  // of the newest scan, with its id
    std::uint64_t last_id = 0;

    // What defects keep besides.
    const std::uint64_t* kept = nullptr;
    mutable std::uint64_t saves = 0;
    std::list<int> hoard;
    std::vector<std::uint64_t> copied;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A stage with a defect").purpose("Passes scans on, for the proof that the suites can fail.");
        plugin.in_port("scans", PLR_MESSAGE_SCAN, "of one radar");
        plugin.out_port("scans", PLR_MESSAGE_SCAN, "the same");
        plugin.out_port("results", PLR_MESSAGE_TABLE, "scalars passed, gaps");
        if (!DEFECT("config-is-stepped.stage")) return;
        plugin.parameter("ignored", &Saboteur::ignored).initially("3").doc("of no use");
        plugin.parameter("more", &Saboteur::more).initially("5").doc("counted besides");
    }
    void setup(const pelorus::Setup& setup) {
        frame = setup.frame();
        if (DEFECT("config-is-stepped.stage")) more = setup.raw().values[1].number;
        parallel = setup.optional_service<plr_parallel>();
        if (NEAR_MISS("stage-reads-no-clock"))
            hoard.push_back(static_cast<int>(std::chrono::steady_clock::now().time_since_epoch().count() & 1));
    }
    pelorus::Stream radar() const {
        pelorus::Stream stream;
        stream.sensor = "radar";
        stream.space = pelorus::position_space(3);
        stream.frame = frame;
        return stream;
    }
    std::vector<pelorus::Stream> in_streams(std::uint32_t) const {
        pelorus::Stream stream = radar();
        if (NEAR_MISS("stage-ports-say-what-they-carry")) stream.any_frame = true;
        return {stream};
    }
    std::vector<pelorus::Stream> out_streams(std::uint32_t port) const {
        if (port != 0 || NEAR_MISS("stage-publishes-what-it-declares")) return {};
        pelorus::Stream stream = radar();
        if (DEFECT("stage-ports-say-what-they-carry")) stream.any_frame = true;
        return {stream};
    }
    std::uint32_t passes_on(std::uint32_t port) const {
        return port == 0 && NEAR_MISS("stage-publishes-what-it-declares") ? 1 : 0;
    }

    void on_scan(const pelorus::Event& event, const plr_scan& scan) {
        refuse(event, scan);
        misbehave(scan);
        plr_scan copy = scan;
        if (DEFECT("stage-publishes-what-it-declares")) copy.frame = "radar_axes";
        std::vector<double> own;
        if (NEAR_MISS("stage-leaves-messages-alone") && scan.measurements.count > 0) {
            own.assign(scan.measurements.data, scan.measurements.data + 3 * scan.measurements.count);
            own[0] += 1;
            copy.measurements.data = own.data();
        }
        publish_scan(copy, event.time);
        if (NEAR_MISS("stage-resumes-bit-for-bit")) copied.push_back(passed);  // not saved, and never told
        if (passed > 0) gaps += event.time - newest;
        newest = event.time;
        ++passed;
        if (scan.measurements.count > 0) {
            last_measurement.assign(scan.measurements.data, scan.measurements.data + 3);
            last_id = scan.ids[0];
        }
        if (NEAR_MISS("stage-publishes-only-when-it-may") && passed % 5 == 0) publish_results(event.time);
    }

    void finish(const pelorus::Event& event) {
        if (DEFECT("stage-ends-at-any-time") && passed == 0) throw pelorus::NumericError("there is no mean of nothing");
        if (DEFECT("stage-finish-repeats-nothing") && last_id != 0) publish_last(newest);
        if (NEAR_MISS("stage-finish-repeats-nothing") && last_id != 0) publish_last(newest + 1);
        if (NEAR_MISS("stage-ends-at-any-time") && passed == 0) return;  // nothing to tell
        publish_results(event.time);
    }

    template <class Archive> void state(Archive& archive) {
        archive(passed, newest, last_measurement, last_id);
        if (!DEFECT("stage-resumes-bit-for-bit")) archive(gaps);
        if (DEFECT("stage-state-resaves") && !Archive::reading) ++saves;
        if (DEFECT("stage-state-resaves")) archive(saves);
        if (NEAR_MISS("stage-state-resaves")) {
            std::string constant = "always the same";
            archive(constant);
        }
    }
    static const plr_stage& table() noexcept {
        static const plr_stage own = [] {
            plr_stage changed = Base::table();
            changed.save = &save;
            changed.load = &load;
            return changed;
        }();
        return own;
    }

private:
    void refuse(const pelorus::Event& event, const plr_scan& scan) {
        if (DEFECT("stage-takes-what-it-asks-for") && std::string(scan.sensor) != "Radar")
            throw pelorus::DataError("there is no sensor " + std::string(scan.sensor));
        if (NEAR_MISS("stage-takes-what-it-asks-for") && event.time == 0) throw pelorus::DataError("too early");
        // Every other scan, with or without memory.
        if (NEAR_MISS("stage-survives-lack-of-memory") && event.time / 1'000'000'000 % 2 == 0)
            throw pelorus::DataError("is one too many");
        const bool is_late = passed > 0 && event.time < newest;
        if (DEFECT("stage-survives-disorder") && is_late) throw pelorus::ArgumentError("is older than the newest scan");
        if (NEAR_MISS("stage-survives-disorder") && is_late) throw pelorus::DataError("is older than the newest scan");
        if (is_late && DEFECT("stage-refusal-changes-nothing")) ++passed;
        if (is_late && (DEFECT("stage-refusal-changes-nothing") || NEAR_MISS("stage-refusal-changes-nothing")))
            throw pelorus::DataError("is older than the newest scan");
        const bool is_bare = scan.measurements.count > 0 && scan.covariances.data == nullptr;
        if (DEFECT("stage-survives-odd-messages") && scan.measurements.count > 0)
            if (*static_cast<const volatile double*>(scan.covariances.data) < 0)
                throw pelorus::DataError("is negative");
        if (NEAR_MISS("stage-survives-odd-messages") && is_bare) throw pelorus::DataError("has no covariances");
    }

    void misbehave(const plr_scan& scan) {
        if (DEFECT("stage-leaves-messages-alone") && scan.measurements.count > 0) {
            auto* const first = const_cast<volatile double*>(scan.measurements.data);
            *first = *first;  // what an in-place correction by zero does
        }
        if (DEFECT("stage-keeps-no-message")) {
            if (kept != nullptr) copied = {*static_cast<const volatile std::uint64_t*>(kept)};
            kept = scan.measurements.count > 0 ? scan.ids : nullptr;
        }
        if (NEAR_MISS("stage-keeps-no-message")) copied.assign(scan.ids, scan.ids + scan.measurements.count);
        if (DEFECT("stage-reads-no-clock"))
            copied = {static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count())};
        if (DEFECT("stage-memory-is-bounded")) hoard.push_back(1);
        if (NEAR_MISS("stage-memory-is-bounded")) {
            hoard.push_back(1);
            if (hoard.size() > 20) hoard.pop_front();
        }
        if (DEFECT("stage-survives-lack-of-memory") || NEAR_MISS("stage-survives-lack-of-memory")) {
            void* (*volatile const take)(std::size_t) = &std::malloc;  // or the compiler does without it
            auto* const room = static_cast<double*>(take(sizeof(double)));
            if (room == nullptr && NEAR_MISS("stage-survives-lack-of-memory")) throw std::bad_alloc();
            *static_cast<volatile double*>(room) = 1;
            std::free(room);
        }
    }

    void publish_scan(const plr_scan& scan, std::int64_t time) {
        plr_message message{};
        message.struct_size = sizeof message;
        message.kind = PLR_MESSAGE_SCAN;
        message.time = time;
        message.arrival = INT64_MIN;
        message.body.scan = &scan;
        publish(0, message);
    }
    /// The first measurement of the newest scan; of a scan of one measurement without covariance, the whole of it.
    void publish_last(std::int64_t time) {
        pelorus::ScanBuilder scan("radar", frame, pelorus::position_space(3));
        publish(0, scan.message(time));
        if (DEFECT("stage-finish-repeats-nothing")) publish(0, scan.message(time));
    }
    void publish_results(std::int64_t time) {
        static std::uint64_t in_all = 0;
        static const double unit = 1e-9;
        pelorus::ResultBuilder result("");
        double count = static_cast<double>(passed) + more;
        if (DEFECT("stage-same-bytes-again")) count = static_cast<double>(++in_all);
        if (DEFECT("stage-threads-do-not-matter") && parallel != nullptr) count += parallel->threads;
        if (NEAR_MISS("stage-threads-do-not-matter")) count += counted_by_threads();
        result.scalar("passed", "", PLR_REDUCE_MEAN, count);
        result.scalar("gaps", "s", PLR_REDUCE_MEAN,
                      static_cast<double>(gaps) * (NEAR_MISS("stage-same-bytes-again") ? unit : 1e-9));
        publish(1, result.message(time));
    }
    /// A sum over blocks whose bounds do not depend on the number of threads.
    double counted_by_threads() {
        std::vector<double> blocks(8, 0.0);
        plr_error error{};
        error.struct_size = sizeof error;
        parallel->run(
            parallel->context, 64, 8,
            [](void* argument, std::int64_t first, std::int64_t last, plr_scratch*, plr_error*) -> plr_status {
                (*static_cast<std::vector<double>*>(argument))[static_cast<std::size_t>(first / 8)] =
                    1.0 / static_cast<double>(last);
                return PLR_OK;
            },
            &blocks, &error);
        double sum = 0;
        for (const double block : blocks) sum += block;
        return sum;
    }

    static plr_status save(const void* self, const plr_writer* writer, plr_error* error) noexcept {
        if (DEFECT("stage-publishes-only-when-it-may")) {
            auto& stage = *static_cast<Saboteur*>(const_cast<void*>(self));
            try {
                stage.publish_results(stage.newest);
            } catch (...) {
                // Nobody listens.
            }
        }
        return Base::table().save(self, writer, error);
    }
    static Bytes saved(const void* self) {
        Bytes bytes;
        const plr_writer writer{sizeof writer, 0, &bytes,
                                [](void* context, const void* data, std::uint64_t size, plr_error*) -> plr_status {
                                    const auto* const first = static_cast<const unsigned char*>(data);
                                    static_cast<Bytes*>(context)->insert(static_cast<Bytes*>(context)->end(), first,
                                                                         first + size);
                                    return PLR_OK;
                                }};
        Base::table().save(self, &writer, nullptr);
        return bytes;
    }
    static plr_status load(void* self, const void* bytes, std::uint64_t size, plr_error* error) noexcept {
        auto& stage = *static_cast<Saboteur*>(self);
        if (DEFECT("stage-refuses-broken-state") && size == 0) return PLR_OK;  // "nothing was saved"
        const plr_status status = Base::table().load(self, bytes, size, error);
        if (status == PLR_OK) return status;
        if (DEFECT("stage-keeps-state-on-refusal")) stage.passed = 0;
        if (NEAR_MISS("stage-keeps-state-on-refusal")) {
            const Bytes before = saved(self);
            stage.passed = 0;
            Base::table().load(self, before.data(), before.size(), nullptr);
        }
        const bool is_flipped = size == saved(self).size() && std::memcmp(bytes, "PLRSTATE", 8) == 0;
        if (DEFECT("stage-survives-flipped-bits") && is_flipped) std::abort();
        if (NEAR_MISS("stage-survives-flipped-bits") && is_flipped) {
            Bytes repaired(static_cast<const unsigned char*>(bytes), static_cast<const unsigned char*>(bytes) + size);
            const std::uint64_t fingerprint = pelorus::detail::fingerprint(repaired.data() + 24, repaired.size() - 24);
            std::memcpy(repaired.data() + 16, &fingerprint, sizeof fingerprint);
            return Base::table().load(self, repaired.data(), repaired.size(), nullptr) == PLR_OK ? PLR_OK : status;
        }
        return status;
    }
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.registration.saboteur");
