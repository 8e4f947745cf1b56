#include <cmath>

#include "../../common/waveform/waveform_rig.hpp"
#include "waveform_scheduler.hpp"

namespace {

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using waveform_scheduler::WaveformScheduler;

const char* const radar_noise = "{noise: [100 m, 10 m/s, 0.1 mrad]}";
const char* const motion = "{dimension: 2, form: discrete, acceleration: 7.4659806 m/s2}";  // its square is 55.74

struct Command {
    std::string address, name, unit;
    VectorXd numbers;
    std::int64_t from, to, time;
};

struct Rig {
    Bench bench;
    std::shared_ptr<const BenchInstance> model, estimator;
    std::unique_ptr<StageUnderTest> scheduler;

    explicit Rig(const std::string& with, const std::string& waveform = "library",
                 const std::string& waveform_with = "{}", const std::string& of_sensor = "library") {
        model = part(bench, "waveform", waveform, waveform_with);
        const auto held = of_sensor == waveform ? model : part(bench, "waveform", of_sensor, "{}");
        const auto radar = part(bench, "sensor", "polar_rate", radar_noise, {{"waveform", "", held}});
        estimator =
            part(bench, "estimator", "kalman", "{}",
                 {{"motion", "", part(bench, "motion", "constant_acceleration", motion)}, {"sensors", "radar", radar}});
        scheduler = std::make_unique<StageUnderTest>(
            bench, pelorus::test::plugin_of<WaveformScheduler>("scheduler.waveform"), with,
            std::vector<Part>{{"estimator", "", estimator}, {"waveform", "", model}});
    }

    /// A track of the start of the waveform scenario, and others beside it.
    void tracks(double time, const std::vector<std::pair<std::uint64_t, double>>& ids_and_deviations,
                std::int32_t status = PLR_TRACK_CONFIRMED) {
        const waveform::Scene scene = waveform::first_look();
        pelorus::TracksBuilder builder("", scene.space);
        VectorXd mean(6);
        mean << 432100, 87900, -2245, 387, 1, -11;
        for (const auto& [id, deviation] : ids_and_deviations) {
            VectorXd variances(6);
            variances << deviation * deviation, deviation * deviation, 100, 100, 1, 1;
            const MatrixXd covariance = variances.asDiagonal();
            pelorus::TrackEntry entry;
            entry.id = id;
            entry.time = std::llround(time * 1e9);
            entry.status = status;
            entry.mean = mean.data();
            entry.covariance = covariance.data();
            builder.add(entry);
        }
        scheduler->receive(WaveformScheduler::tracks_in, builder.message(std::llround(time * 1e9)));
    }
    std::vector<Command> commands() const {
        std::vector<Command> out;
        for (const auto& p : bench.published) {
            if (p.port != WaveformScheduler::commands_out) continue;
            const plr_quantity& q = p.message->body.values->quantities[0];
            out.push_back(
                {q.address, q.name, q.unit, pelorus::item(q.numbers, 0), q.valid_from, q.valid_to, p.message->time});
        }
        return out;
    }
};

}  // namespace

TEST_CASE("waveform scheduler: it commands what the model chooses for the prediction of the next look", "[scheduler]") {
    Rig rig("{period: 1 s}");
    rig.tracks(0, {{1, 100}});
    REQUIRE(rig.commands().size() == 1);
    const Command command = rig.commands()[0];
    CHECK(command.address == "radar");
    CHECK(command.name == "waveform");
    CHECK(command.unit == "s, 1/s");
    CHECK(command.time == 0);
    CHECK(command.from > 0);
    CHECK(command.from <= second);
    CHECK(command.to >= second);
    CHECK(command.to < 2 * second);
    const auto expected = waveform::WaveformUnderTest("library", "{}").choose(waveform::first_look());
    CHECK(command.numbers == expected.waveform);
    rig.scheduler->finish(second);
    const plr_table& table = rig.bench.published.back().table();
    CHECK(std::string(table.name) == "choices");
    REQUIRE(table.rows.count == 1);
    const VectorXd row = pelorus::item(table.rows, 0);
    CHECK(row(0) == 1.0);
    CHECK(row.segment(1, 2) == expected.waveform);
    CHECK(row(3) == Approx(expected.criterion).epsilon(1e-6));
}

TEST_CASE("waveform scheduler: a rotation is commanded in its own parameter", "[scheduler]") {
    Rig rig("{period: 1 s}", "ellipse_rotation", "{rule: published}", "ellipse_rotation");
    rig.tracks(3, {{1, 100}});
    const auto expected =
        waveform::WaveformUnderTest("ellipse_rotation", "{rule: published}").choose(waveform::first_look());
    REQUIRE(rig.commands().size() == 1);
    CHECK(rig.commands()[0].numbers(0) == Approx(expected.waveform(0)).epsilon(1e-9));
    CHECK(rig.commands()[0].unit == "rad");
}

TEST_CASE("waveform scheduler: of several tracks the worst counts, or the first", "[scheduler]") {
    // The ellipse of a track that is known well in range lies otherwise.
    const std::string policy = GENERATE("worst", "first");
    const auto turning = [](const std::string& with) {
        return std::make_unique<Rig>(with, "ellipse_rotation", "{}", "ellipse_rotation");
    };
    const auto both = turning("{period: 1 s, track: " + policy + "}"), good = turning("{period: 1 s}"),
               bad = turning("{period: 1 s}");
    both->tracks(0, {{4, 2}, {7, 100}});
    good->tracks(0, {{4, 2}});
    bad->tracks(0, {{7, 100}});
    REQUIRE(good->commands()[0].numbers != bad->commands()[0].numbers);
    CHECK(both->commands()[0].numbers == (policy == "worst" ? bad : good)->commands()[0].numbers);
}

TEST_CASE("waveform scheduler: without a track there is no command", "[scheduler]") {
    Rig rig("{period: 1 s}");
    rig.tracks(0, {});
    rig.tracks(1, {{1, 100}}, PLR_TRACK_DELETED);
    CHECK(rig.commands().empty());
}

TEST_CASE("waveform scheduler: without a period the rhythm of the looks tells when the next one is", "[scheduler]") {
    Rig rig("{}");
    rig.tracks(0, {{1, 100}});
    CHECK(rig.commands().empty());
    rig.tracks(2, {{1, 100}});
    REQUIRE(rig.commands().size() == 1);
    CHECK(rig.commands()[0].from <= 4 * second);
    CHECK(rig.commands()[0].to >= 4 * second);
    CHECK(rig.commands()[0].from > 3 * second);
}

TEST_CASE("waveform scheduler: a record is taken where it is its estimator's, and refused otherwise", "[scheduler]") {
    Rig rig("{period: 1 s}"), plain("{period: 1 s}");
    const plr_estimator& table = rig.estimator->table<plr_estimator>();
    const plr_estimator_info& info = *table.info(rig.estimator->self());
    std::vector<double> record(static_cast<std::size_t>(info.record_size));
    const waveform::Scene scene = waveform::first_look();
    VectorXd mean(6), deviations(6);
    mean << 432100, 87900, -2245, 387, 1, -11;
    deviations << 100, 100, 10, 10, 1, 1;
    const MatrixXd covariance = deviations.cwiseAbs2().asDiagonal();
    const std::int32_t all[] = {0, 1, 2, 3, 4, 5};
    auto init = pelorus::arguments<plr_estimator_init>();
    init.known = 6;
    init.components = all;
    init.mean = pelorus::const_view(mean);
    init.covariance = pelorus::const_view(covariance);
    init.record = pelorus::view(record.data(), info.record_size, 1, 1);
    Call call;
    REQUIRE(table.init(rig.estimator->self(), &call.raw(), &init) == PLR_OK);

    pelorus::TracksBuilder builder("", scene.space);
    const MatrixXd nonsense = 1e-6 * MatrixXd::Identity(6, 6);  // the record counts, not this
    pelorus::TrackEntry entry;
    entry.id = 1;
    entry.mean = mean.data();
    entry.covariance = nonsense.data();
    builder.add(entry);
    plr_message message = builder.message(0);
    plr_tracks body = *message.body.tracks;
    body.records = pelorus::const_view(record.data(), info.record_size, 1, 1);
    body.record_of = "estimator.kalman";
    body.record_version = info.record_version;
    message.body.tracks = &body;
    rig.scheduler->receive(WaveformScheduler::tracks_in, message);
    plain.tracks(0, {{1, 100}});
    CHECK(rig.commands().at(0).numbers == plain.commands().at(0).numbers);
    body.record_version += 1;
    CHECK_THROWS_WITH(rig.scheduler->receive(WaveformScheduler::tracks_in, message),
                      Catch::Contains("write it like: tracker.estimator"));
}

TEST_CASE("waveform scheduler: a saved one goes on bit for bit", "[scheduler]") {
    Rig whole("{}"), first("{}"), rest("{}");
    for (const double t : {0.0, 1.0, 2.0}) whole.tracks(t, {{1, 100}});
    first.tracks(0, {{1, 100}});
    first.tracks(1, {{1, 100}});
    rest.scheduler->load(first.scheduler->save());
    rest.tracks(2, {{1, 100}});
    CHECK(rest.commands().at(0).numbers == whole.commands().at(1).numbers);
    CHECK(rest.commands().at(0).from == whole.commands().at(1).from);
    for (Rig* each : {&whole, &rest}) each->scheduler->finish(0);
    CHECK(rest.bench.published.back().table().rows.count == whole.bench.published.back().table().rows.count);
}

TEST_CASE("waveform scheduler: a model that the sensor does not hold is refused", "[scheduler]") {
    CHECK_THROWS_WITH(
        Rig("{}", "ellipse_rotation", "{}", "library"),
        "waveform: commands rotation [rad], sensor radar takes length [s], chirp [1/s]; both must hold the same model");
    CHECK_THROWS_WITH(Rig("{sensor: sonar}"), "sensor: is sonar, the estimator has radar");
}
