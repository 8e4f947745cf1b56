// motion.modified_current_statistical: a current statistical model that learns its rate of manoeuvres. See README.md.
#include <algorithm>
#include <cmath>

#include "../../common/axis_models/current_statistical.hpp"

namespace {

using namespace axis_models;

struct Parameters : AccelerationParameters {
    double maneuver_rate = 0.0;  // 1/s
    double forgetting = 0.0;
    double start_deviation = 0.0;  // m/s2
};

/// What is remembered of one axis, all of posteriors before the present one.
struct Memory {
    double acceleration;     ///< a_k-1, m/s2
    double square, product;  ///< r0, r1: running means of a_k^2 and a_k a_k-1, m2/s4
    double maneuver_rate;    ///< alpha as it was then, 1/s
    double steps;            ///< made so far
    double span;             ///< s, from the posterior of a_k-1 to the present one
};
constexpr int memory_size = 6;
constexpr double first_adapted_step = 5.0;
constexpr double least_rate = 0.01, greatest_rate = 3.0;  // 1/s
constexpr double least_variance = 0.01;                   // m2/s4

template <int D> struct Model : CurrentStatisticalMotion<Model<D>, D>, Parameters {
    using Base = CurrentStatisticalMotion<Model<D>, D>;
    using typename Base::State;
    using typename Base::Transition;
    static constexpr int record_size = memory_size * D;
    using Record = Vector<memory_size * D>;

    static void describe(pelorus::Describe<Model>& plugin);

    CurrentStatistics statistics(double acceleration, int axis, const pelorus::Step& step) const {
        const Memory before = read(step.record, axis);
        const double mean = acceleration + (acceleration - before.acceleration);
        return {mean, learned(before, acceleration).maneuver_rate,
                std::max(rayleigh_ratio * mean * mean, least_variance)};
    }
    Record init_record(const State& mean, const Transition&) const {
        Record record;
        for (int axis = 0; axis < D; ++axis)
            write({mean(2 * D + axis), 0.0, 0.0, maneuver_rate, 0.0, 0.0}, record, axis);
        return record;
    }
    Record advance_record(const State& mean, const Transition&, const pelorus::Step& step) const {
        Record record;
        for (int axis = 0; axis < D; ++axis) {
            Memory now = learned(read(step.record, axis), mean(2 * D + axis));
            if (!(now.steps > 0.0)) begin_means(now, step.dt);
            now.steps += 1.0;
            now.span = step.dt;
            write(now, record, axis);
        }
        return record;
    }

private:
    static Memory read(const double* record, int axis) {
        const double* const at = record + memory_size * axis;
        return {at[0], at[1], at[2], at[3], at[4], at[5]};
    }
    static void write(const Memory& memory, Record& record, int axis) {
        record.template segment<memory_size>(memory_size * axis) << memory.acceleration, memory.square, memory.product,
            memory.maneuver_rate, memory.steps, memory.span;
    }
    /// The running means begin as those of a Singer acceleration of `start_deviation` and the rate of the first steps, so that
    /// the first estimates, whose ratio is mostly noise, move a rate that is there instead of making one.
    void begin_means(Memory& memory, double dt) const {
        memory.square = start_deviation * start_deviation;
        memory.product = memory.square * std::exp(-maneuver_rate * dt);
    }
    /// The memory with the present acceleration in it. The start has no acceleration before it.
    Memory learned(const Memory& before, double acceleration) const {
        Memory now = before;
        now.acceleration = acceleration;
        if (!(before.steps > 0.0)) return now;
        now.square = forgetting * before.square + (1.0 - forgetting) * acceleration * acceleration;
        now.product = forgetting * before.product + (1.0 - forgetting) * acceleration * before.acceleration;
        if (before.steps + 1.0 < first_adapted_step || !(now.square > 0.0) || !(before.span > 0.0)) return now;
        const double correlation = now.product / now.square;
        // No Singer process has a correlation outside (0, 1): such a ratio tells of no rate, and the last one stands.
        if (!(correlation > 0.0) || !(correlation < 1.0)) return now;
        now.maneuver_rate = std::clamp(-std::log(correlation) / before.span, least_rate, greatest_rate);
        return now;
    }
};

template <int D> void Model<D>::describe(pelorus::Describe<Model>& plugin) {
    plugin.title("Modified current statistical model")
        .purpose(
            "Singer's manoeuvres about the acceleration extrapolated from the last two estimates, with a rate that is "
            "learned from how these estimates are correlated, on one to three axes. An interpretation of a model that "
            "is not published in detail.")
        .equation(
            "x = (p, v, a); b = 2 a_k - a_k-1; x- = F x + (g - f) b, F Singer's of rate r, f its last column, g = "
            "[T^2/2; T; 1]; Q = s^2 times Singer's exact noise for unit variance, s^2 = (4 - pi)/pi b^2, at least 0.01 "
            "m2/s4; r = -ln(r1/r0)/T within 0.01 .. 3 1/s from the fifth step on, kept where r1/r0 is outside (0, 1), "
            "r1 and "
            "r0 running means of a_k a_k-1 and a_k^2")
        .source(
            "an interpretation of the modified current statistical model that Zhang et al., Acta Electronica Sinica "
            "47(3), 560-567, 2019, compare with; after H. R. Zhou, K. S. P. Kumar, Journal of Guidance, Control and "
            "Dynamics 7(5), 596-602, 1984");
    describe_dimension(plugin);
    plugin.parameter("maneuver_rate", &Parameters::maneuver_rate)
        .unit("1/s")
        .initially("0.6 1/s")
        .min(least_rate)
        .max(greatest_rate)
        .doc("rate of the manoeuvres in the first four steps");
    plugin.parameter("forgetting", &Parameters::forgetting)
        .initially("0.9")
        .above(0.0)
        .below(1.0)
        .doc("share of the running means that a step keeps");
    plugin.parameter("start_deviation", &Parameters::start_deviation)
        .unit("m/s2")
        .initially("1.5 m/s2")
        .min(0.0)
        .doc("acceleration that the running means begin with: r0 is its square, r1 that of maneuver_rate");
    describe_priors(plugin);
}

}  // namespace

PELORUS_PLUGIN(pelorus::ByDimension<Model>, "motion.modified_current_statistical");
