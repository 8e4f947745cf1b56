// Pelorus in an application: what is pushed through libpelorus gives what the command gives.
#include <catch2/catch.hpp>
#include <malloc.h>
#include <pelorus/embed.hpp>

#include <cmath>
#include <thread>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

using namespace pelorus::test;
using pelorus::Pipeline;
using pelorus::PipelineOptions;

namespace {

const std::string recorded = PELORUS_SOURCE_DIR "/configs/recorded_radar.yaml";
const std::string external = PELORUS_SOURCE_DIR "/configs/recorded_radar_external.yaml";

Pipeline opened(const std::string& config, const std::string& folder = "") {
    PipelineOptions options;
    options.result_folder = folder;
    if (folder.empty() && config.find("recorded") != std::string::npos)
        options.overrides = {{"files", "~"}};  // no folder, no files
    auto pipeline = Pipeline::open(config, options);
    INFO(pipeline.status().text());
    REQUIRE(pipeline.ok());
    return std::move(*pipeline);
}

pelorus::Subscription subscribed(Pipeline& pipeline, const std::string& port) {
    auto subscription = pipeline.subscribe(port, 1'000'000);
    INFO(subscription.status().text());
    REQUIRE(subscription.ok());
    return *subscription;
}

void require_ok(const pelorus::Status& status) {
    INFO(status.text());
    REQUIRE(status.ok());
}

/// All that a track message says, as text: numbers to the last bit.
std::string text_of(const plr_message& message) {
    const plr_tracks& tracks = *message.body.tracks;
    std::string text = std::to_string(message.time) + ' ' + std::to_string(message.arrival) + '\n';
    const auto append = [&](const plr_const_view& view, std::int64_t item) {
        for (std::int64_t col = 0; view.data && col < view.cols; ++col)
            for (std::int64_t row = 0; row < view.rows; ++row) {
                char word[32];
                std::snprintf(word, sizeof word, " %a", pelorus::number(view, item, row, col));
                text += word;
            }
    };
    for (std::int64_t i = 0; i < tracks.count; ++i) {
        text += std::to_string(tracks.ids[i]) + ' ' + std::to_string(tracks.times[i]) + ' ' +
                std::to_string(tracks.status[i]) + ' ' + std::to_string(tracks.misses[i]);
        append(tracks.mean, i);
        append(tracks.covariance, i);
        for (std::int64_t k = tracks.measurement_offsets[i]; k < tracks.measurement_offsets[i + 1]; ++k)
            text += " from " + std::to_string(tracks.measurements[k]);
        text += '\n';
    }
    return text;
}

void take_tracks(pelorus::Subscription& subscription, std::vector<std::string>& to) {
    while (const plr_message* message = subscription.pull()) to.push_back(text_of(*message));
}

/// Plays the recording through source.csv and pushes what its radar said, truth first, as source.csv does.
class Replay {
public:
    /// The next event; false: there is none.
    bool push_next(Pipeline& to) {
        const plr_message* scan = scans_.pull();
        const plr_message* truth = truth_.pull();
        if (scan == nullptr) return false;
        require_ok(to.push("radar.truth", *truth));
        require_ok(to.push("radar.scans", *scan));
        require_ok(to.advance(scan->arrival));
        return true;
    }
    std::vector<std::string> tracks() {
        std::vector<std::string> all;
        take_tracks(tracks_, all);
        return all;
    }

private:
    pelorus::Subscription scans_{nullptr}, truth_{nullptr}, tracks_{nullptr};
    Pipeline pipeline_ = played();

    Pipeline played() {
        Pipeline pipeline = opened(recorded);
        scans_ = subscribed(pipeline, "radar.scans");
        truth_ = subscribed(pipeline, "radar.truth");
        tracks_ = subscribed(pipeline, "tracker.tracks");
        require_ok(pipeline.play());
        return pipeline;
    }
};

/// A made-up target of the external config: a plot every 2 s.
class Target {
public:
    explicit Target(Pipeline& pipeline) : pipeline_(pipeline), scan_(*pipeline.stream("radar.scans", "radar")) {}
    pelorus::Status push() {
        const auto k = static_cast<double>(count_);
        const double angle = 0.01 * k, plot[3] = {20e3 + std::fmod(k, 7), std::fmod(angle, 3.0), 0.05};
        scan_.clear();
        scan_.add(++count_, plot);
        return pipeline_.push("radar.scans", scan_.message(static_cast<std::int64_t>(count_) * 2'000'000'000));
    }

private:
    Pipeline& pipeline_;
    pelorus::ScanMessage scan_;
    std::uint64_t count_ = 0;
};

}  // namespace

TEST_CASE("A recording that is pushed gives the tracks of the command, message by message and byte for byte") {
    const TemporaryFolder folder;
    const Ended ended = pelorus_command({"run", recorded, "--out", folder / "command"});
    INFO(ended.err);
    REQUIRE(ended.exit == 0);

    Replay replay;
    Pipeline pipeline = opened(external, folder / "embedded");
    pelorus::Subscription subscription = subscribed(pipeline, "tracker.tracks");
    std::vector<std::string> tracks;
    while (replay.push_next(pipeline)) take_tracks(subscription, tracks);
    require_ok(pipeline.finish());
    take_tracks(subscription, tracks);

    CHECK(tracks.size() > 140);
    CHECK((tracks == replay.tracks()));
    for (const std::string file : {"tracks.csv", "truth.csv", "summary.json"}) {
        INFO(file);
        CHECK((folder.read("embedded/" + file) == folder.read("command/" + file)));
    }
    const auto rmse = pipeline.scalar("errors.position_rmse");
    REQUIRE(rmse.ok());
    CHECK(*rmse < 80);
    CHECK(pipeline.scalars().size() > 5);
    REQUIRE_FALSE(pipeline.tables().empty());
    CHECK(pipeline.tables()[0]->rows.rows == pipeline.tables()[0]->column_count);
}

TEST_CASE("A pipeline is snapshotted in mid-stream and goes on in another one with the same tracks") {
    Replay replay;
    std::vector<std::string> tracks;
    Pipeline first = opened(external), second = opened(external);
    pelorus::Subscription of_first = subscribed(first, "tracker.tracks");
    pelorus::Subscription of_second = subscribed(second, "tracker.tracks");
    for (int i = 0; i < 70; ++i) REQUIRE(replay.push_next(first));
    take_tracks(of_first, tracks);
    const auto bytes = first.snapshot();
    REQUIRE(bytes.ok());
    REQUIRE(replay.push_next(first));  // the first one may go on; what the second one misses is then its loss alone
    take_tracks(of_first, tracks);

    require_ok(second.restore(*bytes));
    Replay again;
    Pipeline skipped = opened(external);
    for (int i = 0; i < 70; ++i) REQUIRE(again.push_next(skipped));
    REQUIRE(again.push_next(second));
    std::vector<std::string> overlap;
    take_tracks(of_second, overlap);
    CHECK((overlap.back() == tracks.back()));
    while (replay.push_next(second)) take_tracks(of_second, tracks);
    require_ok(second.finish());
    take_tracks(of_second, tracks);
    CHECK((tracks == replay.tracks()));

    pelorus::Status status = opened(recorded).restore(*bytes);
    CHECK(status.code() == PLR_E_DATA);
    CHECK_THAT(status.text(), Catch::Contains("snapshot refused"));
    auto damaged = *bytes;
    damaged[damaged.size() / 2] ^= 1;
    status = opened(external).restore(damaged);
    CHECK(status.code() == PLR_E_DATA);
    CHECK_THAT(status.text(), Catch::Contains("it is damaged"));
}

TEST_CASE("Two pipelines on two threads do not know of each other") {
    std::vector<std::string> tracks[2], expected = Replay().tracks();
    const auto work = [&](std::size_t which) {
        auto pipeline = Pipeline::open(recorded, [] {
            PipelineOptions options;
            options.overrides = {{"files", "~"}};
            options.threads = 2;
            return options;
        }());
        if (!pipeline) return;
        auto subscription = pipeline->subscribe("tracker.tracks", 1'000'000);
        if (!subscription || !pipeline->play() || !pipeline->finish()) return;
        while (const plr_message* message = subscription->pull()) tracks[which].push_back(text_of(*message));
    };
    std::thread one(work, 0), other(work, 1);
    one.join();
    other.join();
    CHECK_FALSE(expected.empty());
    CHECK((tracks[0] == expected));
    CHECK((tracks[1] == expected));
}

TEST_CASE("A subscription that nobody pulls refuses to go on, or loses the oldest and counts it") {
    Pipeline pipeline = opened(external);
    auto strict = pipeline.subscribe("radar.scans", 2);
    auto loose = pipeline.subscribe("radar.scans", 2, PELORUS_WHEN_FULL_DROP_OLDEST);
    REQUIRE((strict.ok() && loose.ok()));
    Target target(pipeline);
    require_ok(target.push());
    require_ok(target.push());
    const pelorus::Status full = target.push();
    CHECK(full.code() == PELORUS_E_FULL);
    CHECK(full.text() == "the subscription of radar.scans is full: 2 messages wait to be pulled");
    CHECK(pipeline.advance(1'000'000'000'000).code() == PELORUS_E_FULL);
    REQUIRE(strict->pull() != nullptr);
    require_ok(pipeline.advance(4'000'000'000));
    require_ok(target.push());
    CHECK(loose->state()->waiting == 2);
    CHECK(loose->state()->dropped == 1);
    CHECK(loose->pull()->time == 4'000'000'000);
    strict->end();
    require_ok(target.push());
}

TEST_CASE("Ten thousand pushes do not make the process grow", "[release-only]") {
    Pipeline pipeline = opened(PELORUS_SOURCE_DIR "/examples/embed/pipeline.yaml");  // no analyzers: those gather rows
    auto tracks = pipeline.subscribe("tracker.tracks", 16, PELORUS_WHEN_FULL_DROP_OLDEST);
    REQUIRE(tracks.ok());
    Target target(pipeline);
    const auto push = [&](int count) {
        for (int i = 0; i < count; ++i) {
            if (!target.push()) return false;
            if (i % 2 == 0 && !pipeline.advance(*pipeline.now())) return false;
        }
        return true;
    };
    REQUIRE(push(1000));
    const std::size_t before = ::mallinfo2().uordblks;
    REQUIRE(push(10'000));
    const std::size_t after = ::mallinfo2().uordblks;
    CHECK(after < before + (std::size_t{1} << 20));
    CHECK(tracks->state()->waiting == 16);
    CHECK(tracks->state()->dropped > 9000);
}

TEST_CASE("A pipeline is stopped by another thread between two events and goes on where it was") {
    Pipeline pipeline = opened(recorded);
    pelorus::Subscription tracks = subscribed(pipeline, "tracker.tracks");
    std::thread stopper([&] { pipeline.stop(); });
    stopper.join();
    CHECK(pipeline.play().code() == PLR_E_CANCELLED);
    require_ok(pipeline.play());
    require_ok(pipeline.finish());
    std::vector<std::string> all;
    take_tracks(tracks, all);
    CHECK((all == Replay().tracks()));
}
