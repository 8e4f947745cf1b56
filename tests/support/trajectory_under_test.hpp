// A trajectory asked at any times.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "airship_parts.hpp"

namespace test_support {

class TrajectoryUnderTest {
public:
    struct States {
        Eigen::MatrixXd states, extents;  ///< a column a time
        std::int64_t birth, death;
    };

    explicit TrajectoryUnderTest(const std::string& name, const std::string& with, std::vector<Part> parts = {},
                                 plr_key key = {{1, 2}})
        : bench_(std::make_unique<Bench>()), instance_(*bench_, plugin("trajectory", name), with, std::move(parts)) {
        record_.assign(static_cast<std::size_t>(info().record_size), pelorus::not_a_number);
        Call call;
        call.raw().keys = &key;
        const plr_view record = pelorus::view(record_.data(), info().record_size, 1, 1);
        REQUIRE(table().realise(instance_.self(), &call.raw(), &record) == PLR_OK);
    }
    const plr_trajectory& table() const { return instance_.table<plr_trajectory>(); }
    const plr_trajectory_info& info() const { return *table().info(instance_.self()); }

    States at(const std::vector<double>& seconds) const {
        Call call;
        std::vector<std::int64_t> times;
        for (const double s : seconds) times.push_back(std::llround(s * 1e9));
        const auto n = static_cast<std::int64_t>(times.size());
        const std::int64_t c = info().state->size, d = info().extent_dimension;
        States out{Eigen::MatrixXd(c, n), Eigen::MatrixXd(d * d, n), 0, 0};
        std::uint64_t id = 7;
        std::int64_t parent = 7;
        auto args = pelorus::arguments<plr_trajectory_states>();
        args.record = pelorus::const_view(record_.data(), info().record_size, 1, 1);
        args.time_count = n;
        args.times = times.data();
        args.states = pelorus::view(out.states.data(), c, n, 1);
        if (d != 0) args.extents = pelorus::view(out.extents.data(), d * d, n, 1);
        args.ids = &id;
        args.parents = &parent;
        args.births = &out.birth;
        args.deaths = &out.death;
        const plr_status status = table().states(instance_.self(), &call.raw(), &args);
        INFO(call.message());
        REQUIRE(status == PLR_OK);
        CHECK(id == 0);
        CHECK(parent == -1);
        return out;
    }
    /// Derivative 0, 1, 2 (position, velocity, acceleration) at a time.
    Eigen::VectorXd part(int derivative, double t) const {
        const Eigen::VectorXd state = at({t}).states.col(0);
        const Eigen::Index axes = axes_of(*info().state);
        return state.segment(derivative * axes, axes);
    }
    Eigen::VectorXd position(double t) const { return part(0, t); }
    Eigen::VectorXd velocity(double t) const { return part(1, t); }
    Eigen::VectorXd acceleration(double t) const { return part(2, t); }

private:
    static Eigen::Index axes_of(const plr_space& space) {
        const pelorus::Space named(space);
        return named.index("position.z") >= 0 ? 3 : 2;
    }
    std::unique_ptr<Bench> bench_;  // outlives the instance
    BenchInstance instance_;
    std::vector<double> record_;
};

/// What a plugin of one of the kinds that have no slots tells of parameters that it does not take; "" where it does.
inline std::string refusal_of(const std::string& kind, const std::string& name, const std::string& with) {
    Bench bench;
    try {
        const BenchInstance instance(bench, plugin(kind, name), with);
        return "";
    } catch (const std::exception& problem) {
        return problem.what();
    }
}

}  // namespace test_support
