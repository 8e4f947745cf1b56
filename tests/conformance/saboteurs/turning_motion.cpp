// A turn at a rate that is part of the state, which is polar in velocity, with what a nonlinear motion may do wrong. It keeps
// the last two variances of its turn rate.
#include <cmath>
#include <cstring>
#include <limits>

#include <pelorus/pelorus.hpp>

#include "defect.h"

namespace {

constexpr const char* axis_names[] = {"position.x", "position.y"};

struct Saboteur : pelorus::Motion<Saboteur, 5> {
    using Base = pelorus::Motion<Saboteur, 5>;
    /// What the author layer takes for granted. The plugin itself refuses to go backward, and does not tell otherwise.
    static constexpr std::uint32_t flags = PLR_MOTION_TIME_INVARIANT | PLR_MOTION_BACKWARD;
    static constexpr bool cartesian = false;
    static constexpr int record_size = 2;
    static constexpr std::uint32_t record_version = 2;
    using Record = pelorus::Vector<2>;
    double acceleration = 1;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A nonlinear motion with a defect")
            .purpose("A coordinated turn, for the proof that the conformance suites can fail.")
            .equation("x' = x + v T sinc(w T / 2) cos(h + w T / 2), y' likewise with sin; h' = h + w T")
            .source(
                "X. R. Li, V. P. Jilkov, Survey of Maneuvering Target Tracking, Part I, IEEE Transactions on "
                "Aerospace and Electronic Systems 39(4), 1333-1364, 2003");
        plugin.parameter("acceleration", &Saboteur::acceleration)
            .unit("m/s2")
            .initially("1 m/s2")
            .min(0)
            .doc("deviation of the acceleration along the track");
    }
    pelorus::Space space() const {
        return pelorus::Space({{axis_names[0], "m", 0, 1e5, false},
                               {axis_names[1], "m", 0, 1e5, false},
                               {"speed", "m/s", 0, 100, false},
                               {"heading", "rad", 0, 2, true},
                               {"turn_rate", "rad/s", 0, 0.1, false}});
    }
    pelorus::Space cartesian_space() const {
        return pelorus::Space({{axis_names[0], "m", 0, 1e5, false},
                               {axis_names[1], "m", 0, 1e5, false},
                               {"velocity.x", "m/s", 0, 100, false},
                               {"velocity.y", "m/s", 0, 100, false},
                               {"turn_rate", "rad/s", 0, 0.1, false}});
    }
    void complete(const plr_config& config, const plr_description& description) {
        Base::complete(config, description);
        told_ = *Base::table().info(this);
        told_.flags = PLR_MOTION_TIME_INVARIANT;
        if (DEFECT("motion-linear-means-linear")) told_.flags |= PLR_MOTION_LINEAR;
    }

    State propagate(const State& x, const pelorus::Step& step) const {
        refuse_backward(step.dt);
        return moved(x, turn_of(x, step), step.dt);
    }
    State moved(const State& x, double turn, double dt) const {
        const double half = turn * dt / 2, reach = x(2) * dt * sinc(half);
        State y = x;
        y(0) += reach * std::cos(x(3) + half);
        y(1) += reach * std::sin(x(3) + half);
        y(3) = pelorus::wrap_angle(x(3) + turn * dt);
        if (DEFECT("motion-answers-at-rest")) {
            y(0) = x(0) + x(2) * (std::sin(x(3) + turn * dt) - std::sin(x(3))) / turn;
            y(1) = x(1) + x(2) * (std::cos(x(3)) - std::cos(x(3) + turn * dt)) / turn;
        }
        return y;
    }
    Transition jacobian(const State& x, const pelorus::Step& step) const {
        refuse_backward(step.dt);
        const double dt = step.dt, half = turn_of(x, step) * dt / 2, s = sinc(half), slope = sinc_slope(half);
        const double c = std::cos(x(3) + half), d = std::sin(x(3) + half), v = x(2);
        Transition f = Transition::Identity();
        f(0, 2) = dt * s * c;
        f(1, 2) = dt * s * d;
        f(0, 3) = -v * dt * s * d;
        f(1, 3) = v * dt * s * c;
        if (!is_driven_by_mean()) {
            f(0, 4) = v * dt * dt / 2 * (slope * c - s * d);
            f(1, 4) = v * dt * dt / 2 * (slope * d + s * c);
            f(3, 4) = dt;
        }
        if (DEFECT("motion-jacobian-is-derivative")) f(0, 3) = -f(0, 3);
        if (NEAR_MISS("motion-jacobian-is-derivative")) f(0, 3) *= 1 + 1e-7;
        return f;
    }
    Transition noise(const Posterior& posterior, const pelorus::Step& step) const {
        if (!DEFECT("motion-refuses-backward-steps")) refuse_backward(step.dt);
        const double dt = step.dt, rate_variance = posterior.covariance(4, 4) + step.record[0] + step.record[1];
        State along, around;
        along << dt * dt / 2 * std::cos(posterior.mean(3)), dt * dt / 2 * std::sin(posterior.mean(3)), dt, 0, 0;
        around << 0, 0, 0, dt * dt / 2, dt;
        const Transition q = acceleration * acceleration * (along * along.transpose()) +
                             (1e-6 + 0.01 * rate_variance) * (around * around.transpose());
        return (q + q.transpose()) / 2;
    }

    Record init_record(const State&, const Transition& covariance) const {
        return {covariance(4, 4), covariance(4, 4)};
    }
    Record advance_record(const State&, const Transition& covariance, const pelorus::Step& step) const {
        refuse_backward(step.dt);
        return {covariance(4, 4), step.record[0]};
    }

    Cartesian to_cartesian(const State& x) const {
        return (Cartesian() << x(0), x(1), x(2) * std::cos(x(3)), x(2) * std::sin(x(3)), x(4)).finished();
    }
    Transition to_cartesian_jacobian(const State& x) const {
        Transition j = Transition::Identity();
        const double c = std::cos(x(3)), s = std::sin(x(3));
        double speed = x(2);
        if (DEFECT("motion-conversion-jacobians-are-derivatives")) speed = 1;
        if (NEAR_MISS("motion-conversion-jacobians-are-derivatives")) speed *= 1 + 1e-7;
        j(2, 2) = c;
        j(2, 3) = -speed * s;
        j(3, 2) = s;
        j(3, 3) = speed * c;
        return j;
    }
    State from_cartesian(const Cartesian& c) const {
        double speed = std::hypot(c(2), c(3)), turn = c(4);
        if (DEFECT("motion-conversions-are-inverse")) turn = 0;
        if (NEAR_MISS("motion-conversions-are-inverse")) speed *= 1 + 1e-11;
        return (State() << c(0), c(1), speed, std::atan2(c(3), c(2)), turn).finished();
    }
    Transition from_cartesian_jacobian(const Cartesian& c) const {
        const double square = c(2) * c(2) + c(3) * c(3), speed = std::sqrt(square);
        if (speed == 0) throw pelorus::NumericError("at rest there is no heading");
        Transition j = Transition::Identity();
        j(2, 2) = c(2) / speed;
        j(2, 3) = c(3) / speed;
        j(3, 2) = -c(3) / square;
        j(3, 3) = c(2) / square;
        if (DEFECT("motion-conversions-are-inverse")) j(4, 4) = 0;
        return j;
    }

    const void* extension(const char* id) const noexcept {
        static constexpr plr_record_convert convert{sizeof(plr_record_convert), 0, &convert_entry};
        return std::strcmp(id, PLR_RECORD_CONVERT) == 0 ? &convert : nullptr;
    }
    static const plr_motion& table() noexcept {
        static const plr_motion made = [] {
            plr_motion table = Base::table();
            table.info = [](const void* self) noexcept -> const plr_motion_info* { return &of(self).told_; };
            table.propagate = &propagate_entry;
            table.advance_record = &advance_entry;
            return table;
        }();
        return made;
    }

private:
    static const Saboteur& of(const void* self) noexcept { return *static_cast<const Saboteur*>(self); }
    static void refuse_backward(double dt) {
        if (dt < 0) throw pelorus::UnsupportedError("cannot move backward in time (dt < 0)");
    }
    /// Lawful as well: the turn is that of the mean, which is held fixed.
    static bool is_driven_by_mean() noexcept { return NEAR_MISS("motion-points-equal-singles"); }
    static double turn_of(const State& x, const pelorus::Step& step) noexcept {
        return is_driven_by_mean() && step.mean != nullptr ? step.mean[4] : x(4);
    }
    static double sinc(double u) noexcept {
        const double limit = NEAR_MISS("motion-answers-at-rest") ? 1e-3 : 1e-4;
        return std::abs(u) < limit ? 1 - u * u / 6 : std::sin(u) / u;
    }
    static double sinc_slope(double u) noexcept {
        return std::abs(u) < 1e-2 ? -u / 3 + u * u * u / 30 : (u * std::cos(u) - std::sin(u)) / (u * u);
    }

    static bool has_failed(const plr_call& call, std::int64_t i) noexcept {
        return call.item_status != nullptr && call.item_status[i] != PLR_OK;
    }
    static plr_status propagate_entry(const void* self, const plr_call* call,
                                      const plr_motion_propagate* args) noexcept {
        const plr_status status = Base::table().propagate(self, call, args);
        // What is refused is undefined: anything may stand there.
        if (NEAR_MISS("motion-refuses-backward-steps") && status == PLR_ITEMS_FAILED && call->item_status != nullptr)
            for (std::int64_t i = 0; i < args->out.count; ++i)
                if (call->item_status[i] != PLR_OK)
                    args->out.data[i * args->out.item_stride] = std::numeric_limits<double>::quiet_NaN();
        // The turn of the first point, taken for all.
        if (DEFECT("motion-points-equal-singles") && args->out.cols > 1 && status >= 0)
            for (std::int64_t i = 0; i < args->out.count; ++i)
                for (std::int64_t p = 1; p < args->out.cols && !has_failed(*call, i); ++p)
                    pelorus::store<5, 1>(args->out, i,
                                         of(self).moved(pelorus::load_column<5>(args->state, i, p),
                                                        pelorus::load_column<5>(args->state, i, 0)(4),
                                                        args->dt.data[i * args->dt.item_stride]),
                                         p);
        return status;
    }
    static plr_status advance_entry(const void* self, const plr_call* call, const plr_motion_record* args) noexcept {
        if (!DEFECT("motion-record-advances-in-place") && !NEAR_MISS("motion-record-advances-in-place"))
            return Base::table().advance_record(self, call, args);
        const std::int64_t count = args->out.count;
        const plr_status checked = pelorus::guarded(call->error, [&] {
            pelorus::expect(args->dt, 1, 1, count, "dt");
            pelorus::expect(args->state, 5, 1, count, "state");
            pelorus::expect(args->covariance, 5, 5, count, "covariance");
            pelorus::expect(args->record, 2, 1, count, "record");
            pelorus::expect(args->out, 2, 1, count, "out");
        });
        if (checked != PLR_OK) return checked;
        return pelorus::for_items(*call, args->out.count, [&](std::int64_t i) {
            refuse_backward(args->dt.data[i * args->dt.item_stride]);
            const double* covariance = args->covariance.data + i * args->covariance.item_stride;
            const double variance = covariance[4 * args->covariance.col_stride + 4 * args->covariance.row_stride];
            const double* record = args->record.data + i * args->record.item_stride;
            double* out = args->out.data + i * args->out.item_stride;
            if (!std::isfinite(variance + record[0])) throw pelorus::NumericError("a result is not finite");
            if (NEAR_MISS("motion-record-advances-in-place")) out[1] = record[0];  // just in time
            out[0] = variance;
            if (DEFECT("motion-record-advances-in-place")) out[1] = record[0];
        });
    }
    static plr_status convert_entry(const void*, const plr_call* call, std::uint32_t from, const plr_const_view* in,
                                    const plr_view* out) noexcept {
        return pelorus::guarded(call->error, [&] {
            // Version 1 had no word of the variance before.
            const bool is_known = from == 1 && NEAR_MISS("motion-record-refuses-unknown-versions");
            if (!is_known && !DEFECT("motion-record-refuses-unknown-versions"))
                throw pelorus::Failure(PLR_E_STATE_VERSION,
                                       "records of version " + std::to_string(from) + " are not known");
            for (std::int64_t i = 0; i < out->count; ++i)
                for (int r = 0; r < 2; ++r)
                    out->data[i * out->item_stride + r] =
                        in->data[i * in->item_stride + std::min<std::int64_t>(r, in->rows - 1)];
        });
    }

    plr_motion_info told_{};
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.motion.turning_saboteur");
