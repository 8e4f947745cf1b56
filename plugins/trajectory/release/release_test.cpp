#include <cstdlib>
#include <fstream>
#include <string>

#include <Eigen/Dense>

#include "../../../tests/support/trajectory_under_test.hpp"

namespace {

using namespace test_support;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

const std::string over_site =
    "{start: [0 m, 0 m, 100 km], velocity: [3000 m/s, 3000 m/s, 3000 m/s], axes: enu, origin: [37.5 deg, 0 deg, 0 m]";

/// All objects of a release at some times.
class Cloud {
public:
    explicit Cloud(const std::string& with, plr_key key = {{1, 2}})
        : instance_(bench_, plugin("trajectory", "release"), with) {
        record_.assign(static_cast<std::size_t>(info().record_size), 0.0);
        Call call;
        call.raw().keys = &key;
        const plr_view record = pelorus::view(record_.data(), info().record_size, 1, 1);
        REQUIRE(table().realise(instance_.self(), &call.raw(), &record) == PLR_OK);
    }
    const plr_trajectory_info& info() const { return *table().info(instance_.self()); }

    /// A matrix an object, a column a time (s).
    std::vector<MatrixXd> at(const std::vector<double>& seconds) {
        const auto objects = static_cast<std::size_t>(info().objects);
        std::vector<std::int64_t> times;
        for (const double s : seconds) times.push_back(std::llround(s * 1e9));
        const auto n = static_cast<std::int64_t>(times.size());
        std::vector<double> states(6 * times.size() * objects);
        std::vector<std::uint64_t> ids(objects);
        std::vector<std::int64_t> deaths(objects);
        parents.assign(objects, 7);
        births.assign(objects, 7);
        auto args = pelorus::arguments<plr_trajectory_states>();
        args.record = pelorus::const_view(record_.data(), info().record_size, 1, 1);
        args.time_count = n;
        args.times = times.data();
        args.states = pelorus::view(states.data(), 6, n, info().objects);
        args.ids = ids.data();
        args.parents = parents.data();
        args.births = births.data();
        args.deaths = deaths.data();
        Call call;
        REQUIRE(table().states(instance_.self(), &call.raw(), &args) == PLR_OK);
        std::vector<MatrixXd> out;
        for (std::size_t k = 0; k < objects; ++k)
            out.emplace_back(Eigen::Map<const MatrixXd>(states.data() + 6 * times.size() * k, 6, n));
        return out;
    }
    std::vector<std::int64_t> parents, births;

private:
    const plr_trajectory& table() const { return instance_.table<plr_trajectory>(); }
    Bench bench_;
    BenchInstance instance_;
    std::vector<double> record_;
};

}  // namespace

TEST_CASE("release: the object flies as an independent integration says", "[release]") {
    Cloud cloud(over_site + "}");
    const auto states = cloud.at({0.0, 760.0});
    CHECK(states[0].col(0).head<3>() == Vector3d(0.0, 0.0, 1e5));
    CHECK((states[0].col(1).head<3>() - Vector3d(2082313.748, 1972529.612, 121524.833)).norm() < 1e-3);
}

TEST_CASE("release: the object's recorded path is met at every second", "[release]") {
    const char* const data = std::getenv("PELORUS_DATA");
    std::ifstream file(std::string(data == nullptr ? "" : data) + "/space_groups/seed1_truth.csv");
    if (!file) {
        WARN("skipped: PELORUS_DATA names no folder with space_groups/seed1_truth.csv");
        return;
    }
    std::vector<double> seconds;
    for (int k = 0; k <= 760; ++k) seconds.push_back(k);
    Cloud cloud(over_site + "}");
    const MatrixXd object = cloud.at(seconds)[0];
    int rows = 0;
    double worst = 0.0;
    for (std::string line; std::getline(file, line);) {
        int k = 0, i = 0;
        Vector3d p;
        REQUIRE(std::sscanf(line.c_str(), "%d,%d,%lf,%lf,%lf", &k, &i, &p(0), &p(1), &p(2)) == 5);
        if (i != 0) continue;
        ++rows;
        worst = std::max(worst, (object.col(k).head<3>() - p).norm());
    }
    CHECK(rows == 760);
    CHECK(worst < 2e-6);  // told to the micrometre
}

TEST_CASE("release: decoys leave the object in any direction at a uniform speed", "[release]") {
    Cloud cloud(over_site + ", decoys: 4000}");
    const auto states = cloud.at({0.0});
    Vector3d sum = Vector3d::Zero();
    Matrix3d square = Matrix3d::Zero();
    double speeds = 0.0, squares = 0.0;
    for (std::size_t k = 1; k < states.size(); ++k) {
        CHECK(states[k].col(0).head<3>() == states[0].col(0).head<3>());
        const Vector3d v = (states[k] - states[0]).col(0).tail<3>();
        CHECK(v.norm() >= 3.0 - 1e-9);
        CHECK(v.norm() <= 10.0 + 1e-9);
        sum += v.normalized() / 4000.0;
        square += v.normalized() * v.normalized().transpose() / 4000.0;
        speeds += v.norm() / 4000.0;
        squares += v.squaredNorm() / 4000.0;
    }
    CHECK(sum.cwiseAbs().maxCoeff() < 4.5 * std::sqrt(1.0 / 3.0 / 4000.0));
    CHECK((square - Matrix3d::Identity() / 3.0).cwiseAbs().maxCoeff() < 4.5 * std::sqrt(4.0 / 45.0 / 4000.0));
    CHECK(speeds == Approx(6.5).margin(4.5 * std::sqrt(49.0 / 12.0 / 4000.0)));
    CHECK(squares - speeds * speeds == Approx(49.0 / 12.0).epsilon(0.06));
}

TEST_CASE("release: along the axes each component is uniform", "[release]") {
    Cloud cloud(over_site + ", decoys: 4000, release: axes}");
    const auto states = cloud.at({0.0});
    Vector3d mean = Vector3d::Zero();
    for (std::size_t k = 1; k < states.size(); ++k) {
        const Vector3d v = (states[k] - states[0]).col(0).tail<3>();
        CHECK(v.minCoeff() >= 3.0 - 1e-9);
        CHECK(v.maxCoeff() <= 10.0 + 1e-9);
        mean += v / 4000.0;
    }
    CHECK((mean - Vector3d::Constant(6.5)).cwiseAbs().maxCoeff() < 4.5 * std::sqrt(49.0 / 12.0 / 4000.0));
}

TEST_CASE("release: decoys are born of the object where it is when it releases them", "[release]") {
    Cloud cloud(over_site + ", decoys: 2, release_time: 10.5 s}");
    const auto states = cloud.at({10.0, 10.5, 11.5});
    CHECK(cloud.parents == std::vector<std::int64_t>{-1, 0, 0});
    CHECK(cloud.births == std::vector<std::int64_t>{0, 10'500'000'000, 10'500'000'000});
    for (const std::size_t k : {1u, 2u}) {
        CHECK(std::isnan(states[k](0, 0)));
        CHECK((states[k] - states[0]).col(1).head<3>().norm() == 0.0);
        const Vector3d left = (states[k] - states[0]).col(1).tail<3>();
        CHECK((states[k] - states[0]).col(2).head<3>().norm() == Approx(left.norm()).epsilon(1e-5));
    }
}

TEST_CASE("release: a decoy more leaves the others as they are, and another key draws others", "[release]") {
    Cloud few(over_site + ", decoys: 3}"), many(over_site + ", decoys: 5}"),
        other(over_site + ", decoys: 3}", {{1, 3}});
    const auto a = few.at({100.0}), b = many.at({100.0}), c = other.at({100.0});
    for (std::size_t k = 0; k < 4; ++k) CHECK(a[k] == b[k]);
    CHECK(a[0] == c[0]);
    CHECK(a[1] != c[1]);
}

TEST_CASE("release: a key is asked for only where something is drawn", "[release]") {
    const auto status_without_key = [](const std::string& with) {
        Bench bench;
        BenchInstance instance(bench, plugin("trajectory", "release"), with);
        const auto& table = instance.table<plr_trajectory>();
        std::vector<double> numbers(static_cast<std::size_t>(table.info(instance.self())->record_size), 7.0);
        const plr_view record = pelorus::view(numbers.data(), static_cast<std::int64_t>(numbers.size()), 1, 1);
        Call call;
        const plr_status status = table.realise(instance.self(), &call.raw(), &record);
        for (const double each : numbers) CHECK(each == (status == PLR_OK ? 4.0 : 7.0));
        return status;
    };
    const std::string flat = "{start: [0, 0, 1000], velocity: [0, 0, 0], ";
    CHECK(status_without_key(flat + "decoys: 0}") == PLR_OK);
    CHECK(status_without_key(flat + "release: axes, release_speed: [4, 4]}") == PLR_OK);
    CHECK(status_without_key(flat + "release_speed: [4, 4]}") == PLR_E_ARGUMENT);
}

TEST_CASE("release: what makes no sense is refused by name", "[release]") {
    const std::string flat = "{start: [0, 0, 1000], velocity: [0, 0, 0], ";
    CHECK(refusal_of("trajectory", "release", flat + "release_speed: [10, 3]}") ==
          "release_speed: is [least, greatest]");
    CHECK(refusal_of("trajectory", "release", flat + "release_speed: [-1, 3]}") ==
          "release_speed: is negative, which belongs to release: axes");
    CHECK(refusal_of("trajectory", "release", flat + "axes: enu}") ==
          "origin: is needed by axes: enu and axes: ned: latitude, longitude, height");
    CHECK(refusal_of("trajectory", "release", flat + "release_time: 1e10 s}") ==
          "release_time: is beyond what a clock of nanoseconds can tell (9e9 s)");
    CHECK(refusal_of("trajectory", "release", flat + "release: axes, release_speed: [-1, 3]}").empty());
}
