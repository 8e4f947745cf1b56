// The Gauss-Hermite filter against integrals that can be looked up, and where it refuses.
#include "../../../tests/support/filter_under_test.hpp"

#include <catch2/catch.hpp>
#include <pelorus/sensor.hpp>

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// z = exp(x).
struct Exponential : pelorus::Sensor<Exponential, 1, 1> {
    static constexpr std::uint32_t flags = PLR_SENSOR_CONSTANT_NOISE;
    static void describe(pelorus::Describe<Exponential>& plugin) { plugin.title("test"); }
    pelorus::Space measurement_space() const {
        return pelorus::Space(std::vector<pelorus::Component>{{"growth", "1", 0.0, 0.0, false}});
    }
    pelorus::Space cartesian_space() const { return pelorus::position_space(1); }
    Measurement measure(const Cartesian& x, const pelorus::Look&) const { return Measurement(std::exp(x(0))); }
    Jacobian jacobian(const Cartesian& x, const pelorus::Look&) const { return Jacobian(std::exp(x(0))); }
    Noise noise(const Query&, const pelorus::Look&) const { return Noise::Identity(); }
};

const plr_plugin& exponential() {
    return *pelorus::detail::plugin<Exponential>("sensor.test_exponential", "sensor.test_exponential");
}

}  // namespace

TEST_CASE("moments of a log-normal variable converge with the order", "[gauss_hermite]") {
    // x ~ N(m, v): E e^x = exp(m + v/2), var e^x = (exp(v) - 1) exp(2m + v), cov(x, e^x) = v exp(m + v/2).
    const double m = 0.3, v = 0.25, mean = std::exp(m + v / 2);
    double last = 1.0;
    for (const char* const order : {"3", "5", "12"}) {
        CAPTURE(order);
        const FilterUnderTest f("gauss_hermite", {{"order", order}}, plugin("motion", "constant_velocity"),
                                exponential(), {{"dimension", "1"}});
        const auto seen = f.projected(f.record_of(Eigen::Vector2d(m, 0.0), Eigen::Vector2d(v, 1.0).asDiagonal()));
        const double off = std::fabs(seen.covariance(0, 0) / ((std::exp(v) - 1.0) * mean * mean) - 1.0);
        CHECK(off < 0.1 * last);
        last = off;
        if (order == std::string("12")) {
            CHECK(seen.measurement(0) == Approx(mean).epsilon(1e-10));
            CHECK(off < 1e-8);
            CHECK(seen.cross(0, 0) == Approx(v * mean).epsilon(1e-10));
        }
    }
}

TEST_CASE("the Gauss-Hermite filter refuses grids of more than 1024 points", "[gauss_hermite]") {
    const auto make = [](const char* order, const char* dimension) {
        const FilterUnderTest f("gauss_hermite", {{"order", order}}, "constant_acceleration",
                                {{"dimension", dimension}}, "position", {{"dimension", dimension}});
    };
    CHECK_NOTHROW(make("10", "1"));
    CHECK_NOTHROW(make("2", "3"));
    try {
        make("3", "3");
        FAIL("was accepted");
    } catch (const Refused& error) {
        CHECK(error.where == "order");
        CHECK(
            std::string(error.what()) ==
            "3 points for each of the 9 components of motion.constant_acceleration are 19683 points, at most 1024 are "
            "taken; estimator.cubature needs 18");
    }
}
