/// trajectory.release: an object in free flight that releases decoys. See README.md.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <pelorus/batch_model.hpp>

#include "../../common/ballistic/flight.hpp"
#include "../../common/ballistic/frame.hpp"
#include "../../common/trajectories/life.hpp"

namespace release {

using pelorus::Vector;

/// How the velocities with which decoys leave the object are drawn.
enum class Spread { isotropic, axes };

/// A flight in steps of 1 s that are counted from its beginning, so that the state at a time does not depend on what else is asked.
class Path {
public:
    Path(const ballistic::Flight& flight, const Vector<6>& start, std::int64_t begin)
        : flight_(flight), state_(start), begin_(begin) {}

    /// State (m, m/s) at a time (ns), not earlier than any asked before.
    Vector<6> at(std::int64_t time) {
        const std::int64_t age = time - begin_;
        for (; (steps_ + 1) * step <= age; ++steps_) state_ = flight_.propagate<6>(state_, 1.0);
        const std::int64_t rest = age - steps_ * step;
        return rest == 0 ? state_ : flight_.propagate<6>(state_, static_cast<double>(rest) * 1e-9);
    }

private:
    static constexpr std::int64_t step = 1'000'000'000;  // ns

    const ballistic::Flight& flight_;
    Vector<6> state_;
    std::int64_t begin_, steps_ = 0;
};

class Release : public pelorus::Trajectory<Release>, public ballistic::FrameParameters {
public:
    static void describe(pelorus::Describe<Release>& plugin) {
        plugin.title("Release of decoys")
            .purpose(
                "An object in free flight under gravity and the forces of a frame that turns with the Earth releases "
                "decoys at one time, which fly on by themselves: one group first, then smaller ones, then single "
                "objects.")
            .equation(
                "p' = v, v' = g(r) - 2 w x v - w x (w x r) with J2, Runge-Kutta of fourth order in steps of 1 s; decoy "
                "i: "
                "p and v of the object at release_time, v + s u, s uniform in release_speed and u uniform on the "
                "sphere "
                "(isotropic), or each component of what is added uniform in release_speed (axes)")
            .source(
                "L. Han, L. Zhou, Research on group partitioning algorithm of space dense targets, Journal of Ordnance "
                "Equipment Engineering 41(12), 240-246, 2020; O. Montenbruck, E. Gill, Satellite Orbits, Springer "
                "2000, "
                "3.2");
        plugin.parameter("start", &Release::start_)
            .unit("m")
            .rows(3, 3)
            .doc("position of the object at the start of the run");
        plugin.parameter("velocity", &Release::velocity_)
            .unit("m/s")
            .rows(3, 3)
            .doc("its velocity then, relative to the frame");
        plugin.parameter("decoys", &Release::decoys_).initially("15").min(0).max(10000).doc("how many it releases");
        plugin.parameter("release", &Release::spread_)
            .initially("isotropic")
            .choices({{"isotropic", "in any direction, the speed uniform in release_speed"},
                      {"axes", "each component of the velocity uniform in release_speed, independently"}})
            .doc("how the velocities are drawn with which the decoys leave the object");
        plugin.parameter("release_speed", &Release::speed_)
            .unit("m/s")
            .initially("[3 m/s, 10 m/s]")
            .rows(2, 2)
            .doc("least and greatest; with axes they may be negative");
        plugin.parameter("release_time", &Release::time_)
            .unit("s")
            .initially("0 s")
            .min(0)
            .doc("when it releases them, all at once");
        ballistic::describe_frame(plugin, "flat");
    }

    void setup(const pelorus::Setup& setup) {
        if (!(speed_[0] <= speed_[1])) throw pelorus::ParameterError("release_speed", "is [least, greatest]");
        if (spread_ == Spread::isotropic && speed_[0] < 0)
            throw pelorus::ParameterError("release_speed", "is negative, which belongs to release: axes");
        random_ = &setup.service<plr_random>();
        flight_.earth = ballistic::earth_of(*this);
        flight_.flat = axes == ballistic::Axes::flat;
        released_ = trajectories::nanoseconds("release_time", time_);
        first_ << start_[0], start_[1], start_[2], velocity_[0], velocity_[1], velocity_[2];
        space_ = pelorus::kinematic_space(3, {1e6, 1e3});
        info.flags = decoys_ > 0 && is_random() ? PLR_FLAG_USES_KEYS : 0;
        info.state = space_.c();
        info.objects = 1 + decoys_;
        info.extent_dimension = 0;
        info.record_version = 1;
        info.record_size = 3 * decoys_;
    }

    /// The record: the velocity that each decoy leaves with, relative to the object (m/s).
    void realise(const plr_call& call, const plr_view& record) const {
        pelorus::expect(record, info.record_size, 1, 1, "record");
        if (call.keys == nullptr && (info.flags & PLR_FLAG_USES_KEYS) != 0)
            throw pelorus::ArgumentError("keys: this trajectory draws random numbers, got none");
        const plr_key key = call.keys == nullptr ? plr_key{} : call.keys[0];
        for (std::int64_t i = 0; i < decoys_; ++i) {
            const Vector<3> added = drawn(key, static_cast<std::uint64_t>(i));
            for (int axis = 0; axis < 3; ++axis) record.data[(3 * i + axis) * record.row_stride] = added(axis);
        }
    }

    void states(const plr_call&, const plr_trajectory_states& args) const {
        pelorus::expect(args.record, info.record_size, 1, 1, "record");
        pelorus::expect(args.states, 6, args.time_count, info.objects, "states");
        const Vector<6> at_release = Path(flight_, first_, 0).at(released_);
        for (std::int64_t k = 0; k < info.objects; ++k) {
            const bool decoy = k > 0;
            args.ids[k] = static_cast<std::uint64_t>(k);
            args.parents[k] = decoy ? 0 : -1;
            args.births[k] = decoy ? released_ : 0;
            args.deaths[k] = std::numeric_limits<std::int64_t>::max();
            Vector<6> begin = decoy ? at_release : first_;
            for (int axis = 0; axis < 3 && decoy; ++axis)
                begin(3 + axis) += args.record.data[(3 * (k - 1) + axis) * args.record.row_stride];
            Path path(flight_, begin, args.births[k]);
            for (std::int64_t t = 0; t < args.time_count; ++t) {
                const bool born = args.times[t] >= args.births[k];
                const Vector<6> state =
                    born ? path.at(args.times[t]) : Vector<6>(Vector<6>::Constant(pelorus::not_a_number));
                double* const out = args.states.data + k * args.states.item_stride + t * args.states.col_stride;
                for (int row = 0; row < 6; ++row) out[row * args.states.row_stride] = state(row);
            }
        }
    }

private:
    bool is_random() const noexcept { return speed_[0] < speed_[1] || (spread_ == Spread::isotropic && speed_[1] > 0); }

    /// A decoy more leaves those before it as they are: each has a key of its own.
    Vector<3> drawn(plr_key key, std::uint64_t decoy) const {
        const plr_key own = random_->derive(key, PLR_STREAM_START, 0, decoy);
        Vector<3> uniform;
        random_->uniform(random_->derive(own, PLR_STREAM_START, 0, 0), 0, 3, uniform.data());
        const double least = speed_[0], width = speed_[1] - speed_[0];
        if (spread_ == Spread::axes) return Vector<3>::Constant(least) + width * uniform;
        // The direction of three normals is uniform on the sphere.
        Vector<3> direction;
        random_->normal(random_->derive(own, PLR_STREAM_START, 0, 1), 0, 3, direction.data());
        return (least + width * uniform(0)) * direction.normalized();
    }

    std::vector<double> start_, velocity_, speed_;
    std::int64_t decoys_ = 15;
    Spread spread_ = Spread::isotropic;
    double time_ = 0.0;

    const plr_random* random_ = nullptr;
    ballistic::Flight flight_;
    Vector<6> first_ = Vector<6>::Zero();
    std::int64_t released_ = 0;  // ns
    pelorus::Space space_;
};

}  // namespace release
