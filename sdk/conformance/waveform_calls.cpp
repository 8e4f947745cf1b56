#include "waveform_calls.hpp"

#include <memory>

#include <catch2/catch.hpp>

#include "machine/creation.hpp"

namespace pelorus::conformance::waveform_calls {

namespace {

/// A sensor that nobody knows: each component of a measurement depends on all of the state, by about as much as its scale.
Eigen::MatrixXd sample_slope(const plr_space& measurement, const plr_space& cartesian, Sample& sample) {
    const Eigen::VectorXd rows = scales_of(measurement), cols = scales_of(cartesian);
    Eigen::MatrixXd h(rows.size(), cols.size());
    for (Eigen::Index r = 0; r < h.rows(); ++r)
        for (Eigen::Index c = 0; c < h.cols(); ++c) h(r, c) = sample.normal() * rows(r) / cols(c);
    return h;
}

Outlook outlook_in(const Instance& instance, const Space& cartesian, Sample sample, std::int64_t count) {
    const plr_waveform_info& model = info(instance);
    const std::int64_t c = cartesian.size(), m = model.measurement->size, h = model.horizon;
    Outlook out;
    out.cartesian = cartesian;
    const auto blank = [](double*, std::int64_t) {};
    out.mean = input("mean", c, h, count, blank);
    out.covariance = input("covariance", c, c * h, count, blank);
    out.projected = input("projected", m, m * h, count, blank);
    out.cross = input("cross", c, m * h, count, blank);
    out.mean.is_weightless = true;  // a rule may look at covariances alone
    for (std::int64_t i = 0; i < count; ++i)
        for (std::int64_t j = 0; j < h; ++j) {
            const Eigen::VectorXd mean = sample.state(*cartesian.c());
            const Eigen::MatrixXd covariance = sample.covariance(*cartesian.c());
            const Eigen::MatrixXd slope = sample_slope(*model.measurement, *cartesian.c(), sample);
            const Eigen::MatrixXd cross = covariance * slope.transpose();
            Eigen::MatrixXd projected = slope * cross;
            projected = 0.5 * (projected + projected.transpose().eval());
            const auto put = [&](Argument& to, const Eigen::MatrixXd& matrix) {
                std::copy_n(matrix.data(), matrix.size(), to.values.data() + (i * h + j) * matrix.size());
            };
            put(out.mean, mean);
            put(out.covariance, covariance);
            put(out.projected, projected);
            put(out.cross, cross);
        }
    out.base_noise = covariances("base_noise", *model.measurement, sample, count);
    out.dt = input("dt", h, 1, count, [&](double* to, std::int64_t) {
        for (std::int64_t j = 0; j < h; ++j) to[j] = sample.step();
    });
    out.dt.is_weightless = true;
    for (Argument* of_later_looks : {&out.covariance, &out.projected, &out.cross}) of_later_looks->is_weightless = true;
    return out;
}

}  // namespace

Outlook sample_outlook(const Instance& instance, Sample& sample, std::int64_t count) {
    const Sample here = sample;
    sample.uniform();  // the next outlook is another
    std::string refusal;
    for (const int axes : {2, 3})
        for (const std::vector<double>& derivatives :
             {std::vector<double>{1e4, 100, 10}, std::vector<double>{1e4, 100}}) {
            const Outlook outlook = outlook_in(instance, kinematic_space(axes, derivatives), here, count);
            const Execution done = execute(instance, choose(instance, outlook));
            if (done.status >= 0 || !done.left_by.empty()) return outlook;
            refusal = done.told();
        }
    FAIL("choose takes no positions and velocities, with or without accelerations, on two or three axes: " << refusal);
    return {};
}

HotCall choose(const Instance& instance, const Outlook& outlook, bool has_criterion) {
    const plr_waveform_info& model = info(instance);
    const std::int64_t m = model.measurement->size;
    HotCall call = make_call("choose", static_cast<std::int64_t>(outlook.base_noise.values.size()) / (m * m));
    call.may_refuse = true;
    call.in = {outlook.mean, outlook.covariance, outlook.projected, outlook.cross, outlook.base_noise, outlook.dt};
    call.out = {output("waveform", model.waveform->size, 1), output("noise", m, m, Content::covariance)};
    if (has_criterion) call.out.push_back(output("criterion", 1, 1));
    call.invoke = [own = &table(instance), self = instance.self(),
                   space = std::make_shared<const Space>(outlook.cartesian),
                   has_criterion](const plr_call& context, const Views& v) {
        plr_waveform_choose args{};
        args.struct_size = sizeof args;
        args.mean = v.in[0];
        args.covariance = v.in[1];
        args.projected = v.in[2];
        args.cross = v.in[3];
        args.base_noise = v.in[4];
        args.dt = v.in[5];
        args.waveform = v.out[chosen_waveform];
        args.noise = v.out[chosen_noise];
        args.criterion = has_criterion ? v.out[chosen_criterion] : plr_view{nullptr, 0, 0, 0, 0, 0, 0};
        args.cartesian = space->c();
        return own->choose(self, &context, &args);
    };
    return call;
}

Argument sample_waveforms(const Instance& instance, Sample& sample, std::int64_t count) {
    const plr_space& space = *info(instance).waveform;
    return input("waveform", space.size, 1, count, [&](double* out, std::int64_t) {
        for (std::uint32_t k = 0; k < space.size; ++k) {
            const auto& component = element_of(space.components, k);
            out[k] = component.prior_mean + component.prior_deviation * sample.uniform(-1, 1);
        }
    });
}

Argument base_waveforms(const Instance& instance, std::int64_t count) {
    const plr_space& space = *info(instance).waveform;
    return input("waveform", space.size, 1, count, [&](double* out, std::int64_t) {
        for (std::uint32_t k = 0; k < space.size; ++k) out[k] = element_of(space.components, k).prior_mean;
    });
}

HotCall noise(const Instance& instance, const Argument& waveforms, const Argument& base_noise) {
    const std::int64_t m = info(instance).measurement->size;
    HotCall call = make_call("noise", static_cast<std::int64_t>(base_noise.values.size()) / (m * m));
    call.may_refuse = true;
    call.in = {renamed(waveforms, "waveform"), base_noise};
    call.out = {output("out", m, m, Content::covariance)};
    call.invoke = [own = &table(instance), self = instance.self()](const plr_call& context, const Views& v) {
        plr_waveform_noise args{};
        args.struct_size = sizeof args;
        args.waveform = v.in[0];
        args.base_noise = v.in[1];
        args.out = v.out[0];
        return own->noise(self, &context, &args);
    };
    return call;
}

namespace {

std::vector<HotCall> all_calls(const Instance& instance, Sample sample, std::int64_t count) {
    const Outlook outlook = sample_outlook(instance, sample, count);
    return {choose(instance, outlook), noise(instance, sample_waveforms(instance, sample, count), outlook.base_noise)};
}

const detail::KindRegistration registration(PLR_WAVEFORM, all_calls,
                                            [](const Instance& instance) { return info(instance).scratch_bytes; });

}  // namespace

}  // namespace pelorus::conformance::waveform_calls
