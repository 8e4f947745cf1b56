/// trajectory.acceleration_profile: an object whose acceleration is given over time. See README.md.
#pragma once

#include <optional>
#include <vector>

#include "../../common/trajectories/life.hpp"
#include "profile.hpp"

namespace acceleration_profile {

struct Row {
    double time = 0;          // s
    double x = 0, y = 0;      // m/s2
    std::optional<double> z;  // m/s2
};

class AccelerationProfile : public pelorus::Trajectory<AccelerationProfile>, public trajectories::Life {
public:
    static void describe(pelorus::Describe<AccelerationProfile>& plugin) {
        plugin.title("Acceleration over time")
            .purpose(
                "A point whose acceleration is given over time: linear between the times given, with jumps where a "
                "time stands twice, integrated exactly.")
            .equation("a(t) linear between rows; v(t) = v0 + integral of a; p(t) = p0 + integral of v, in closed form");
        plugin.parameter("start", &AccelerationProfile::start_)
            .unit("m")
            .rows(2, 3)
            .doc("position at birth; its length is the number of axes");
        plugin.parameter("velocity", &AccelerationProfile::velocity_)
            .unit("m/s")
            .rows(2, 3)
            .doc("velocity at birth, one value an axis");
        auto rows = plugin.table("acceleration", &AccelerationProfile::rows_);
        rows.initially("[]").doc(
            "times since birth and the acceleration there, as in [[0 s, 0, -10], [40 s, -20, -10]]; before the first "
            "and after the last it is constant, a time that stands twice is a jump to the later row; none: no "
            "acceleration");
        rows.column("time", &Row::time).unit("s").min(0).doc("since birth; rows ascend");
        rows.column("x", &Row::x).unit("m/s2").doc("acceleration along x");
        rows.column("y", &Row::y).unit("m/s2").doc("acceleration along y");
        rows.column("z", &Row::z).unit("m/s2").doc("acceleration along z; only where start has three axes");
        describe_life(plugin);
    }

    void setup(const pelorus::Setup&) {
        axes_ = static_cast<int>(start_.size());
        trajectories::check_axes("velocity", velocity_.size(), axes_);
        begin_life();
        Axes position{}, velocity{};
        std::copy(start_.begin(), start_.end(), position.begin());
        std::copy(velocity_.begin(), velocity_.end(), velocity.begin());
        profile_.build(position, velocity, knots());
        space_ = pelorus::kinematic_space(axes_, {1e6, 1e3, 1e2});
        info.state = space_.c();
        info.objects = 1;
        info.extent_dimension = 0;
        info.record_version = 1;
        info.record_size = 0;  // nothing about it is random
    }

    void realise(const plr_call&, const plr_view& record) const { pelorus::expect(record, 0, 1, 1, "record"); }

    void states(const plr_call&, const plr_trajectory_states& args) const {
        answer(args, 3 * axes_, 0, [&](std::int64_t t, double age) {
            double* state = args.states.data + t * args.states.col_stride;
            const Motion motion = profile_.at(age);
            std::copy_n(motion.position.begin(), axes_, state);
            std::copy_n(motion.velocity.begin(), axes_, state + axes_);
            std::copy_n(motion.acceleration.begin(), axes_, state + 2 * axes_);
        });
    }

private:
    std::vector<Knot> knots() const {
        std::vector<Knot> out;
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            if (rows_[i].z.has_value() != (axes_ == 3))
                throw pelorus::ParameterError(
                    "acceleration[" + std::to_string(i) + "].z",
                    axes_ == 3 ? "is missing; start has three axes" : "is given; start has two axes");
            out.push_back({rows_[i].time, {rows_[i].x, rows_[i].y, rows_[i].z.value_or(0)}});
        }
        return out;
    }

    std::vector<double> start_, velocity_;
    std::vector<Row> rows_;
    int axes_ = 3;
    Profile profile_;
    pelorus::Space space_;
};

}  // namespace acceleration_profile
