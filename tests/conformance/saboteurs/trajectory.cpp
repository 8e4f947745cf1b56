// An ellipsoid that flies a circle and drops another one, with what a trajectory may do wrong.
#include <algorithm>
#include <cmath>
#include <limits>

#include <pelorus/pelorus.hpp>

#include "defect.h"

namespace {

constexpr double two_pi = 2 * 3.14159265358979323846;
constexpr std::int64_t second = 1'000'000'000, drop = 20 * second, end = 100 * second;

struct Saboteur : pelorus::Trajectory<Saboteur> {
    using State = pelorus::Vector<9>;
    double radius = 0, speed = 0;
    const plr_random* random = nullptr;
    pelorus::Space space;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A trajectory with a defect")
            .purpose("A circle from a random point of it, for the proof that the conformance suites can fail.")
            .equation("p = R (cos b, sin b, 0), b = b0 + V t / R; the second object leaves along the tangent")
            .source("");
        plugin.parameter("radius", &Saboteur::radius).unit("m").initially("2 km").above(0).doc("of the circle");
        plugin.parameter("speed", &Saboteur::speed).unit("m/s").initially("100 m/s").above(0).doc("along it");
    }
    void setup(const pelorus::Setup& setup) {
        random = &setup.service<plr_random>();
        space = pelorus::kinematic_space(3, {1e6, 100.0, 10.0});
        if (DEFECT("trajectory-space-well-formed")) {
            std::vector<pelorus::Component> components = space.components();
            for (std::size_t i = 6; i < 9; ++i) components[i].unit = "m/s";
            space = pelorus::Space(components);
        }
        if (NEAR_MISS("trajectory-space-well-formed")) space = pelorus::kinematic_space(3, {0.0, 0.0, 0.0});
        info.flags = PLR_FLAG_USES_KEYS;
        info.state = space.c();
        info.objects = 2;
        info.extent_dimension = 3;
        info.record_version = 1;
        info.record_size = 1;
    }

    void realise(const plr_call& call, const plr_view& record) const {
        pelorus::expect(record, 1, 1, 1, "record");
        double uniform = 0;
        random->uniform(call.keys[0], 0, 1, &uniform);
        if (DEFECT("trajectory-is-drawn-by-its-key")) uniform = 0.25;
        if (NEAR_MISS("trajectory-is-drawn-by-its-key")) uniform = std::floor(uniform * 64) / 64;
        record.data[0] = two_pi * uniform;
    }

    void states(const plr_call&, const plr_trajectory_states& args) const {
        pelorus::expect(args.record, 1, 1, 1, "record");
        pelorus::expect(args.states, 9, args.time_count, 2, "states");
        if (args.extents.data != nullptr) pelorus::expect(args.extents, 9, args.time_count, 2, "extents");
        const double start = args.record.data[0];
        if (!std::isfinite(start)) throw pelorus::NumericError("the record is not finite");
        tell(args);
        double walked = start;
        std::int64_t last = 0;
        for (std::int64_t k = 0; k < args.time_count; ++k) {
            const std::int64_t time = args.times[k];
            if (DEFECT("cost-linear-in-times")) walk_again(args, k);
            if (NEAR_MISS("cost-linear-in-times")) walk_again(args, std::min<std::int64_t>(k, 8));
            walked += speed / radius * seconds(time - last);
            last += time - last;
            // Walking from time to time rounds otherwise than one stride does.
            const double angle = DEFECT("trajectory-times-are-independent") ? walked
                                 : NEAR_MISS("trajectory-times-are-independent")
                                     ? start + speed / radius * seconds(last)
                                     : start + speed / radius * seconds(time);
            store(args, 0, k, circle(angle), time >= 0);
            const double leave = start + speed / radius * seconds(birth());
            const bool is_late = NEAR_MISS("trajectory-lives-from-birth-to-death") && time == end;
            const bool is_early = DEFECT("trajectory-lives-from-birth-to-death") && time < birth();
            store(args, 1, k, tangent(circle(leave), seconds(time - birth())),
                  (time >= birth() && time < end) || is_late || is_early);
        }
    }

private:
    /// All the way from the first time, once more.
    static void walk_again(const plr_trajectory_states& args, std::int64_t steps) {
        volatile double way = 0;
        for (std::int64_t k = 0; k < steps; ++k) way = way + seconds(args.times[k]);
    }
    static double seconds(std::int64_t nanoseconds) noexcept { return static_cast<double>(nanoseconds) * 1e-9; }

    /// Of the second object; both may begin together.
    static std::int64_t birth() noexcept {
        return NEAR_MISS("trajectory-family-is-sound") || DEFECT("trajectory-family-is-sound.circle") ? 0 : drop;
    }

    void tell(const plr_trajectory_states& args) const {
        const std::uint64_t first = DEFECT("trajectory-family-is-sound") ? 1 : 0;
        const bool is_turned = NEAR_MISS("trajectory-family-is-sound");
        args.ids[0] = first + (is_turned ? 1 : 0);
        args.ids[1] = first + (is_turned ? 0 : 1);
        args.parents[0] = DEFECT("trajectory-family-is-sound.circle") ? 1 : -1;
        args.parents[1] = 0;
        args.births[0] = 0;
        args.births[1] = birth();
        args.deaths[0] = std::numeric_limits<std::int64_t>::max();
        args.deaths[1] = end;
    }
    State circle(double angle) const {
        const double c = std::cos(angle), s = std::sin(angle), pull = speed * speed / radius;
        State x;
        x << radius * c, radius * s, 0, -speed * s, speed * c, 0, -pull * c, -pull * s, 0;
        double faster = 1, harder = 1;
        if (DEFECT("trajectory-velocity-is-derivative")) faster = harder = 1.01;
        if (NEAR_MISS("trajectory-velocity-is-derivative")) faster = harder = 1 + 1e-5;
        if (DEFECT("trajectory-acceleration-is-derivative")) harder = -1;
        if (NEAR_MISS("trajectory-acceleration-is-derivative")) harder = 1 + 1e-5;
        x.segment<3>(3) *= faster;
        x.tail<3>() *= harder;
        return x;
    }
    static State tangent(const State& from, double time) {
        State x = from;
        x.head<3>() += time * from.segment<3>(3);
        x.tail<3>().setZero();
        return x;
    }
    static void store(const plr_trajectory_states& args, std::int64_t object, std::int64_t k, const State& x,
                      bool is_there) {
        double* const out = args.states.data + object * args.states.item_stride + k * args.states.col_stride;
        constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
        for (int r = 0; r < 9; ++r) out[r * args.states.row_stride] = is_there ? x(r) : nothing;
        if (args.extents.data == nullptr) return;
        double third = 9;
        if (DEFECT("trajectory-extents-are-ellipsoids")) third = 0;  // flat
        if (NEAR_MISS("trajectory-extents-are-ellipsoids")) third = 1e-6;
        const pelorus::Vector<3> along = x.segment<3>(3).normalized();
        pelorus::Matrix<3> shape = 100 * along * along.transpose();
        shape +=
            25 * pelorus::Vector<3>(-along(1), along(0), 0) * pelorus::Vector<3>(-along(1), along(0), 0).transpose();
        shape(2, 2) += third;
        double* const extent = args.extents.data + object * args.extents.item_stride + k * args.extents.col_stride;
        for (int e = 0; e < 9; ++e) extent[e * args.extents.row_stride] = is_there ? shape.data()[e] : nothing;
    }
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.trajectory.saboteur");
