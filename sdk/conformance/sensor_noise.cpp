// What a sensor promises of its noise, of the way back from a measurement, and of places that it cannot see.
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "call_matrices.hpp"
#include "differences.hpp"
#include "machine/bench.hpp"
#include "sensor_calls.hpp"

namespace pelorus::conformance {

namespace {

using namespace sensor_calls;
constexpr std::int64_t batch = 5;

/// Deviations that are fair to every lawful conversion: angles of `angle` rad at most, ranges and the like a thousandth of
/// themselves at most, from the sensor's own.
Eigen::VectorXd fair_deviations(const Space& space, const Eigen::MatrixXd& noise, const Eigen::VectorXd& z,
                                double angle) {
    Eigen::VectorXd deviations = noise.diagonal().cwiseSqrt();
    for (int r = 0; r < space.size(); ++r)
        deviations(r) = space[r].unit == "rad" ? std::min(deviations(r), angle)
                                               : std::min(deviations(r), 1e-3 * std::fabs(z(r)) + 1e-6);
    return deviations;
}

/// A sensor that inverts, a place, its measurement and the nominal noise there.
struct InverseTrial {
    explicit InverseTrial(const Bench& bench)
        : instance(bench.make()), facts(info(*instance)), measurement(*facts.measurement), sample(bench.sample()) {
        if ((facts.flags & PLR_SENSOR_CAN_INVERT) == 0 || table(*instance).invert == nullptr ||
            facts.inverse == nullptr)
            skip("does not say CAN_INVERT");
        inverse = Space(*facts.inverse);
        const Space cartesian(*facts.cartesian);
        const Argument at = places(*instance, sample, batch);
        x = Eigen::Map<const Eigen::MatrixXd>(at.values.data(), at.rows, batch);
        wanted.resize(inverse.size(), batch);
        for (int r = 0; r < inverse.size(); ++r) wanted.row(r) = x.row(std::max(0, cartesian.index(inverse[r].name)));
        z = answered(*instance, measure(*instance, at));
        noise =
            answered_matrices(*instance, sensor_calls::noise(*instance, batch, at, absent("snr"), absent("waveform")));
    }
    HotCall inverse_of(const Eigen::MatrixXd& measurements, const Eigen::MatrixXd& errors) const {
        const Argument same =
            input("noise", errors.rows(), errors.cols(), measurements.cols(), [&](double* out, std::int64_t) {
                Eigen::Map<Eigen::MatrixXd>(out, errors.rows(), errors.cols()) = errors;
            });
        return invert(*instance, columns("measurement", measurements), same);
    }
    /// d invert / d measurement, by differences that stay well within a turn.
    Eigen::MatrixXd slopes(Eigen::Index i, const Eigen::MatrixXd& errors) const {
        Eigen::VectorXd reach = scales_of(*facts.measurement);
        for (int r = 0; r < measurement.size(); ++r)
            if (measurement[r].unit != "rad") reach(r) = std::min(reach(r), std::fabs(z(r, i)) + 1e-3);
        const Differences differences(z.col(i), reach);
        const HotCall call = inverse_of(differences.points(), errors);
        const Execution done = execute_well(*instance, call);
        Eigen::MatrixXd values(inverse.size(), call.count);
        for (std::int64_t p = 0; p < call.count; ++p)
            if (done.failed(p))
                values.col(p).setConstant(NAN);
            else
                values.col(p) = item_matrix(call, done, 0, p);
        return differences.estimate(values, inverse).value;
    }

    std::unique_ptr<Instance> instance;
    const plr_sensor_info& facts;
    Space measurement, inverse;
    Sample sample;
    Eigen::MatrixXd x, wanted, z;
    std::vector<Eigen::MatrixXd> noise;
};

Eigen::MatrixXd diagonal(const Eigen::VectorXd& deviations) { return deviations.cwiseAbs2().asDiagonal(); }

/// How far second-order terms of the conversion reach, m: half the squared deviations of angles times the slopes.
Eigen::VectorXd second_order(const Space& space, const Eigen::MatrixXd& slopes, const Eigen::VectorXd& deviations) {
    double reach = 0;
    for (int r = 0; r < space.size(); ++r)
        if (space[r].unit == "rad") reach += slopes.col(r).norm() * deviations(r) * deviations(r) / 2;
    return Eigen::VectorXd::Constant(slopes.rows(), reach);
}

/// Conversions of measurements of one place whose angles are as coarse as a twentieth of a radian: there it shows how they bend.
struct CoarseConversions {
    Eigen::VectorXd deviations;
    Eigen::MatrixXd errors;  ///< a column a measurement
    std::vector<Eigen::MatrixXd> covariances;
};
CoarseConversions convert_coarsely(InverseTrial& trial, Eigen::Index i) {
    constexpr std::int64_t count = 4000;
    CoarseConversions found;
    found.deviations =
        fair_deviations(trial.measurement, trial.noise[static_cast<std::size_t>(i)], trial.z.col(i), 1.0);
    for (int r = 0; r < trial.measurement.size(); ++r)
        if (trial.measurement[r].angle) found.deviations(r) = 0.05;
    Eigen::MatrixXd drawn(trial.z.rows(), count);
    for (Eigen::Index k = 0; k < count; ++k)
        for (Eigen::Index r = 0; r < drawn.rows(); ++r)
            drawn(r, k) = trial.sample.normal(trial.z(r, i), found.deviations(r));
    const HotCall call = trial.inverse_of(drawn, diagonal(found.deviations));
    const Execution done = execute_well(*trial.instance, call);
    found.errors.resize(trial.inverse.size(), count);
    for (std::int64_t k = 0; k < count; ++k) {
        if (done.failed(k)) FAIL("invert refuses a measurement near that of " << text_of(trial.x.col(i)));
        found.errors.col(k) = item_matrix(call, done, 0, k) - trial.wanted.col(i);
        found.covariances.emplace_back(item_matrix(call, done, 1, k));
    }
    return found;
}

/// The sensor's own position (item 1) and a point straight above it (item 3), as far as invert tells them of range 0.
std::vector<std::pair<std::int64_t, Eigen::VectorXd>> special_places(const Instance& instance, const Argument& at) {
    const plr_sensor_info& facts = info(instance);
    const Space measurement(*facts.measurement);
    const int range = measurement.index("range"), elevation = measurement.index("elevation"),
              zenith = measurement.index("zenith");
    if (table(instance).invert == nullptr || facts.inverse == nullptr || range < 0) return {};
    const HotCall seen = measure(instance, at).of_items({0, 0});
    Eigen::MatrixXd z(measurement.size(), 2);
    z.col(0) = z.col(1) = item_matrix(seen, execute_well(instance, seen), 0, 0);
    z(range, 0) = 0;
    if (elevation >= 0) z(elevation, 1) = 1.57079632679489661923;
    if (zenith >= 0) z(zenith, 1) = 0;
    const Argument tiny = input("noise", z.rows(), z.rows(), 2, [&](double* out, std::int64_t) {
        Eigen::Map<Eigen::MatrixXd>(out, z.rows(), z.rows()) = 1e-12 * Eigen::MatrixXd::Identity(z.rows(), z.rows());
    });
    const HotCall back = invert(instance, columns("measurement", z), tiny, false);
    const Execution done = execute(instance, back);
    std::vector<std::pair<std::int64_t, Eigen::VectorXd>> found;
    for (const std::int64_t i : {0, 1})
        if (done.status >= 0 && !done.failed(i) && item_matrix(back, done, 0, i).allFinite())
            found.emplace_back(1 + 2 * i, item_matrix(back, done, 0, i));
    return found;
}

}  // namespace

PELORUS_CHECK(sensor, "sensor-constant-noise-is-constant", 3,
              "With CONSTANT_NOISE, noise is the same everywhere, at any signal-to-noise ratio, and without a place; "
              "holders then ask once.",
              {"numbers-finite"}) {
    const auto instance = bench.make();
    const plr_sensor_info& facts = info(*instance);
    if ((facts.flags & PLR_SENSOR_CONSTANT_NOISE) == 0) skip("does not say CONSTANT_NOISE");
    Sample sample = bench.sample();
    const Argument at = places(*instance, sample, batch);
    const Argument snr =
        input("snr", 1, 1, batch, [&](double* out, std::int64_t) { *out = std::pow(10.0, sample.uniform(0.0, 3.0)); });
    const auto bare =
        answered_matrices(*instance, noise(*instance, 1, absent("cartesian"), absent("snr"), absent("waveform")))[0];
    const Space space(*facts.measurement);
    for (const HotCall& call : {noise(*instance, batch, at, absent("snr"), absent("waveform")),
                                noise(*instance, batch, at, snr, absent("waveform")),
                                noise(*instance, batch, at, snr, waveforms(*instance, sample, batch))}) {
        const auto given = answered_matrices(*instance, call);
        for (std::size_t i = 0; i < given.size(); ++i) {
            const std::string differs = first_difference(given[i], bare, 1e-12 * element_scales(bare), space, space);
            if (!differs.empty())
                FAIL("noise at " << text_of(item(at, static_cast<std::int64_t>(i)).col(0))
                                 << (call.in[1].is_absent ? "" : " with a signal-to-noise ratio") << ": " << differs
                                 << " (without any argument)");
        }
    }
}

PELORUS_CHECK(sensor, "sensor-noise-is-definite", 3,
              "No combination of measurement components is without noise: the covariance has an inverse, which updates "
              "and likelihoods take.",
              {"covariances-positive"}) {
    const auto instance = bench.make();
    Sample sample = bench.sample();
    const Argument at = places(*instance, sample, batch);
    const HotCall call = noise(*instance, batch, at, absent("snr"), absent("waveform"));
    const Execution done = execute_well(*instance, call);
    const Space space(*info(*instance).measurement);
    for (std::int64_t i = 0; i < batch; ++i) {
        if (done.failed(i)) continue;
        const Eigen::MatrixXd r = item_matrix(call, done, 0, i);
        for (int k = 0; k < space.size(); ++k)
            if (!(r(k, k) > 0))
                FAIL("noise: the variance of " << space[k].name << " is " << r(k, k) << ", expected above 0");
        const Eigen::VectorXd unit = r.diagonal().cwiseSqrt().cwiseInverse();
        const Eigen::MatrixXd scaled = unit.asDiagonal() * r * unit.asDiagonal();
        const double least =
            Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues()(0);
        if (least < 1e-12)
            FAIL("noise of item " << i << " has no inverse: least eigenvalue " << least
                                  << " (scaled to a unit diagonal)");
    }
}

PELORUS_CHECK(sensor, "sensor-noise-falls-with-snr", 3,
              "A better signal-to-noise ratio never makes a variance larger; a tracker that weighs echoes by it would "
              "trust the worst.",
              {"numbers-finite"}) {
    const auto instance = bench.make();
    Sample sample = bench.sample();
    constexpr std::int64_t count = 12;
    const Argument one = places(*instance, sample, 1);
    const Argument at = input("cartesian", one.rows, 1, count,
                              [&](double* out, std::int64_t) { std::copy_n(one.values.data(), one.rows, out); });
    const Argument snr = input(
        "snr", 1, 1, count, [&](double* out, std::int64_t i) { *out = std::pow(10.0, 0.25 * static_cast<double>(i)); });
    const HotCall call = noise(*instance, count, at, snr, absent("waveform"));
    const Execution done = execute_well(*instance, call);
    const Space space(*info(*instance).measurement);
    for (std::int64_t i = 1; i < count; ++i) {
        if (done.failed(i) || done.failed(i - 1)) continue;
        const Eigen::MatrixXd worse = item_matrix(call, done, 0, i - 1), better = item_matrix(call, done, 0, i);
        for (int k = 0; k < space.size(); ++k)
            if (better(k, k) > worse(k, k) * (1 + 1e-12))
                FAIL(fmt::format(
                    "noise: the variance of {} grows from {:.9g} to {:.9g} as snr goes from {:.4g} to {:.4g}",
                    space[k].name, worse(k, k), better(k, k), snr.values[static_cast<std::size_t>(i - 1)],
                    snr.values[static_cast<std::size_t>(i)]));
    }
}

PELORUS_CHECK(sensor, "sensor-inverse-undoes-measure", 3,
              "Where errors are small, invert leads from the measurement of a place back to that place; tracks are "
              "started there.",
              {"numbers-finite"}) {
    const InverseTrial trial(bench);
    for (Eigen::Index i = 0; i < batch; ++i) {
        const Eigen::VectorXd tiny =
            1e-3 * fair_deviations(trial.measurement, trial.noise[static_cast<std::size_t>(i)], trial.z.col(i), 1e-3);
        const HotCall call = trial.inverse_of(trial.z.col(i), diagonal(tiny));
        const Execution done = execute_well(*trial.instance, call);
        if (done.failed(0)) FAIL("invert refuses what measure answers at " << text_of(trial.x.col(i)));
        // The corrections for errors of a millionth of a radian are of order 1e-12.
        const Eigen::VectorXd allowed = 1e-9 * (trial.wanted.col(i).cwiseAbs() + scales_of(*trial.facts.inverse));
        const std::string lost = first_difference(Eigen::VectorXd(item_matrix(call, done, 0, 0)),
                                                  Eigen::VectorXd(trial.wanted.col(i)), allowed, trial.inverse);
        if (!lost.empty()) FAIL("invert: " << lost << " for the measurement of " << text_of(trial.x.col(i)));
    }
}

PELORUS_CHECK(sensor, "sensor-inverse-covariance-is-carried", 3,
              "Where errors are small, invert's covariance is the noise carried through the derivative of its mean, "
              "J R J'; a track started with another one is lost or dragged.",
              {"sensor-inverse-undoes-measure"}) {
    const InverseTrial trial(bench);
    for (Eigen::Index i = 0; i < batch; ++i) {
        const auto at = static_cast<std::size_t>(i);
        // Correlated as the sensor's own errors, or somewhat where those are not.
        const Eigen::VectorXd deviations = fair_deviations(trial.measurement, trial.noise[at], trial.z.col(i), 1e-3);
        const Eigen::VectorXd unit = trial.noise[at].diagonal().cwiseSqrt().cwiseInverse();
        const Eigen::MatrixXd correlation = unit.asDiagonal() * trial.noise[at] * unit.asDiagonal();
        Eigen::MatrixXd errors = deviations.asDiagonal() * correlation * deviations.asDiagonal();
        errors = (0.5 * (errors + errors.transpose())).eval();
        const HotCall call = trial.inverse_of(trial.z.col(i), errors);
        const Execution done = execute_well(*trial.instance, call);
        if (done.failed(0)) FAIL("invert refuses what measure answers at " << text_of(trial.x.col(i)));
        const Eigen::MatrixXd j = trial.slopes(i, errors), expected = j * errors * j.transpose();
        // Terms of second order: of the angles' variances beside 1, and of the bend of the conversion.
        const Eigen::VectorXd bend = 4 * second_order(trial.measurement, j, deviations);
        const Eigen::MatrixXd allowed = 0.01 * element_scales(expected) + bend * bend.transpose();
        const std::string off =
            first_difference(item_matrix(call, done, 1, 0), expected, allowed, trial.inverse, trial.inverse);
        if (!off.empty())
            FAIL("invert: covariance: " << off << " (J R J', J by differences) at " << text_of(trial.x.col(i)));
    }
}

PELORUS_CHECK(
    sensor, "sensor-inverse-is-unbiased", 4,
    "Averaged over errors, invert's mean is the true place; angles bend errors, and what is not corrected for "
    "that pulls every track to one side.",
    {"sensor-inverse-covariance-is-carried"}) {
    InverseTrial trial(bench);
    for (Eigen::Index i = 0; i < batch; ++i) {
        const CoarseConversions done = convert_coarsely(trial, i);
        const auto count = static_cast<double>(done.errors.cols());
        const Eigen::VectorXd bias = done.errors.rowwise().mean();
        const Eigen::VectorXd deviation =
            ((done.errors.colwise() - bias).rowwise().squaredNorm() / (count - 1)).cwiseSqrt();
        // Six deviations of the mean (2e-9 a component) and a tenth of the bend that a plain conversion leaves: terms of fourth
        // order, which series corrections may drop.
        const Eigen::MatrixXd j = trial.slopes(i, diagonal(done.deviations));
        const Eigen::VectorXd allowed =
            6 * deviation / std::sqrt(count) + 0.1 * second_order(trial.measurement, j, done.deviations);
        const std::string off = first_difference(bias, Eigen::VectorXd::Zero(bias.size()), allowed, trial.inverse);
        if (!off.empty())
            FAIL("invert: the mean error of " << off << " (within " << text_of(allowed) << ") over "
                                              << done.errors.cols() << " measurements of " << text_of(trial.x.col(i))
                                              << " with deviations " << text_of(done.deviations));
    }
}

PELORUS_CHECK(
    sensor, "sensor-inverse-is-consistent", 4,
    "Averaged over errors, squared errors over the covariance that invert tells are as many as there are components, "
    "within three times where angles are coarse; a covariance carried by the derivative alone leaves out the bend, and "
    "a track started with it trusts a range that it does not know.",
    {"sensor-inverse-covariance-is-carried"}) {
    InverseTrial trial(bench);
    for (Eigen::Index i = 0; i < batch; ++i) {
        const CoarseConversions done = convert_coarsely(trial, i);
        double mean = 0;
        for (Eigen::Index k = 0; k < done.errors.cols(); ++k)
            mean +=
                done.errors.col(k).dot(done.covariances[static_cast<std::size_t>(k)].ldlt().solve(done.errors.col(k))) /
                static_cast<double>(done.errors.cols());
        // A conversion is unbiased about the true place or about the measured one, not both (Longbin et al., "Unbiased converted
        // measurements for tracking", 1998): what is right for the one has 2 (one angle) to 2.3 times (two) the error of the other.
        const double each = mean / trial.inverse.size();
        const std::string told = fmt::format(
            "invert: squared errors over the covariance told are {:.2f} on average for {} components, over "
            "{} measurements of {} with deviations {}",
            mean, trial.inverse.size(), done.errors.cols(), text_of(trial.x.col(i)), text_of(done.deviations));
        if (!(each > 1.0 / 3 && each < 3)) FAIL(told << "; expected a third to three times as many as components");
        if (i == 0) note(told);
    }
}

PELORUS_CHECK(sensor, "sensor-blind-spots-are-told", 3,
              "At places where a measurement or its derivative is not defined (at the sensor itself, straight above "
              "it), every call answers numbers or refuses that item alone; targets do fly there.",
              {"numbers-finite"}) {
    const auto instance = bench.make();
    const plr_sensor_info& facts = info(*instance);
    Sample sample = bench.sample();
    Argument at = places(*instance, sample, 7);
    const std::int64_t c = at.rows;
    const auto set = [&](std::int64_t i, std::int64_t row, double value) {
        if (row < c) at.values[static_cast<std::size_t>(i * c + row)] = value;
    };
    // Between places that are seen: at the origin, on each axis, and where the sensor says that range 0 is.
    for (std::int64_t row = 0; row < c; ++row) set(1, row, 0.0);
    for (const std::int64_t row : {1, 2}) set(3, row, 0.0);
    for (const std::int64_t row : {0, 1}) set(5, row, 0.0);
    const auto put = [&](std::int64_t i, const Eigen::VectorXd& place) {
        const Space cartesian(*facts.cartesian), inverse(*facts.inverse);
        for (int r = 0; r < inverse.size(); ++r) set(i, cartesian.index(inverse[r].name), place(r));
    };
    for (const auto& [i, place] : special_places(*instance, at)) put(i, place);
    for (const HotCall& call : {measure(*instance, at), jacobian(*instance, at),
                                noise(*instance, 7, at, absent("snr"), absent("waveform"))}) {
        const Execution done = execute_well(*instance, call);
        for (std::int64_t i = 0; i < 7; ++i) {
            const Eigen::VectorXd where = item(at, i).col(0);
            if (done.failed(i)) continue;
            const Eigen::MatrixXd values = item_matrix(call, done, 0, i);
            if (!values.allFinite())
                FAIL(call.function << " answers " << values(0, 0) << " and so on at " << text_of(where)
                                   << " without refusing it");
        }
        for (const std::int64_t i : {0, 2, 4, 6}) {
            const HotCall alone = call.of_items({i});
            std::string difference;
            if (!same_item(call, done, i, alone, execute_well(*instance, alone), 0, difference))
                FAIL(call.function << ": a blind spot reaches another item: " << difference);
        }
    }
}

}  // namespace pelorus::conformance
