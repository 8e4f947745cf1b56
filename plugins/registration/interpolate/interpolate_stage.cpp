#include "interpolate_stage.hpp"

#include "interpolation.hpp"

namespace interpolate {

namespace {

/// An id for what is told of a sample at a time that is not its own: one sample may lie beside several times.
std::uint64_t id_at(std::uint64_t sample, streams::Clock time) {
    std::uint64_t mixed = sample + 0x9e3779b97f4a7c15u * (static_cast<std::uint64_t>(time) + 1);
    mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9u;
    mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111ebu;
    return mixed ^ (mixed >> 31);
}

}  // namespace

void Interpolate::describe(pelorus::Describe<Interpolate>& plugin) {
    plugin.title("A stream at the times of another, by interpolation")
        .purpose(
            "Puts the stream of one sensor onto the times of another: between the sample before and the sample after, "
            "on a "
            "line or, where rates are measured, on a cubic; for want of a sample after, beyond the last two, but not "
            "far.")
        .equation(
            "z = (1 - u) z0 + u z1, R = (1 - u)^2 R0 + u^2 R1; Hermite: z = h00 z0 + h10 T z0' + h01 z1 + h11 T z1', "
            "R = W0 R0 W0' + W1 R1 W1'")
        .source("C. de Boor, A Practical Guide to Splines, Springer 1978, chapter IV (cubic Hermite interpolation)");
    describe_streams(plugin);
    plugin.parameter("rule", &Interpolate::rule_)
        .initially("linear")
        .choices({{"linear", "a line through both samples"},
                  {"hermite",
                   "a cubic through values and rates, for components whose rates are measured (`velocity.x` of "
                   "`position.x`, `range_rate` of `range`); the others on the line"}})
        .doc("how to go from one sample to the next");
    plugin.parameter("max_gap", &Interpolate::max_gap_)
        .unit("s")
        .initially("1 s")
        .above(0)
        .doc(
            "samples that lie further apart are not interpolated, times further from the last sample not told; a time "
            "waits for so long for a sample after it");
}

void Interpolate::prepare() { max_gap_ns_ = streams::nanoseconds("max_gap", max_gap_); }

std::optional<streams::Estimate> Interpolate::tell(const streams::SampleBuffer::Samples& samples, streams::Clock time,
                                                   const pelorus::Space& space) const {
    std::size_t after = 0;
    while (after < samples.size() && samples[after].time < time) ++after;
    if (after < samples.size() && samples[after].time == time)
        return streams::Estimate{samples[after].value, samples[after].covariance, samples[after].id};
    if (after == samples.size() && after >= 1) --after;  // beyond the last two
    if (after == 0) return std::nullopt;
    const streams::Sample &first = samples[after - 1], &second = samples[after];
    if (is_far(first, second.time) || is_far(second, time)) return std::nullopt;
    const double dt = streams::seconds(second.time - first.time), u = streams::seconds(time - first.time) / dt;
    const Weights weights = rule_ == Rule::linear ? linear(space.size(), u) : hermite(space, u, dt);
    streams::Estimate estimate = combined(weights, first, second, space);
    estimate.id = id_at(u <= 0.5 ? first.id : second.id, time);
    return estimate;
}

}  // namespace interpolate
