/// trajectory.legs: an object that flies straight lines and arcs. See README.md.
#pragma once

#include <optional>
#include <vector>

#include <pelorus/batch_model.hpp>

#include "../../common/trajectories/life.hpp"
#include "path.hpp"

namespace legs {

struct Row {
    std::optional<double> duration;   // s
    std::optional<double> turn_rate;  // rad/s
    double acceleration = 0;          // m/s2
};

class Legs : public pelorus::Trajectory<Legs>, public trajectories::Life {
public:
    static void describe(pelorus::Describe<Legs>& plugin) {
        plugin.title("Legs")
            .purpose(
                "An object that flies legs of constant turn rate and constant acceleration along its track: straight "
                "lines, exact "
                "arcs, spirals. It may be an ellipsoid whose first half axis points where it flies.")
            .equation(
                "v = (s + a t) (cos g cos(h + w t), cos g sin(h + w t), sin g), p its exact integral; X = a^2 u u' + "
                "b^2 l l' + c^2 "
                "n n' with u along v, l to the left, n normal to both");
        plugin.parameter("start", &Legs::start_)
            .unit("m")
            .rows(2, 3)
            .doc("position at birth; its length is the number of axes");
        plugin.parameter("speed", &Legs::speed_)
            .unit("m/s")
            .min(0)
            .doc("speed over ground, with heading; or give velocity");
        plugin.parameter("heading", &Legs::heading_)
            .unit("rad")
            .doc("direction over ground, from +x towards +y; 0 if absent");
        plugin.parameter("climb", &Legs::climb_).unit("m/s").doc("vertical speed, up; 0 if absent");
        plugin.parameter("velocity", &Legs::velocity_)
            .unit("m/s")
            .rows(2, 3)
            .doc("velocity at birth as a vector, instead of speed, heading and climb");
        plugin.parameter("turn_rate", &Legs::turn_rate_)
            .unit("rad/s")
            .initially("0 rad/s")
            .doc("change of heading where no leg says otherwise, positive to the left: without legs, and after them");
        auto legs = plugin.table("legs", &Legs::rows_);
        legs.initially("[]").doc(
            "what it does, one leg after the other; then on with turn_rate. None: with turn_rate from the start");
        legs.column("duration", &Row::duration)
            .unit("s")
            .above(0)
            .doc("how long; the last leg's may be absent: for ever");
        legs.column("turn_rate", &Row::turn_rate)
            .unit("rad/s")
            .doc("change of heading, positive to the left; that of the target if absent");
        legs.column("acceleration", &Row::acceleration)
            .unit("m/s2")
            .initially("0 m/s2")
            .doc("change of the speed along the track, climb included");
        plugin.parameter("semi_axes", &Legs::semi_axes_)
            .unit("m")
            .above(0)
            .rows(2, 3)
            .doc("half axes along the velocity, to its left, and normal to both; absent: a point");
        describe_life(plugin);
    }

    void setup(const pelorus::Setup&) {
        axes_ = static_cast<int>(start_.size());
        if (semi_axes_) trajectories::check_axes("semi_axes", semi_axes_->size(), axes_);
        path_.build(first(), legs());
        begin_life();
        space_ = pelorus::kinematic_space(axes_, {1e6, 1e3, 1e2});
        info.state = space_.c();
        info.objects = 1;
        info.extent_dimension = semi_axes_ ? axes_ : 0;
        info.record_version = 1;
        info.record_size = 0;  // nothing about it is random
    }

    void realise(const plr_call&, const plr_view& record) const { pelorus::expect(record, 0, 1, 1, "record"); }

    void states(const plr_call&, const plr_trajectory_states& args) const {
        answer(args, 3 * axes_, axes_, [&](std::int64_t t, double age) {
            double* state = args.states.data + t * args.states.col_stride;
            const Motion motion = path_.at(age);
            std::copy_n(motion.position, axes_, state);
            std::copy_n(motion.velocity, axes_, state + axes_);
            std::copy_n(motion.acceleration, axes_, state + 2 * axes_);
            if (args.extents.data != nullptr) write_extent(motion, args.extents.data + t * args.extents.col_stride);
        });
    }

private:
    Path::Start first() const {
        Path::Start out;
        std::copy(start_.begin(), start_.end(), out.position);
        double level = speed_.value_or(0), rise = climb_.value_or(0);
        out.heading = heading_.value_or(0);
        if (velocity_) {
            if (speed_ || heading_ || climb_)
                throw pelorus::ParameterError("velocity",
                                              "stands instead of speed, heading and climb; give one or the other");
            trajectories::check_axes("velocity", velocity_->size(), axes_);
            const std::vector<double>& v = *velocity_;
            level = std::hypot(v[0], v[1]);
            rise = axes_ == 3 ? v[2] : 0;
            out.heading = level > 0 ? std::atan2(v[1], v[0]) : 0;
        } else if (!speed_) {
            throw pelorus::ParameterError("speed", "is missing; give speed and heading, or velocity");
        }
        if (axes_ == 2 && rise != 0) throw pelorus::ParameterError("climb", "needs a third axis; start has two");
        out.speed = std::hypot(level, rise);
        out.climb_angle = out.speed > 0 ? std::atan2(rise, level) : 0;
        return out;
    }

    std::vector<Leg> legs() const {
        std::vector<Leg> out;
        const double for_ever = std::numeric_limits<double>::infinity();
        for (const Row& row : rows_)
            out.push_back({row.duration.value_or(for_ever), row.turn_rate.value_or(turn_rate_), row.acceleration});
        if (turn_rate_ != 0 && (rows_.empty() || rows_.back().duration)) out.push_back({for_ever, turn_rate_, 0});
        return out;
    }

    void write_extent(const Motion& motion, double* extent) const {
        const double* const directions[3] = {motion.along, motion.left, motion.up};
        for (int col = 0; col < axes_; ++col)
            for (int row = 0; row < axes_; ++row) {
                double sum = 0;
                for (int k = 0; k < axes_; ++k) {
                    const double half_axis = (*semi_axes_)[static_cast<std::size_t>(k)];
                    sum += half_axis * half_axis * directions[k][row] * directions[k][col];
                }
                extent[col * axes_ + row] = sum;
            }
    }

    std::vector<double> start_;
    std::optional<double> speed_, heading_, climb_;
    std::optional<std::vector<double>> velocity_, semi_axes_;
    std::vector<Row> rows_;
    double turn_rate_ = 0;

    int axes_ = 3;
    Path path_;
    pelorus::Space space_;
};

}  // namespace legs
