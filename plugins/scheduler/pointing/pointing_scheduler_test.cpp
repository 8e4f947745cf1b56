// A narrow sensor that is pointed at a track: where, in which state, and what is told of it.
#include <cmath>

#include <catch2/catch.hpp>
#include <Eigen/Geometry>

#include "../../../tests/support/airship_parts.hpp"
#include "pointing_scheduler.hpp"

namespace {

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using pointing_scheduler::PointingScheduler;
const double degree = std::acos(-1.0) / 180;

struct Command {
    std::string address, name, unit;
    VectorXd angles;
    std::int64_t from, time;
};

const char* const mounted = "{noise: 1e-4 rad, position: [10 m, 5 m, 3 m], attitude: [-1 deg, 2 deg, -3 deg]}";

struct Rig {
    Bench bench;
    std::unique_ptr<StageUnderTest> scheduler;
    std::uint64_t next_measurement = 1;

    explicit Rig(const std::string& with, const std::string& sensor = "bearings", const std::string& model = mounted) {
        const auto estimator = part(bench, "estimator", "kalman", "{}",
                                    {{"motion", "", part(bench, "motion", "constant_velocity", "{noise: 1e-4 m2/s3}")},
                                     {"sensors", "eye", part(bench, "sensor", sensor, model)}});
        scheduler =
            std::make_unique<StageUnderTest>(bench, pelorus::test::plugin_of<PointingScheduler>("scheduler.pointing"),
                                             with, std::vector<Part>{{"estimator", "", estimator}});
    }

    /// Tracks that rest at (1000, 2000, 500) m, but for a velocity.
    void track(double time, std::uint64_t id = 1, double deviation = 0.1, std::int32_t status = PLR_TRACK_CONFIRMED,
               const Vector3d& velocity = Vector3d::Zero()) {
        pelorus::TracksBuilder builder("", pelorus::kinematic_space(3, {1e6, 1e2}));
        VectorXd mean(6), variances(6);
        mean << 1000, 2000, 500, velocity;
        variances << Vector3d::Constant(deviation * deviation), Vector3d::Constant(1e-6);
        const MatrixXd covariance = variances.asDiagonal();
        pelorus::TrackEntry entry;
        entry.id = id;
        entry.time = std::llround(time * 1e9);
        entry.status = status;
        entry.mean = mean.data();
        entry.covariance = covariance.data();
        builder.add(entry);
        scheduler->receive(PointingScheduler::tracks_in, builder.message(entry.time));
    }
    /// A scan that sees the track, or something else.
    void look(double time, bool hit) {
        pelorus::ScanBuilder scan("eye", "",
                                  pelorus::Space({{"azimuth", "rad", 0, 0, true}, {"elevation", "rad", 0, 0, true}}));
        const VectorXd direction = expected(Vector3d(1000, 2000, 500)) + Eigen::Vector2d(hit ? 0 : 0.1, 0);
        const MatrixXd noise = 1e-8 * MatrixXd::Identity(2, 2);
        scan.add(next_measurement++, direction.data(), noise.data());
        scheduler->receive(PointingScheduler::scans_in, scan.message(std::llround(time * 1e9)));
    }
    void looks_at(double time, const VectorXd& direction) {
        pelorus::ValuesBuilder values;
        const std::int64_t now = std::llround(time * 1e9);
        values.add("eye", "pointing", "rad", direction, now, now);
        scheduler->receive(PointingScheduler::pointing_in, values.message(now));
    }
    /// Azimuth and elevation in the mount of `mounted`.
    static VectorXd expected(const Vector3d& place) {
        const auto about = [](double angle, const Vector3d& axis) { return Eigen::AngleAxisd(angle, axis); };
        const Eigen::Matrix3d mount = (about(-3 * degree, Vector3d::UnitZ()) * about(2 * degree, Vector3d::UnitY()) *
                                       about(-1 * degree, Vector3d::UnitX()))
                                          .toRotationMatrix();
        const Vector3d local = mount.transpose() * (place - Vector3d(10, 5, 3));
        return Eigen::Vector2d(std::atan2(local.y(), local.x()), std::asin(local.z() / local.norm()));
    }
    std::vector<Command> commands() const {
        std::vector<Command> out;
        for (const auto& p : bench.published) {
            if (p.port != PointingScheduler::commands_out) continue;
            const plr_quantity& q = p.message->body.values->quantities[0];
            out.push_back({q.address, q.name, q.unit, pelorus::item(q.numbers, 0), q.valid_from, p.message->time});
        }
        return out;
    }
    /// Of table `looks` or `locks`: all rows.
    std::vector<VectorXd> rows(const std::string& table, double at = 100) {
        scheduler->finish(std::llround(at * 1e9));
        std::vector<VectorXd> out;
        for (const auto& p : bench.published)
            if (p.port == PointingScheduler::results_out && p.table().name == table)
                for (std::int64_t i = 0; i < p.table().rows.count; ++i)
                    out.emplace_back(pelorus::item(p.table().rows, i));
        return out;
    }
    std::map<std::string, double> scalars() {
        scheduler->finish(0);
        std::map<std::string, double> out;
        for (const auto& p : bench.published) {
            if (p.port != PointingScheduler::results_out) continue;
            for (std::uint32_t i = 0; i < p.table().scalar_count; ++i)
                out[p.table().scalars[i].name] = p.table().scalars[i].value;
        }
        return out;
    }
};

}  // namespace

TEST_CASE("pointing scheduler: it points where the sensor will see the track at its next look", "[pointing]") {
    Rig rig("{field_of_view: 1 deg, period: 0.5 s}");
    rig.track(4, 1, 0.1, PLR_TRACK_CONFIRMED, Vector3d(30, -20, 10));
    REQUIRE(rig.commands().size() == 1);
    const Command command = rig.commands()[0];
    CHECK(command.address == "eye");
    CHECK(command.name == "pointing");
    CHECK(command.unit == "rad");
    CHECK(command.time == 4 * second);
    CHECK(command.from == 4 * second);
    CHECK((command.angles - Rig::expected({1015, 1990, 505})).norm() < 1e-8);
}

TEST_CASE("pointing scheduler: without a period the rhythm of the looks tells when the next one is", "[pointing]") {
    Rig rig("{field_of_view: 1 deg}");
    const Vector3d velocity(30, -20, 10);
    rig.look(1, false);
    rig.look(3, false);
    CHECK(rig.commands().empty());
    rig.track(4, 1, 0.1, PLR_TRACK_CONFIRMED, velocity);  // the next look: at 5 s
    CHECK((rig.commands().back().angles - Rig::expected(Vector3d(1000, 2000, 500) + velocity)).norm() < 1e-8);
}

TEST_CASE("pointing scheduler: zenith angles are pointed at by their elevation", "[pointing]") {
    Rig rig("{field_of_view: 1 deg, period: 0.5 s}", "bearings",
            "{angle: zenith, position: [10 m, 5 m, 3 m], attitude: [-1 deg, 2 deg, -3 deg]}");
    rig.track(4);
    CHECK((rig.commands()[0].angles - Rig::expected({1000, 2000, 500})).norm() < 1e-8);
}

TEST_CASE("pointing scheduler: looks that see the target lock it, others lose it, and the tables tell when",
          "[pointing]") {
    Rig rig("{field_of_view: 1 deg, period: 1 s, lock_looks: 2, loss_looks: 3}");
    rig.track(0);
    double t = 1;
    for (const bool hit : {true, true, true, false, false, true, false, false, false, true, true}) rig.look(t++, hit);
    const auto locks = rig.rows("locks");
    REQUIRE(locks.size() == 2);
    CHECK(locks[0].head(2) == VectorXd(Eigen::Vector2d(1, 1)));
    CHECK(locks[0](2) == 2);
    CHECK(locks[0](3) == 9);
    CHECK(locks[1](2) == 11);
    CHECK(std::isnan(locks[1](3)));
    const auto looks = rig.rows("looks");
    REQUIRE(looks.size() == 22);  // told twice here
    CHECK(looks[0](5) == 1);
    CHECK(looks[3](5) == 0);
    CHECK(looks[3](7) == 1);  // still locked
    CHECK(looks[8](8) == 1);  // lost
    auto told = rig.scalars();
    CHECK(told["looks"] == 11);
    CHECK(told["locked_share"] == Approx(8.0 / 11));
    CHECK(told["losses"] == 1);
    CHECK(told["first_lock"] == 2);
}

TEST_CASE("pointing scheduler: where the field does not cover the track it searches around it", "[pointing]") {
    Rig rig("{field_of_view: [0.2 deg, 0.2 deg], period: 1 s}");  // 3.5 mrad; 10 m are 4.4 mrad from there
    rig.track(0, 1, 10);
    const VectorXd centre = rig.commands().back().angles;
    CHECK((centre - Rig::expected({1000, 2000, 500})).norm() < 1e-8);
    std::vector<VectorXd> visited{centre};
    for (int t = 1; t <= 12; ++t) {
        rig.look(t, false);
        visited.push_back(rig.commands().back().angles);
    }
    for (std::size_t a = 0; a < visited.size(); ++a) {
        CHECK((visited[a] - centre).norm() < 0.03);
        for (std::size_t b = 0; b < a; ++b) CHECK((visited[a] - visited[b]).norm() > 1.5e-3);
    }
    rig.look(13, true);
    CHECK((rig.commands().back().angles - centre).norm() < 1e-6);
    CHECK(rig.rows("looks")[3](6) == 1);  // searching
}

TEST_CASE("pointing scheduler: looks on the way to where it was told do not count", "[pointing]") {
    Rig rig("{field_of_view: [0.2 deg, 0.2 deg], period: 1 s}");
    rig.track(0, 1, 10);
    const VectorXd centre = rig.commands().back().angles;
    for (int t = 1; t <= 5; ++t) {
        rig.looks_at(t, VectorXd(centre + Eigen::Vector2d(0.5 - 0.1 * t, 0)));
        rig.look(t, false);
        CHECK(((rig.commands().back().angles - centre).norm() < 1e-6) == (t < 5));
    }
    const auto looks = rig.rows("looks");
    CHECK(looks[0](3) == Approx(0.4 * std::cos(centre(1))).epsilon(0.02));
    CHECK(looks[4](3) < 1e-6);
}

TEST_CASE("pointing scheduler: it stays on the target while the sensor's frames fail to come", "[pointing]") {
    Rig rig("{field_of_view: 1 deg, period: 1 s}");
    const Vector3d velocity(30, -20, 10);
    rig.track(0, 1, 0.1, PLR_TRACK_CONFIRMED, velocity);
    rig.look(1, false);
    const std::size_t before = rig.commands().size();
    rig.looks_at(2, rig.commands().back().angles);  // its frame may still come
    CHECK(rig.commands().size() == before);
    rig.looks_at(3, rig.commands().back().angles);
    REQUIRE(rig.commands().size() == before + 1);
    CHECK((rig.commands().back().angles - Rig::expected(Vector3d(1000, 2000, 500) + 4 * velocity)).norm() < 1e-8);
}

TEST_CASE("pointing scheduler: it keeps its track until that is deleted, and takes no tentative one", "[pointing]") {
    Rig rig("{field_of_view: 1 deg, period: 1 s}");
    rig.track(0, 5, 0.1, PLR_TRACK_TENTATIVE);
    CHECK(rig.commands().empty());
    rig.track(1, 5);
    CHECK(rig.commands().size() == 1);
    rig.track(2, 3);  // another one
    CHECK(rig.commands().size() == 1);
    rig.track(3, 5, 0.1, PLR_TRACK_DELETED);
    CHECK(rig.commands().size() == 1);
    rig.look(4, true);
    CHECK(rig.commands().size() == 1);
    rig.track(5, 3);
    CHECK(rig.commands().size() == 2);
}

TEST_CASE("pointing scheduler: a saved one goes on bit for bit", "[pointing]") {
    const std::string with = "{field_of_view: 0.2 deg, period: 1 s}";
    Rig whole(with), first(with), rest(with);
    for (Rig* each : {&whole, &first}) {
        each->track(0, 1, 10);
        for (int t = 1; t < 5; ++t) each->look(t, false);
    }
    rest.scheduler->load(first.scheduler->save());
    for (Rig* each : {&whole, &rest})
        for (int t = 5; t < 12; ++t) each->look(t, t > 8);
    for (std::size_t k = 0; k < 7; ++k) {
        CHECK(rest.commands()[k].angles == whole.commands()[k + 5].angles);
        CHECK(rest.commands()[k].from == whole.commands()[k + 5].from);
    }
    CHECK(rest.rows("looks") == whole.rows("looks"));
    CHECK(rest.scalars() == whole.scalars());
}

TEST_CASE("pointing scheduler: in the plane it points by azimuth alone", "[pointing]") {
    Bench bench;
    const auto estimator =
        part(bench, "estimator", "kalman", "{}",
             {{"motion", "", part(bench, "motion", "constant_velocity", "{dimension: 2, noise: 1e-4 m2/s3}")},
              {"sensors", "", part(bench, "sensor", "azimuth", "{position: [100 m, 0 m], yaw: 0.5 rad}")}});
    StageUnderTest scheduler(bench, pelorus::test::plugin_of<PointingScheduler>("scheduler.pointing"),
                             "{field_of_view: 2 deg, period: 1 s}", std::vector<Part>{{"estimator", "", estimator}});
    pelorus::TracksBuilder builder("", pelorus::kinematic_space(2, {1e6, 1e2}));
    const Eigen::Vector4d mean(1100, 1000, 0, 0);
    const MatrixXd covariance = MatrixXd::Identity(4, 4);
    pelorus::TrackEntry entry;
    entry.id = 1;
    entry.status = PLR_TRACK_CONFIRMED;
    entry.mean = mean.data();
    entry.covariance = covariance.data();
    builder.add(entry);
    scheduler.receive(PointingScheduler::tracks_in, builder.message(0));
    const plr_quantity& told = bench.published.at(0).message->body.values->quantities[0];
    REQUIRE(told.numbers.rows == 1);
    CHECK(told.numbers.data[0] == Approx(45 * degree - 0.5));
}

TEST_CASE("pointing scheduler: what cannot be pointed is refused", "[pointing]") {
    CHECK_THROWS_WITH(Rig("{field_of_view: 180 deg}"), "field_of_view: is not below 180 deg");
    CHECK_THROWS_WITH(Rig("{field_of_view: 1 deg, sensor: sonar}"), "sensor: is sonar, the estimator has eye");
    CHECK_THROWS_WITH(Rig("{field_of_view: 1 deg}", "position", "{}"),
                      Catch::Contains("estimator: sensor eye measures no azimuth: "));
}
