#include <catch2/catch.hpp>
#include <Eigen/Dense>
#include <pelorus/innovations.hpp>

#include "../../../tests/support/airship_parts.hpp"
#include "single_target_tracker.hpp"

namespace {

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using single_target::SingleTargetTracker;

const char* const velocity_motion = "{dimension: 2, noise: 0.5 m2/s3, prior_velocity: 20 m/s}";

struct Told {
    std::int64_t time;
    std::int32_t status, misses;
    std::uint64_t id;
    VectorXd mean;
    MatrixXd covariance;
    std::vector<std::uint64_t> used;
};

struct Rig {
    Bench bench;
    std::unique_ptr<StageUnderTest> tracker;
    std::uint64_t measurements = 0;

    explicit Rig(const std::string& with, const std::string& motion = "constant_velocity",
                 const std::string& motion_with = velocity_motion, const std::string& sensor = "position",
                 const std::string& sensor_with = "{dimension: 2, noise: 3 m}", bool takes_late = false) {
        auto filter = part(bench, "estimator", "kalman", "{}",
                           {{"motion", "", part(bench, "motion", motion, motion_with)},
                            {"sensors", "radar", part(bench, "sensor", sensor, sensor_with)}});
        if (takes_late) filter = part(bench, "estimator", "out_of_sequence", "{}", {{"estimator", "", filter}});
        tracker = std::make_unique<StageUnderTest>(
            bench, pelorus::test::plugin_of<SingleTargetTracker>("tracker.single_target"), with,
            std::vector<Part>{{"estimator", "", filter}});
    }

    void scan(double time, const MatrixXd& points, const std::vector<double>& times = {}, bool covariances = true) {
        pelorus::ScanBuilder builder("radar", "", pelorus::position_space(static_cast<int>(points.rows())));
        const MatrixXd noise = 9 * MatrixXd::Identity(points.rows(), points.rows());
        for (Eigen::Index k = 0; k < points.cols(); ++k) {
            const VectorXd point = points.col(k);
            builder.add(++measurements, point.data(), covariances ? noise.data() : nullptr);
            if (!times.empty()) builder.set_time(std::llround(times[static_cast<std::size_t>(k)] * 1e9));
        }
        tracker->receive(SingleTargetTracker::scans_in, builder.message(std::llround(time * 1e9)));
    }
    void empty(double time) { scan(time, MatrixXd(2, 0)); }
    void truth(double time, const VectorXd& state, std::uint64_t id = 1) {
        pelorus::TruthBuilder builder("", pelorus::kinematic_space(2, {1, 1, 1}));
        pelorus::TruthEntry entry;
        entry.id = entry.parent = id;
        entry.time = std::llround(time * 1e9);
        entry.state = state.data();
        builder.add(entry);
        tracker->receive(SingleTargetTracker::truth_in, builder.message(entry.time));
    }
    std::vector<Told> told() const {
        std::vector<Told> out;
        for (const auto& p : bench.published) {
            if (p.port != SingleTargetTracker::tracks_out) continue;
            const plr_tracks& t = p.tracks();
            REQUIRE(t.count == 1);
            out.push_back({t.times[0], t.status[0], t.misses[0], t.ids[0], pelorus::item(t.mean, 0),
                           pelorus::item(t.covariance, 0),
                           std::vector<std::uint64_t>(t.measurements, t.measurements + t.measurement_offsets[1])});
        }
        return out;
    }
    std::vector<double> innovations() const {
        std::vector<double> out;
        for (const auto& p : bench.published)
            if (p.port == SingleTargetTracker::innovations_out)
                pelorus::for_each_innovation(*p.message->body.values,
                                             [&](const pelorus::Innovation& i) { out.push_back(i.squared); });
        return out;
    }
};

VectorXd truth_state() {
    VectorXd x(6);
    x << 1000, -500, 30, 10, 2, -3;
    return x;
}
MatrixXd column(double x, double y) { return Eigen::Vector2d(x, y); }

/// The Kalman filter of nearly constant velocity in the plane, written out.
struct ByHand {
    VectorXd x;
    MatrixXd p;
    void predict(double t) {
        MatrixXd f = MatrixXd::Identity(4, 4), q = MatrixXd::Zero(4, 4);
        for (int a = 0; a < 2; ++a) {
            f(a, 2 + a) = t;
            q(a, a) = 0.5 * t * t * t / 3;
            q(a, 2 + a) = q(2 + a, a) = 0.5 * t * t / 2;
            q(2 + a, 2 + a) = 0.5 * t;
        }
        x = f * x;
        p = f * p * f.transpose() + q;
    }
    double update(const VectorXd& z) {
        const MatrixXd s = p.topLeftCorner(2, 2) + 9 * MatrixXd::Identity(2, 2);
        const VectorXd e = z - x.head(2);
        const MatrixXd k = p.leftCols(2) * s.inverse();
        x += k * e;
        p -= k * s * k.transpose();
        return e.dot(s.inverse() * e);
    }
};

}  // namespace

TEST_CASE("single target: each measurement is one Kalman update in the order of its time", "[single_target]") {
    Rig rig("{}");
    rig.scan(0, column(10, 20));
    ByHand filter{VectorXd::Zero(4), MatrixXd::Zero(4, 4)};
    filter.x.head(2) << 10, 20;
    filter.p.diagonal() << 9, 9, 400, 400;
    CHECK((rig.told().at(0).mean - filter.x).norm() < 1e-12);
    CHECK((rig.told().at(0).covariance - filter.p).norm() < 1e-9);
    MatrixXd two(2, 2);
    two << 32, 20, 41, 30;  // the second one is the earlier
    rig.scan(2, two, {2, 1});
    filter.predict(1);
    const double first = filter.update(Eigen::Vector2d(20, 30));
    filter.predict(1);
    const double second = filter.update(Eigen::Vector2d(32, 41));
    const Told last = rig.told().at(1);
    CHECK((last.mean - filter.x).norm() < 1e-9);
    CHECK((last.covariance - filter.p).norm() < 1e-9);
    CHECK(last.used == std::vector<std::uint64_t>{3, 2});
    REQUIRE(rig.innovations().size() == 2);
    CHECK(rig.innovations()[0] == Approx(first));
    CHECK(rig.innovations()[1] == Approx(second));
    rig.empty(3.5);
    filter.predict(1.5);
    CHECK((rig.told().at(2).mean - filter.x).norm() < 1e-9);
    CHECK((rig.told().at(2).covariance - filter.p).norm() < 1e-9);
    CHECK(rig.told().at(2).status == PLR_TRACK_COASTING);
    CHECK(rig.told().at(2).misses == 1);
}

TEST_CASE("single target: a scan without covariances has those of its sensor", "[single_target]") {
    Rig with("{}"), without("{}");
    for (int k = 0; k < 4; ++k) {
        with.scan(k, column(20.0 * k, 3));
        without.scan(k, column(20.0 * k, 3), {}, false);
    }
    CHECK(with.told().back().mean == without.told().back().mean);
    CHECK(with.told().back().covariance == without.told().back().covariance);
}

TEST_CASE("single target: a drawn start lies about the truth as its deviations say", "[single_target]") {
    const std::string with = "{start: drawn, start_sd: [100 m, 10 m/s, 1 m/s2]}";
    Rig rig(with, "constant_acceleration", "{dimension: 2}");
    rig.truth(0, truth_state());
    rig.empty(0);
    REQUIRE(rig.told().size() == 1);
    const Told start = rig.told()[0];
    CHECK(start.time == 0);
    CHECK(start.status == PLR_TRACK_CONFIRMED);
    CHECK(start.misses == 0);
    VectorXd deviations(6);
    deviations << 100, 100, 10, 10, 1, 1;
    CHECK((start.covariance - MatrixXd(deviations.cwiseAbs2().asDiagonal())).norm() < 1e-9);
    const VectorXd unit = (start.mean - truth_state()).cwiseQuotient(deviations);
    CHECK(unit.cwiseAbs().minCoeff() > 1e-6);
    CHECK(unit.cwiseAbs().maxCoeff() < 5);

    SECTION("filters of other sizes start with the same errors in what they have in common") {
        Rig smaller(with);
        smaller.truth(0, truth_state());
        smaller.empty(0);
        CHECK((smaller.told().at(0).mean - start.mean.head(4)).norm() < 1e-9);
    }
    SECTION("the errors scale with the deviations and nothing else") {
        Rig other("{start: drawn, start_sd: [1 m, 2 m/s, 3 m/s2]}", "constant_acceleration", "{dimension: 2}");
        other.truth(0, truth_state());
        other.empty(0);
        VectorXd scale(6);
        scale << 1, 1, 2, 2, 3, 3;
        CHECK((other.told().at(0).mean - truth_state() - scale.cwiseProduct(unit)).norm() < 1e-9);
    }
    SECTION("nothing but the start reads the truth") {
        Rig blind(with, "constant_acceleration", "{dimension: 2}");
        blind.truth(0, truth_state());
        blind.empty(0);
        for (int k = 1; k < 5; ++k) {
            rig.truth(k, VectorXd::Constant(6, 1e7));
            rig.scan(k, column(1000 + 30 * k, -500 + 10 * k));
            blind.scan(k, column(1000 + 30 * k, -500 + 10 * k));
        }
        CHECK(rig.told().back().mean == blind.told().back().mean);
    }
}

TEST_CASE("single target: a drawn start waits for a truth of the scan's time", "[single_target]") {
    Rig rig("{start: drawn, start_sd: [100 m, 10 m/s, 1 m/s2]}");
    rig.empty(0);
    rig.truth(0.5, truth_state());
    rig.scan(1, column(1, 1));
    CHECK(rig.told().empty());
    rig.truth(2, truth_state());
    rig.scan(2, column(1000, -500));
    REQUIRE(rig.told().size() == 1);
    CHECK(rig.innovations().size() == 1);  // the first measurement is an update already
}

TEST_CASE("single target: a given start has what is given, the rest from the priors", "[single_target]") {
    Rig rig("{start: given, start_position: [1 km, 2 km], start_sd: [100 m, 10 m/s, 1 m/s2]}");
    rig.empty(3);
    const Told start = rig.told().at(0);
    VectorXd mean(4), variances(4);
    mean << 1000, 2000, 0, 0;
    variances << 1e4, 1e4, 400, 400;
    CHECK(start.mean == mean);
    CHECK((start.covariance - MatrixXd(variances.asDiagonal())).norm() < 1e-9);
    CHECK(start.time == 3 * second);
}

TEST_CASE("single target: misses are counted, and so many of them end the track", "[single_target]") {
    Rig rig("{maximum_misses: 2}");
    rig.scan(0, column(0, 0));
    rig.empty(1);
    rig.scan(2, column(0, 0));
    rig.empty(3);
    rig.empty(4);
    rig.empty(5);
    rig.scan(6, column(50, 50));
    std::vector<std::int32_t> status;
    std::vector<std::uint64_t> ids;
    for (const Told& t : rig.told()) {
        status.push_back(t.status);
        ids.push_back(t.id);
    }
    CHECK(status == std::vector<std::int32_t>{PLR_TRACK_CONFIRMED, PLR_TRACK_COASTING, PLR_TRACK_CONFIRMED,
                                              PLR_TRACK_COASTING, PLR_TRACK_DELETED, PLR_TRACK_CONFIRMED});
    CHECK(ids == std::vector<std::uint64_t>{1, 1, 1, 1, 1, 2});
}

TEST_CASE("single target: a late measurement is left out and told where the estimator takes none", "[single_target]") {
    Rig rig("{}"), sorted("{}");
    for (Rig* each : {&rig, &sorted}) {
        each->scan(0, column(0, 0));
        each->scan(2, column(40, 0));
    }
    rig.scan(1, column(20, 500));
    rig.scan(1.5, column(20, 500));
    CHECK(rig.bench.counters["late_measurements"] == 2);
    CHECK(rig.bench.counters["late_measurements_used"] == 0);
    CHECK(rig.told().back().mean == sorted.told().back().mean);
    CHECK(rig.told().back().misses == 0);
    CHECK(rig.bench.log.size() == 1);
}

TEST_CASE("single target: a late measurement is used as if it had come in time where the estimator takes it",
          "[single_target]") {
    const auto takes_late = [] {
        return std::make_unique<Rig>("{}", "constant_velocity", velocity_motion, "position",
                                     "{dimension: 2, noise: 3 m}", true);
    };
    const auto late = takes_late(), sorted = takes_late(), without = takes_late();
    const auto send = [](Rig& rig, double time) { rig.scan(time, column(20 * time, time == 1 ? 9 : 0)); };
    for (const double time : {0.0, 2.0, 3.0, 1.0}) send(*late, time);
    for (const double time : {0.0, 1.0, 2.0, 3.0}) send(*sorted, time);
    for (const double time : {0.0, 2.0, 3.0}) send(*without, time);
    CHECK(late->bench.counters["late_measurements_used"] == 1);
    CHECK(late->bench.counters["late_measurements"] == 0);
    CHECK(late->told().back().time == 3 * second);
    CHECK(late->told().back().used == std::vector<std::uint64_t>{4});
    CHECK((late->told().back().mean - sorted->told().back().mean).norm() < 1e-9);
    CHECK((late->told().back().covariance - sorted->told().back().covariance).norm() < 1e-9);
    CHECK((without->told().back().mean - sorted->told().back().mean).norm() > 0.1);
}

TEST_CASE("single target: records are told on request, with the version of their estimator", "[single_target]") {
    Rig rig("{records: true}"), plain("{}");
    for (Rig* each : {&rig, &plain}) each->scan(0, column(5, 6));
    const plr_tracks& tracks = rig.bench.published.at(0).tracks();
    REQUIRE(tracks.records.data != nullptr);
    CHECK(tracks.records.count == 1);
    CHECK(std::string(tracks.record_of) == "estimator.kalman");
    CHECK(tracks.record_version != 0);
    CHECK(plain.bench.published.at(0).tracks().records.data == nullptr);
}

TEST_CASE("single target: a saved tracker goes on bit for bit, before and after its start", "[single_target]") {
    const std::string with = "{start: drawn, start_sd: [100 m, 10 m/s, 1 m/s2], maximum_misses: 3}";
    Rig whole(with);
    whole.truth(0, truth_state());
    for (int k = 0; k < 6; ++k) whole.scan(k, column(1000 + 30 * k, -500));
    for (const int cut : {0, 3}) {
        Rig first(with), rest(with);
        first.truth(0, truth_state());
        for (int k = 0; k < cut; ++k) first.scan(k, column(1000 + 30 * k, -500));
        rest.tracker->load(first.tracker->save());
        rest.measurements = first.measurements;
        for (int k = cut; k < 6; ++k) rest.scan(k, column(1000 + 30 * k, -500));
        CHECK(rest.told().back().mean == whole.told().back().mean);
        CHECK(rest.told().back().covariance == whole.told().back().covariance);
    }
    Rig other(with, "constant_acceleration", "{dimension: 2}");
    CHECK_THROWS_WITH(other.tracker->load(whole.tracker->save()), Catch::Contains("another estimator"));
}

TEST_CASE("begun anew with every measurement, the track tells the measurements themselves", "[single_target]") {
    Rig rig("{anew: true}");
    const Eigen::Vector2d points[] = {{10, 20}, {-300, 5}, {40, 41}};
    for (int k = 0; k < 3; ++k) rig.scan(k, points[k]);
    rig.empty(3);
    const auto told = rig.told();
    REQUIRE(told.size() == 4);
    for (std::size_t k = 0; k < 3; ++k) {
        CHECK(told[k].id == 1);
        CHECK(told[k].status == PLR_TRACK_CONFIRMED);
        CHECK(told[k].mean.head<2>() == points[k]);
        CHECK((told[k].covariance.topLeftCorner<2, 2>() - 9 * Eigen::Matrix2d::Identity()).norm() < 1e-12);
        CHECK(told[k].used.size() == 1);
    }
    CHECK(told[3].status == PLR_TRACK_COASTING);
    CHECK_THROWS_WITH(Rig("{anew: true, start: drawn, start_sd: [1, 1, 1]}"), Catch::Contains("anew"));
}

TEST_CASE("single target: what does not belong together is refused by name", "[single_target]") {
    const auto refused = [](const std::string& with) {
        try {
            Rig rig(with);
        } catch (const std::exception& problem) {
            return std::string(problem.what());
        }
        return std::string();
    };
    CHECK(refused("{start: drawn}") == "start_sd: is required with start: given or drawn");
    CHECK(refused("{start: given, start_sd: [1, 1, 1]}") == "start_position: is required with start: given");
    CHECK(refused("{start_position: [0 m, 0 m]}") == "start_position: belongs to start: given");
    CHECK(refused("{start: given, start_position: [0 m], start_sd: [1, 1, 1]}") ==
          "start_position: has 1 elements, the estimator has 2 axes");
    CHECK(refused("{start_sd: [1, 1, 1]}") ==
          "start_sd: belongs to start: given or drawn; a measurement has a covariance");
    Rig rig("{}");
    pelorus::ScanBuilder stranger("sonar", "", pelorus::position_space(2));
    CHECK_THROWS_WITH(rig.tracker->receive(0, stranger.message(0)),
                      "a scan of sensor sonar came, which the estimator does not hold");
}
