// Nearly constant velocity in three dimensions, with what a linear motion may do wrong.
#include <cmath>
#include <cstring>

#include <pelorus/pelorus.hpp>

#include "defect.h"

namespace {

struct Saboteur : pelorus::KroneckerMotion<Saboteur, 2, 3> {
    static constexpr std::uint32_t flags = PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE | PLR_MOTION_TIME_INVARIANT |
                                           PLR_MOTION_EXACT_NOISE | PLR_MOTION_BACKWARD;
    using Base = pelorus::KroneckerMotion<Saboteur, 2, 3>;
    double intensity = 1;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A motion with a defect")
            .purpose("Nearly constant velocity, for the proof that the conformance suites can fail.")
            .equation("F = [1 T; 0 1], Q = q [T^3/3 T^2/2; T^2/2 T]")
            .source(
                "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, "
                "2001, equation 6.2.2-12");
        plugin.parameter("intensity", &Saboteur::intensity)
            .unit("m2/s3")
            .initially("1 m2/s3")
            .min(0)
            .doc("spectral density of the acceleration");
    }
    pelorus::Space space() const {
        const pelorus::Space good = Base::space();
        if (!DEFECT("motion-spaces-well-formed")) return good;
        std::vector<pelorus::Component> components = good.components();
        components[5].unit = "m";
        return pelorus::Space(components);
    }
    std::vector<double> priors() const {
        if (NEAR_MISS("motion-spaces-well-formed")) return {1e5, 1e-9};
        return {1e5, 100.0};
    }
    Block transition(double dt) const {
        if (DEFECT("motion-zero-step-is-identity") && dt == 0) dt = 1e-3;
        if (NEAR_MISS("motion-zero-step-is-identity") && dt == 0) dt = 1e-12;
        if (DEFECT("motion-backward-undoes-forward")) dt = std::abs(dt);
        if (NEAR_MISS("motion-backward-undoes-forward") && dt < 0) dt *= 1 + 1e-9;
        double reach = dt;
        if (DEFECT("motion-steps-compose")) reach += 0.01 * dt * dt;
        if (NEAR_MISS("motion-steps-compose")) reach += 1e-9 * dt * dt;
        return (Block() << 1, share() * reach, 0, 1).finished();
    }
    Block noise_block(double dt) const {
        const double t = std::abs(dt);
        double position = t * t * t / 3;
        if (DEFECT("motion-noise-composes")) position = t * t * t / 2;
        if (NEAR_MISS("motion-noise-composes")) position *= 1 + 1e-10;
        if (DEFECT("motion-steps-long-and-short")) position = (std::pow(1 + t, 3) - 1 - 3 * t - 3 * t * t) / 3;
        if (NEAR_MISS("motion-steps-long-and-short") && t < 1e-6) position *= 1 - 1e-10;
        position *= share() * share();
        const double both = share() * dt * t / 2;
        return intensity * (Block() << position, both, both, t).finished();
    }
    State propagate(const State& x, const pelorus::Step& step) const {
        State y = Base::propagate(x, step);
        if (NEAR_MISS("motion-linear-means-linear")) y(0) *= 1 + 1e-13;
        return y;
    }
    Transition jacobian(const State& x, const pelorus::Step& step) const { return Base::jacobian(x, step); }

    const void* extension(const char* id) const noexcept {
        static constexpr plr_motion_noise_factor half{sizeof(plr_motion_noise_factor), 6, &factor_entry};
        static constexpr plr_motion_structure structure{sizeof(plr_motion_structure), 2, 3, 0, &blocks_entry};
        if (std::strcmp(id, PLR_MOTION_STRUCTURE) == 0) return &structure;
        if (std::strcmp(id, PLR_MOTION_NOISE_FACTOR) == 0 && offers_factor()) return &half;
        return nullptr;
    }

    static const plr_motion& table() noexcept {
        static const plr_motion made = [] {
            plr_motion table = Base::table();
            if (DEFECT("motion-table-agrees-with-info")) table.init_record = &init_record_entry;
            table.noise = &noise_entry;
            return table;
        }();
        return made;
    }

private:
    /// How much of the velocity moves the position.
    static double share() noexcept {
        if (DEFECT("motion-velocity-is-derivative")) return 0.9;
        return NEAR_MISS("motion-velocity-is-derivative") ? 1 - 3e-7 : 1.0;
    }
    static bool offers_factor() noexcept {
        return DEFECT("motion-noise-factor-agrees") || NEAR_MISS("motion-noise-factor-agrees") ||
               NEAR_MISS("motion-table-agrees-with-info");  // as many columns as states
    }
    static const Saboteur& of(const void* self) noexcept { return *static_cast<const Saboteur*>(self); }
    static plr_status init_record_entry(const void*, const plr_call*, const plr_motion_record*) noexcept {
        return PLR_OK;
    }
    static plr_status noise_entry(const void* self, const plr_call* call, const plr_motion_noise* args) noexcept {
        const plr_status status = Base::table().noise(self, call, args);
        const bool is_bad = DEFECT("motion-constant-noise-is-constant");
        if (!(is_bad || NEAR_MISS("motion-constant-noise-is-constant")) || args->state.data == nullptr) return status;
        if (status < 0) return status;
        const plr_status checked =
            pelorus::guarded(call->error, [&] { pelorus::expect(args->state, 6, 1, args->out.count, "state"); });
        if (checked != PLR_OK) return checked;
        const plr_status grown = pelorus::for_items(*call, args->out.count, [&](std::int64_t i) {
            if (call->item_status != nullptr && call->item_status[i] != PLR_OK) return;
            const State x = pelorus::load<6, 1>(args->state, i);
            const double growth = 1 + (is_bad ? 1e-4 : 1e-16) * std::abs(x(3));
            Transition q = pelorus::load<6, 6>(pelorus::as_const(args->out), i);
            q *= growth;
            pelorus::store<6, 6>(args->out, i, q);
        });
        return grown == PLR_OK ? status : grown;
    }
    static plr_status blocks_entry(const void* self, const plr_call* call, double dt, double* f1, double* q1) noexcept {
        return pelorus::guarded(call->error, [&] {
            Block f = of(self).transition(dt);
            if (DEFECT("motion-structure-agrees")) f.transposeInPlace();  // row by row
            if (NEAR_MISS("motion-structure-agrees")) f(0, 1) *= 1 + 1e-14;
            const Block q = of(self).noise_block(dt);
            pelorus::store<2, 2>(pelorus::view(f1, 2, 2, 1), 0, f);
            pelorus::store<2, 2>(pelorus::view(q1, 2, 2, 1), 0, q);
        });
    }
    static plr_status factor_entry(const void* self, const plr_call* call, const plr_motion_noise* args) noexcept {
        return pelorus::guarded(call->error, [&] {
            pelorus::expect(args->dt, 1, 1, args->out.count, "dt");
            pelorus::expect(args->out, 6, 6, args->out.count, "out");
            return factor_items(self, call, args);
        });
    }
    static plr_status factor_items(const void* self, const plr_call* call, const plr_motion_noise* args) {
        return pelorus::for_items(*call, args->out.count, [&](std::int64_t i) {
            const Block q = of(self).noise_block(args->dt.data[i * args->dt.item_stride]);
            Block g = Block::Zero();
            g(0, 0) = std::sqrt(q(0, 0));
            g(1, 0) = q(0, 0) > 0 ? q(1, 0) / g(0, 0) : 0.0;
            g(1, 1) = std::sqrt(std::max(0.0, q(1, 1) - g(1, 0) * g(1, 0)));
            if (DEFECT("motion-noise-factor-agrees")) g.transposeInPlace();
            if (NEAR_MISS("motion-noise-factor-agrees")) g.col(0) = -g.col(0);  // any factor will do
            Transition full = Transition::Zero();
            for (int r = 0; r < 2; ++r)
                for (int c = 0; c < 2; ++c)
                    for (int axis = 0; axis < 3; ++axis) full(r * 3 + axis, c * 3 + axis) = g(r, c);
            pelorus::store<6, 6>(args->out, i, full);
        });
    }
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.motion.saboteur");
