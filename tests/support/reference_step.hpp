// One step of a point filter against that of an established library, tests/reference/models_and_filters.json.
#pragma once

#include "filter_under_test.hpp"
#include "reference.hpp"

#include <catch2/catch.hpp>
#include <pelorus/motion.hpp>

namespace test_support {

/// Constant velocity in the library's order, (x, vx, y, vy, z, vz): which points a factor gives depends on the order.
struct InterleavedVelocity : pelorus::Motion<InterleavedVelocity, 6> {
    static constexpr std::uint32_t flags = PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE;
    static void describe(pelorus::Describe<InterleavedVelocity>& plugin) { plugin.title("test"); }
    pelorus::Space space() const {
        std::vector<pelorus::Component> components;
        for (const char* const axis : {".x", ".y", ".z"}) {
            components.push_back({std::string("position") + axis, "m", 0.0, 1e6, false});
            components.push_back({std::string("velocity") + axis, "m/s", 0.0, 100.0, false});
        }
        return pelorus::Space(std::move(components));
    }
    State propagate(const State& x, const pelorus::Step& step) const { return jacobian(x, step) * x; }
    Transition jacobian(const State&, const pelorus::Step& step) const {
        Transition f = Transition::Identity();
        for (int k = 0; k < 6; k += 2) f(k, k + 1) = step.dt;
        return f;
    }
    Transition noise(const Posterior&, const pelorus::Step& step) const {
        const double dt = step.dt;
        Transition q = Transition::Zero();
        for (int k = 0; k < 6; k += 2) q.block<2, 2>(k, k) << dt * dt * dt / 3.0, dt * dt / 2.0, dt * dt / 2.0, dt;
        return q;
    }
};

/// The step of `filter case` by the estimator of that name is that under `answer`, in both forms.
inline void check_reference_step(const std::string& name, const Values& values, const std::string& answer) {
    const auto answers = reference("models_and_filters.json");
    const auto& given = answers.at("filter case");
    const auto& expected = answers.at(answer);
    const std::vector<int> measurement{2, 1, 0}, column{0};  // theirs: (elevation, azimuth, range)
    const plr_plugin& motion =
        *pelorus::detail::plugin<InterleavedVelocity>("motion.test_interleaved", "motion.test_interleaved");
    for (const char* const form : {"square_root", "covariance"}) {
        CAPTURE(form);
        Values all = values;
        all["form"] = form;
        FilterUnderTest f(name, all, motion, plugin("sensor", "spherical"));
        Batch record = f.record_of(matrix(given.at("x")), matrix(given.at("P")));
        record = f.predicted(given.at("dt").get<double>(), record);
        CHECK(relative(f.mean(record), matrix(expected.at("xp"))) < 1e-12);
        CHECK(relative(f.covariance(record), matrix(expected.at("Pp"))) < 1e-10);
        CHECK(relative(f.projected(record).measurement, reordered(matrix(expected.at("zp")), measurement, column)) <
              1e-9);
        record = f.updated(reordered(matrix(given.at("z")), measurement, column),
                           reordered(matrix(given.at("R")), measurement, measurement), record);
        CHECK(relative(f.told.covariance, reordered(matrix(expected.at("S")), measurement, measurement)) < 1e-6);
        CHECK(relative(f.mean(record), matrix(expected.at("x"))) < 1e-6);
        // The library's variance of the elevation by cubature points is 3e-6 off the rule's; its gain is off by as much.
        CHECK(relative(f.covariance(record), matrix(expected.at("P"))) < 1e-5);
    }
}

}  // namespace test_support
