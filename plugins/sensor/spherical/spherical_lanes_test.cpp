// Whole batches of sensor.spherical: the same bytes as single points, for every instruction set, and what the textbook says.
#include "../../../tests/support/sensor_checks.hpp"
#include "../../common/sensing/spherical_model.hpp"
#include "spherical_kernels.hpp"

#include <cstring>
#include <random>

#include <pelorus/sensor.hpp>

using namespace test_support;
using namespace spherical_kernels;
using Numbers = std::vector<double>;

namespace {

constexpr int count = 21;

Mounting mounting(bool is_zenith) {
    Mounting out{};
    const Eigen::Matrix3d rotation = spherical::rotation(0.3, -0.2, 2.0);
    std::copy_n(rotation.data(), 9, out.rotation);
    const double place[] = {100, -50, 20}, bias[] = {5, 0.01, -0.02};
    std::copy_n(place, 3, out.position);
    std::copy_n(bias, 3, out.bias);
    out.is_zenith = is_zenith;
    return out;
}

/// Points of all sizes and directions; the last ones above the sensor and at its place.
Numbers places() {
    std::mt19937_64 engine(5);
    std::normal_distribution<double> normal;
    Numbers out;
    for (int i = 0; i < count; ++i) {
        const double size = i == 3 ? 1e200 : i == 4 ? 1e160 : std::pow(10.0, i % 7);
        for (int k = 0; k < 3; ++k) out.push_back(size * normal(engine));
    }
    const Mounting mount = mounting(false);
    for (int k = 0; k < 3; ++k) {
        out[static_cast<std::size_t>(3 * (count - 2) + k)] = mount.position[k] + 500.0 * mount.rotation[6 + k];
        out[static_cast<std::size_t>(3 * (count - 1) + k)] = mount.position[k];
    }
    return out;
}

bool same_bytes(const Numbers& a, const Numbers& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

/// What `call(kernels, first item, items)` leaves in `out`, for every instruction set, alone and together: one answer.
template <class Call> void agreed(Numbers& out, Call call) {
    Numbers expected;
    for (const lanes::InstructionSet set : lanes::instruction_sets) {
        if (!lanes::is_supported(set)) continue;
        for (const int step : {1, 2, 5, count}) {
            std::fill(out.begin(), out.end(), 7.0);
            for (int first = 0; first < count; first += step) call(kernels(set), first, std::min(step, count - first));
            if (expected.empty()) expected = out;
            CAPTURE(static_cast<int>(set), step);
            CHECK(same_bytes(out, expected));
        }
    }
}

}  // namespace

TEST_CASE("points over lanes are seen where the textbook sees them, in any company", "[sensor]") {
    const Numbers from = places();
    for (const bool is_zenith : {false, true}) {
        const Mounting mount = mounting(is_zenith);
        Numbers seen(from.size());
        agreed(seen, [&](const Kernels& by, int first, int items) {
            Fault faults[count] = {};
            by.measure(mount, items, 1, {from.data() + 3 * first, 3, 3}, {seen.data() + 3 * first, 3, 3}, faults);
            for (const Fault fault : faults) CHECK(fault == Fault::none);
        });
        const Eigen::Map<const Eigen::Matrix3d> rotation(mount.rotation);
        for (int i = 0; i < count; ++i) {
            const Eigen::Vector3d p = Eigen::Map<const Eigen::Vector3d>(from.data() + 3 * i) -
                                      Eigen::Map<const Eigen::Vector3d>(mount.position);
            Eigen::Vector3d z = spherical::from_cartesian(rotation.transpose() * p);
            if (is_zenith) z(2) = spherical::half_pi - z(2);
            z += Eigen::Map<const Eigen::Vector3d>(mount.bias);
            CAPTURE(is_zenith, i);
            const double* const got = seen.data() + 3 * i;
            CHECK(got[0] == Approx(z(0)).epsilon(1e-14));
            if (i == count - 2) continue;  // above the sensor azimuth is any
            CHECK(std::fabs(pelorus::wrap_angle(got[1] - z(1))) < 1e-14);
            CHECK(std::fabs(pelorus::wrap_angle(got[2] - z(2))) < 1e-14);
            CHECK(std::fabs(got[1]) <= std::acos(-1.0));
        }
    }
}

TEST_CASE("Jacobians over lanes are the textbook's, and a point that has none is told and left alone", "[sensor]") {
    const Numbers from = places();
    for (const bool is_zenith : {false, true}) {
        const Mounting mount = mounting(is_zenith);
        Numbers jacobians(from.size() * 3);
        Fault faults[count];
        agreed(jacobians, [&](const Kernels& by, int first, int items) {
            std::fill_n(faults + first, items, Fault::none);
            by.differentiate(mount, items, {from.data() + 3 * first, 3, 0}, {jacobians.data() + 9 * first, 9, 0},
                             faults + first);
        });
        const Eigen::Map<const Eigen::Matrix3d> rotation(mount.rotation);
        for (int i = 0; i < count; ++i) {
            const Eigen::Map<const Eigen::Matrix3d> got(jacobians.data() + 9 * i);
            CAPTURE(is_zenith, i);
            if (i >= count - 2) {
                CHECK(faults[i] == (i == count - 1 ? Fault::at_sensor : Fault::on_axis));
                CHECK((got.array() == 7.0).all());
                continue;
            }
            CHECK(faults[i] == Fault::none);
            Eigen::Matrix3d along;
            const Eigen::Vector3d p = Eigen::Map<const Eigen::Vector3d>(from.data() + 3 * i) -
                                      Eigen::Map<const Eigen::Vector3d>(mount.position);
            REQUIRE(spherical::jacobian(rotation.transpose() * p, along));
            if (is_zenith) along.row(2) *= -1.0;
            const Eigen::Matrix3d expected = along * rotation.transpose();
            for (int r = 0; r < 3; ++r) CHECK((got.row(r) - expected.row(r)).norm() <= 1e-13 * expected.row(r).norm());
        }
    }
}

TEST_CASE("a batch of a spherical sensor gives what single points give, whatever lies between its items", "[sensor]") {
    const Instance instance("sensor", "spherical", {{"position", "[100, -50, 20]"}, {"attitude", "[0.3, -0.2, 2.0]"}});
    const auto sensor = instance.as<pelorus::SensorPart>();
    const std::int64_t items = 5, points = 3, gap = 11;
    const Numbers from = places();
    Numbers spread(static_cast<std::size_t>(items * gap));
    for (std::int64_t i = 0; i < items; ++i) std::copy_n(from.data() + 9 * i, 9, spread.data() + i * gap);
    // Inputs of all items, equal ones: common to them, and one set each.
    Numbers inputs;
    const Numbers one{5.0, 0.01, -0.02, 1.0, 2.0, 3.0, 0.0, 0.1, 0.0, 0.2, -0.1, 0.3};
    for (std::int64_t i = 0; i < items; ++i) inputs.insert(inputs.end(), one.begin(), one.end());
    for (const std::int64_t stride : {std::int64_t{0}, std::int64_t{12}}) {
        CAPTURE(stride);
        Call call(static_cast<std::size_t>(items));
        call.inputs(inputs.data(), stride);
        Numbers seen(static_cast<std::size_t>(items * 9)), differences(seen.size());
        auto measure = pelorus::arguments<plr_sensor_measure>();
        measure.cartesian = {spread.data(), 3, points, items, 1, 3, gap};
        measure.out = pelorus::view(seen.data(), 3, points, items);
        REQUIRE(sensor.call(&plr_sensor::measure, call, measure) == PLR_OK);
        auto compare = pelorus::arguments<plr_sensor_residual>();
        compare.measurement = pelorus::as_const(measure.out);
        compare.reference = {seen.data(), 3, 1, items, 1, 3, 9};
        compare.out = pelorus::view(differences.data(), 3, points, items);
        REQUIRE(sensor.call(&plr_sensor::residual, call, compare) == PLR_OK);
        SensorUnderTest alone(instance);
        alone.inputs(one.data());
        for (std::int64_t i = 0; i < items * points; ++i) {
            const Eigen::VectorXd z = alone.measure(Eigen::Map<const Eigen::Vector3d>(from.data() + 3 * i));
            const Eigen::VectorXd centre =
                alone.measure(Eigen::Map<const Eigen::Vector3d>(from.data() + 9 * (i / points)));
            CHECK(z == Eigen::Map<const Eigen::Vector3d>(seen.data() + 3 * i));
            CHECK(alone.residual(z, centre) == Eigen::Map<const Eigen::Vector3d>(differences.data() + 3 * i));
        }
    }
}

TEST_CASE("a point that is no number, or too far for one, fails its item of a spherical sensor alone", "[sensor]") {
    const Mounting mount = mounting(false);
    const double far = 1.7e308, none = std::nan("");
    const Numbers from{1, 2, 3, none, 2, 3, 4, 5, 6, far, far, far, 7, 8, 9};
    for (const lanes::InstructionSet set : lanes::instruction_sets) {
        if (!lanes::is_supported(set)) continue;
        Numbers seen(15, 7.0);
        Fault faults[5] = {};
        kernels(set).measure(mount, 5, 1, {from.data(), 3, 3}, {seen.data(), 3, 3}, faults);
        for (int i = 0; i < 5; ++i) {
            CHECK(faults[i] == (i % 2 == 1 ? Fault::not_finite : Fault::none));
            CHECK((seen[static_cast<std::size_t>(3 * i)] == 7.0) == (i % 2 == 1));
        }
    }
}
