/// trajectory.segments: an object that accelerates, turns and loops, one after the other. See README.md.
#pragma once

#include <optional>
#include <vector>

#include "../../common/trajectories/life.hpp"
#include "path.hpp"

namespace segments {

struct Row {
    std::optional<double> duration;                  // s
    double turn_rate = 0, loop_rate = 0, along = 0;  // rad/s, rad/s, m/s2
    double x = 0, y = 0, z = 0;                      // m/s2
};

class Segments : public pelorus::Trajectory<Segments>, public trajectories::Life {
public:
    static void describe(pelorus::Describe<Segments>& plugin) {
        plugin.title("Segments in space")
            .purpose(
                "A point in space that flies one segment after the other: straight on, under a constant acceleration, "
                "along an exact arc to the side (turn) or in the vertical plane of its velocity (loop).")
            .equation(
                "constant a: v = v0 + a t; rate of turn w about the axis k: v = c + cos(w t) u + sin(w t) k x u with "
                "c = k k' v0, u = v0 - c; p its exact integral");
        plugin.parameter("start", &Segments::start_).unit("m").doc("position at birth; z is up");
        plugin.parameter("velocity", &Segments::velocity_).unit("m/s").doc("velocity at birth");
        auto rows = plugin.table("segments", &Segments::rows_);
        rows.initially("[]").doc("what it does, one segment after the other; then straight on");
        rows.column("duration", &Row::duration)
            .unit("s")
            .above(0)
            .doc("how long; the last one's may be absent: for ever");
        rows.column("loop_rate", &Row::loop_rate)
            .unit("rad/s")
            .initially("0 rad/s")
            .doc("turn in the vertical plane of the velocity with which the segment begins, positive upwards");
        rows.column("turn_rate", &Row::turn_rate)
            .unit("rad/s")
            .initially("0 rad/s")
            .doc("turn about the vertical, positive to the left; with loop_rate: about the sum of both axes");
        rows.column("along", &Row::along)
            .unit("m/s2")
            .initially("0 m/s2")
            .doc("acceleration along the velocity with which the segment begins");
        rows.column("x", &Row::x).unit("m/s2").initially("0 m/s2").doc("constant acceleration along x");
        rows.column("y", &Row::y).unit("m/s2").initially("0 m/s2").doc("constant acceleration along y");
        rows.column("z", &Row::z).unit("m/s2").initially("0 m/s2").doc("constant acceleration along z");
        describe_life(plugin);
    }

    void setup(const pelorus::Setup&) {
        begin_life();
        std::vector<Segment> all;
        for (const Row& row : rows_) {
            Segment segment;
            if (row.duration) segment.duration = *row.duration;
            segment.turn_rate = row.turn_rate;
            segment.loop_rate = row.loop_rate;
            segment.along = row.along;
            segment.acceleration << row.x, row.y, row.z;
            all.push_back(segment);
        }
        path_.build(start_, velocity_, all);
        space_ = pelorus::kinematic_space(3, {1e6, 1e3, 1e2});
        info.state = space_.c();
        info.objects = 1;
        info.extent_dimension = 0;
        info.record_version = 1;
        info.record_size = 0;  // nothing about it is random
    }

    void realise(const plr_call&, const plr_view& record) const { pelorus::expect(record, 0, 1, 1, "record"); }

    void states(const plr_call&, const plr_trajectory_states& args) const {
        answer(args, 9, 0, [&](std::int64_t t, double age) {
            double* state = args.states.data + t * args.states.col_stride;
            const Motion motion = path_.at(age);
            std::copy_n(motion.position.data(), 3, state);
            std::copy_n(motion.velocity.data(), 3, state + 3);
            std::copy_n(motion.acceleration.data(), 3, state + 6);
        });
    }

private:
    Vector<3> start_ = Vector<3>::Zero(), velocity_ = Vector<3>::Zero();
    std::vector<Row> rows_;
    Path path_;
    pelorus::Space space_;
};

}  // namespace segments
