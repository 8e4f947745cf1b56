// The calls of a sensor, with plausible arguments.
#include "sensor_calls.hpp"

#include <cmath>

#include <catch2/catch.hpp>
#include <pelorus/space.hpp>

namespace pelorus::conformance {

namespace sensor_calls {

namespace {

std::int64_t count_of(const Argument& argument) {
    const std::int64_t size = argument.rows * argument.cols;
    return size == 0 ? 0 : static_cast<std::int64_t>(argument.values.size()) / size;
}
Argument weightless(Argument argument, bool is_weightless = true) {
    argument.is_weightless = is_weightless;
    return argument;
}
std::int64_t components(const Instance& instance) { return info(instance).measurement->size; }

}  // namespace

HotCall measure(const Instance& instance, const Argument& cartesian) {
    HotCall call = make_call(cartesian.cols == 1 ? "measure" : "measure (points)", count_of(cartesian));
    call.may_refuse = true;
    call.in = {renamed(cartesian, "cartesian")};
    call.out = {output("out", components(instance), cartesian.cols)};
    call.invoke = [sensor = &table(instance), self = instance.self()](const plr_call& context, const Views& v) {
        const plr_sensor_measure args{sizeof args, 0, v.in[0], v.out[0]};
        return sensor->measure(self, &context, &args);
    };
    return call;
}

HotCall jacobian(const Instance& instance, const Argument& cartesian) {
    HotCall call = make_call("jacobian", count_of(cartesian));
    call.may_refuse = true;
    call.in = {weightless(renamed(cartesian, "cartesian"), (info(instance).flags & PLR_SENSOR_LINEAR) != 0)};
    call.out = {output("out", components(instance), cartesian.rows)};
    call.invoke = [sensor = &table(instance), self = instance.self()](const plr_call& context, const Views& v) {
        const plr_sensor_jacobian args{sizeof args, 0, v.in[0], v.out[0]};
        return sensor->jacobian(self, &context, &args);
    };
    return call;
}

HotCall noise(const Instance& instance, std::int64_t count, const Argument& cartesian, const Argument& snr,
              const Argument& waveform) {
    HotCall call = make_call(snr.is_absent && waveform.is_absent ? "noise (nominal)" : "noise", count);
    call.may_refuse = true;
    // Which of them it reads is its own affair.
    call.in = {weightless(renamed(cartesian, "cartesian")), weightless(renamed(snr, "snr")),
               weightless(renamed(waveform, "waveform"))};
    call.out = {output("out", components(instance), components(instance), Content::covariance)};
    call.invoke = [sensor = &table(instance), self = instance.self()](const plr_call& context, const Views& v) {
        const plr_sensor_noise args{sizeof args, 0, v.in[0], v.in[1], v.in[2], v.out[0]};
        return sensor->noise(self, &context, &args);
    };
    return call;
}

HotCall residual(const Instance& instance, const Argument& measurement, const Argument& reference) {
    HotCall call = make_call(measurement.cols == 1 ? "residual"
                             : reference.cols == 1 ? "residual (points, one reference)"
                                                   : "residual (points)",
                             count_of(measurement));
    call.in = {renamed(measurement, "measurement"), renamed(reference, "reference")};
    call.out = {output("out", measurement.rows, measurement.cols)};
    call.invoke = [sensor = &table(instance), self = instance.self()](const plr_call& context, const Views& v) {
        const plr_sensor_residual args{sizeof args, 0, v.in[0], v.in[1], v.out[0]};
        return sensor->residual(self, &context, &args);
    };
    return call;
}

HotCall invert(const Instance& instance, const Argument& measurement, const Argument& noise, bool with_covariance) {
    HotCall call = make_call(with_covariance ? "invert" : "invert (mean alone)", count_of(measurement));
    call.may_refuse = true;
    const std::int64_t size = info(instance).inverse->size;
    call.in = {renamed(measurement, "measurement"), weightless(renamed(noise, "noise"), !with_covariance)};
    call.out = {output("mean", size, 1),
                with_covariance ? output("covariance", size, size, Content::covariance) : absent("covariance")};
    call.invoke = [sensor = &table(instance), self = instance.self()](const plr_call& context, const Views& v) {
        const plr_sensor_invert args{sizeof args, 0, v.in[0], v.in[1], v.out[0], v.out[1]};
        return sensor->invert(self, &context, &args);
    };
    return call;
}

Argument places(const Instance& instance, Sample& sample, std::int64_t count) {
    const plr_space& space = *info(instance).cartesian;
    Argument found = states("cartesian", space, sample, count);
    if (count == 0) return found;
    constexpr int most_tries = 40;
    for (int attempt = 0; attempt < most_tries; ++attempt) {
        const Execution done = execute_leniently(instance, measure(instance, found));
        std::int64_t refused = 0;
        for (std::int64_t i = 0; i < count; ++i) {
            if (!done.failed(i)) continue;
            ++refused;
            const Eigen::VectorXd other = sample.state(space);
            std::copy_n(other.data(), space.size, found.values.begin() + i * space.size);
        }
        if (refused == 0) return found;
    }
    FAIL("measure refuses more than half of the places within " << 2 * scales_of(space)(0)
                                                                << " m that it is asked about; it should answer "
                                                                   "wherever a measurement is defined");
    return found;
}

Argument waveforms(const Instance& instance, Sample& sample, std::int64_t count) {
    const plr_space* const space = info(instance).waveform;
    if (space == nullptr) return absent("waveform");
    const Space waveform(*space);
    return input("waveform", space->size, 1, count, [&](double* out, std::int64_t) {
        for (int r = 0; r < waveform.size(); ++r) {
            const Component& component = waveform[r];
            const double spread = std::isfinite(component.prior_deviation) ? component.prior_deviation : 0.0;
            out[r] = component.prior_mean + 0.5 * spread * sample.uniform(-1.0, 1.0);
        }
    });
}

Argument as_input(const char* name, const HotCall& call, const Execution& done, std::size_t output) {
    Argument argument = renamed(call.out[output], name);
    argument.content = Content::finite;
    argument.values = done.out[output];
    return argument;
}

}  // namespace sensor_calls

namespace {

/// Several points about each place.
Argument points_about(const Argument& places, const plr_space& space, Sample& sample, std::int64_t points) {
    const std::int64_t size = space.size,
                       count = size == 0 ? 0 : static_cast<std::int64_t>(places.values.size()) / size;
    const Eigen::VectorXd spread = 1e-3 * scales_of(space);
    return input(places.name, size, points, count, [&](double* out, std::int64_t i) {
        for (std::int64_t p = 0; p < points; ++p)
            for (Eigen::Index r = 0; r < size; ++r)
                out[p * size + r] = item(places, i)(r, 0) + (p == 0 ? 0.0 : spread(r) * sample.normal());
    });
}

std::vector<HotCall> calls_of(const Instance& instance, Sample sample, std::int64_t count) {
    using namespace sensor_calls;
    constexpr std::int64_t points = 5;
    const plr_sensor_info& facts = info(instance);
    const Argument cartesian = places(instance, sample, count);
    const Argument snr =
        input("snr", 1, 1, count, [&](double* out, std::int64_t) { *out = std::pow(10.0, sample.uniform(0.5, 3.0)); });
    const Argument one = states("measurement", *facts.measurement, sample, count);
    const Argument reference = states("reference", *facts.measurement, sample, count);
    const HotCall nominal = noise(instance, count, cartesian, absent("snr"), absent("waveform"));
    std::vector<HotCall> calls{measure(instance, cartesian),
                               measure(instance, points_about(cartesian, *facts.cartesian, sample, points)),
                               jacobian(instance, cartesian),
                               noise(instance, count, cartesian, snr, waveforms(instance, sample, count)),
                               nominal,
                               residual(instance, one, reference),
                               residual(instance, points_about(one, *facts.measurement, sample, points), reference),
                               residual(instance, points_about(one, *facts.measurement, sample, points),
                                        points_about(reference, *facts.measurement, sample, points))};
    if (table(instance).invert == nullptr || facts.inverse == nullptr) return calls;
    const HotCall at_places = measure(instance, cartesian);
    const Argument measured = as_input("measurement", at_places, execute_leniently(instance, at_places), 0);
    const Argument errors = as_input("noise", nominal, execute_leniently(instance, nominal), 0);
    calls.push_back(invert(instance, measured, errors));
    calls.push_back(invert(instance, measured, errors, false));
    return calls;
}

const detail::KindRegistration registration(PLR_SENSOR, &calls_of, [](const Instance& instance) {
    return sensor_calls::info(instance).scratch_bytes;
});

}  // namespace

}  // namespace pelorus::conformance
