// What a sensor promises of its spaces, its measurement and its residual.
#include <cmath>

#include <fmt/format.h>

#include "call_matrices.hpp"
#include "differences.hpp"
#include "machine/bench.hpp"
#include "sensor_calls.hpp"
#include "space_laws.hpp"

namespace pelorus::conformance {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr std::int64_t batch = 5;

using namespace sensor_calls;

/// A sensor on the bench, and some places that it measures.
struct SensorTrial {
    explicit SensorTrial(const Bench& bench, std::int64_t count = batch)
        : instance(bench.make()),
          facts(sensor_calls::info(*instance)),
          measurement(*facts.measurement),
          cartesian(*facts.cartesian),
          scales(scales_of(*facts.measurement)),
          cartesian_scales(scales_of(*facts.cartesian)),
          sample(bench.sample()),
          at(places(*instance, sample, count)) {}

    bool has(unsigned flag) const noexcept { return (facts.flags & flag) != 0; }
    Eigen::MatrixXd measured(const Eigen::MatrixXd& x) const {
        return answered(*instance, measure(*instance, columns("cartesian", x)));
    }
    /// Jacobians at the places; an empty matrix where they are refused. Fails the check if all are.
    std::vector<Eigen::MatrixXd> jacobians() const {
        const HotCall call = jacobian(*instance, at);
        const Execution done = execute_well(*instance, call);
        std::vector<Eigen::MatrixXd> found;
        std::int64_t refused = 0;
        for (std::int64_t i = 0; i < call.count; ++i) {
            refused += done.failed(i);
            found.push_back(done.failed(i) ? Eigen::MatrixXd() : item_matrix(call, done, 0, i));
        }
        if (refused == call.count) FAIL("jacobian refuses all places that measure answers: " << done.told());
        return found;
    }

    std::unique_ptr<Instance> instance;
    const plr_sensor_info& facts;
    Space measurement, cartesian;
    Eigen::VectorXd scales, cartesian_scales;
    Sample sample;
    Argument at;
};

}  // namespace

PELORUS_CHECK(sensor, "sensor-spaces-well-formed", 2,
              "Measurement, Cartesian, inverse and waveform space have known names with their units, in canonical "
              "order; scans meet sensors by them. `inverse` is part of the Cartesian space, in its order.",
              {}) {
    const auto instance = bench.make();
    const plr_sensor_info& facts = info(*instance);
    std::vector<std::string> faults = faults_of(facts.measurement, "measurement", Priors::zero);
    const auto add = [&](const std::vector<std::string>& more) {
        faults.insert(faults.end(), more.begin(), more.end());
    };
    add(faults_of(facts.cartesian, "cartesian", Priors::free));
    if (facts.inverse != nullptr) add(faults_of(facts.inverse, "inverse", Priors::free));
    if (facts.waveform != nullptr) add(faults_of(facts.waveform, "waveform", Priors::free));
    for (const std::string& fault : faults) FAIL_CHECK(fault);
    if (!faults.empty() || facts.inverse == nullptr) return;
    const Space cartesian(*facts.cartesian), inverse(*facts.inverse);
    int last = -1;
    for (const Component& component : inverse.components()) {
        const int place = cartesian.index(component.name);
        if (place < 0)
            FAIL_CHECK("inverse: " << component.name << " is not in the Cartesian space (" << cartesian.text() << ")");
        else if (place < last)
            FAIL_CHECK("inverse: " << component.name << " stands in another order than in the Cartesian space ("
                                   << cartesian.text() << ")");
        last = place;
    }
}

PELORUS_CHECK(sensor, "sensor-table-agrees-with-info", 2,
              "invert and `inverse` are there with CAN_INVERT and only then, the waveform's space with WAVEFORM and "
              "only then; a holder decides by info what it calls.",
              {}) {
    const auto instance = bench.make();
    const plr_sensor_info& facts = info(*instance);
    const plr_sensor& functions = table(*instance);
    if (functions.measure == nullptr || functions.jacobian == nullptr || functions.noise == nullptr ||
        functions.residual == nullptr)
        FAIL("measure, jacobian, noise and residual must all be there");
    const auto compare = [&](unsigned flag, const char* name, bool is_there, const char* what) {
        if (((facts.flags & flag) != 0) != is_there)
            FAIL_CHECK("flag " << name << " is " << ((facts.flags & flag) != 0 ? "set" : "not set") << " and " << what
                               << (is_there ? " is there" : " is NULL"));
    };
    compare(PLR_SENSOR_CAN_INVERT, "CAN_INVERT", functions.invert != nullptr, "invert");
    compare(PLR_SENSOR_CAN_INVERT, "CAN_INVERT", facts.inverse != nullptr, "info.inverse");
    compare(PLR_SENSOR_WAVEFORM, "WAVEFORM", facts.waveform != nullptr, "info.waveform");
}

PELORUS_CHECK(sensor, "sensor-points-equal-singles", 3,
              "Of several points of one item, each is measured as it would be alone, and each has its residual from "
              "the one reference; filters and trackers hand all over in one call.",
              {"numbers-finite"}) {
    SensorTrial trial(bench);
    constexpr std::int64_t points = 4;
    const auto compare = [&](const HotCall& call, const std::function<HotCall(std::int64_t)>& alone) {
        const Execution together = execute_well(*trial.instance, call);
        for (std::int64_t p = 0; p < points; ++p) {
            const HotCall single_call = alone(p);
            const Execution single = execute_well(*trial.instance, single_call);
            for (std::int64_t i = 0; i < call.count; ++i) {
                if (together.failed(i) || single.failed(i)) continue;
                const Eigen::VectorXd expected = item_matrix(single_call, single, 0, i);
                const std::string off =
                    first_difference(Eigen::VectorXd(item_matrix(call, together, 0, i).col(p)), expected,
                                     Eigen::VectorXd(1e-13 * (expected.cwiseAbs() + trial.scales)), trial.measurement);
                if (!off.empty())
                    FAIL(call.function << ": point " << p << " of item " << i << ", among " << points << ": " << off
                                       << " (alone)");
            }
        }
    };
    const auto spread = [&](const char* name, const Argument& about, const Eigen::VectorXd& scales) {
        return input(name, about.rows, points, batch, [&](double* out, std::int64_t i) {
            for (std::int64_t e = 0; e < about.rows * points; ++e)
                out[e] = item(about, i)(e % about.rows, 0) + 0.01 * scales(e % about.rows) * trial.sample.normal();
        });
    };
    const auto column = [&](const Argument& many, std::int64_t p) {
        return input(many.name, many.rows, 1, batch, [&](double* out, std::int64_t i) {
            Eigen::Map<Eigen::VectorXd>(out, many.rows) = item(many, i).col(p);
        });
    };
    const Argument where = spread("cartesian", trial.at, trial.cartesian_scales);
    compare(measure(*trial.instance, where),
            [&](std::int64_t p) { return measure(*trial.instance, column(where, p)); });
    const Argument reference = states("reference", *trial.facts.measurement, trial.sample, batch);
    const Argument several = spread("measurement", reference, trial.scales);
    compare(residual(*trial.instance, several, reference),
            [&](std::int64_t p) { return residual(*trial.instance, column(several, p), reference); });
}

PELORUS_CHECK(sensor, "sensor-jacobian-is-derivative", 3,
              "jacobian is the derivative of measure; a filter with another one diverges without a word.",
              {"numbers-finite"}) {
    SensorTrial trial(bench);
    const std::vector<Eigen::MatrixXd> said = trial.jacobians();
    for (std::int64_t i = 0; i < batch; ++i) {
        const Eigen::MatrixXd& h = said[static_cast<std::size_t>(i)];
        if (h.size() == 0) continue;
        const Eigen::VectorXd x = item(trial.at, i).col(0);
        const Differences differences(x, trial.cartesian_scales);
        const HotCall call = measure(*trial.instance, columns("cartesian", differences.points()));
        const Execution done = execute_well(*trial.instance, call);
        Eigen::MatrixXd values(h.rows(), call.count);
        for (std::int64_t p = 0; p < call.count; ++p) {
            if (done.failed(p))
                values.col(p).setConstant(NAN);
            else
                values.col(p) = item_matrix(call, done, 0, p);
        }
        const std::string wrong = disagreement(h, differences.estimate(values, trial.measurement), trial.measurement,
                                               trial.cartesian, trial.scales, trial.cartesian_scales);
        if (!wrong.empty()) FAIL("jacobian: " << wrong << " at " << text_of(x));
    }
}

PELORUS_CHECK(sensor, "sensor-linear-means-linear", 3,
              "With LINEAR, measure is H x and a constant, with one H everywhere; filters then take H once.",
              {"sensor-jacobian-is-derivative"}) {
    SensorTrial trial(bench);
    if (!trial.has(PLR_SENSOR_LINEAR)) skip("does not say LINEAR");
    const std::vector<Eigen::MatrixXd> h = trial.jacobians();
    Eigen::MatrixXd x(trial.at.rows, batch);
    for (std::int64_t i = 0; i < batch; ++i) x.col(i) = item(trial.at, i);
    const Eigen::MatrixXd z = trial.measured(x);
    for (Eigen::Index i = 1; i < batch; ++i) {
        const Eigen::MatrixXd& own = h[static_cast<std::size_t>(i)];
        if (own.size() == 0 || h[0].size() == 0) FAIL("jacobian refuses a place, and H is the same everywhere");
        INFO("places " << text_of(x.col(i)) << " and " << text_of(x.col(0)));
        const std::string other =
            first_difference(own, h[0], 1e-12 * h[0].cwiseAbs(), trial.measurement, trial.cartesian);
        if (!other.empty()) FAIL("jacobian: " << other << " at the other place");
        const Eigen::VectorXd rounding = h[0].cwiseAbs() * (x.col(i) + x.col(0)).cwiseAbs() + trial.scales;
        const std::string bent =
            first_difference(Eigen::VectorXd(z.col(i) - z.col(0)), Eigen::VectorXd(h[0] * (x.col(i) - x.col(0))),
                             Eigen::VectorXd(1e-10 * rounding), trial.measurement);
        if (!bent.empty()) FAIL("measure: the difference of " << bent << " (H times the places' difference)");
    }
}

PELORUS_CHECK(sensor, "sensor-angles-in-range", 3,
              "Angles that measure answers lie in (-pi, pi], straight behind the sensor too; whoever sorts or draws "
              "them relies on it.",
              {"numbers-finite"}) {
    SensorTrial trial(bench);
    bool has_angle = false;
    for (const Component& component : trial.measurement.components()) has_angle = has_angle || component.angle;
    if (!has_angle) skip("measures no angle");
    // All round, and along the negative axes, where -0 and the smallest steps to either side tell branches apart.
    constexpr int directions = 48;
    const std::vector<double> beside{0.0, -0.0, 1e-300, -1e-300, 1e-9, -1e-9};
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(trial.at.rows, directions + 2 * static_cast<int>(beside.size()));
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
        x.col(i) = item(trial.at, i % batch);
        if (i < directions) {
            const double angle = 2 * pi * static_cast<double>(i) / directions, reach = 1e4;
            x(0, i) = reach * std::cos(angle);
            if (x.rows() > 1) x(1, i) = reach * std::sin(angle);
            continue;
        }
        const auto k = static_cast<std::size_t>(i - directions);
        const Eigen::Index behind = k < beside.size() ? 0 : std::min<Eigen::Index>(1, x.rows() - 1);
        x(behind, i) = -1e4;
        if (x.rows() > 1) x(1 - behind, i) = beside[k % beside.size()];
    }
    const HotCall call = measure(*trial.instance, columns("cartesian", x));
    const Execution done = execute_well(*trial.instance, call);
    for (std::int64_t i = 0; i < call.count; ++i) {
        if (done.failed(i)) continue;
        const Eigen::VectorXd z = item_matrix(call, done, 0, i);
        for (int r = 0; r < trial.measurement.size(); ++r)
            if (trial.measurement[r].angle && !(z(r) > -pi && z(r) <= pi))
                FAIL(fmt::format("measure: {} is {:.17g} at {}, expected in (-pi, pi]", trial.measurement[r].name, z(r),
                                 text_of(x.col(i))));
    }
}

PELORUS_CHECK(sensor, "sensor-residual-wraps", 3,
              "residual is measurement - reference with angles wrapped to (-pi, pi], over several turns too; otherwise "
              "a target that crosses the cut throws its track a full turn.",
              {"numbers-finite"}) {
    SensorTrial trial(bench, 1);
    constexpr std::int64_t count = 40;
    const int m = trial.measurement.size();
    Eigen::MatrixXd z(m, count), reference(m, count);
    for (Eigen::Index i = 0; i < count; ++i) {
        z.col(i) = trial.sample.state(*trial.facts.measurement);
        reference.col(i) = trial.sample.state(*trial.facts.measurement);
        if (i % 8 == 0) reference.col(i) = z.col(i);
        for (int r = 0; r < m; ++r) {
            if (!trial.measurement[r].angle) continue;
            if (i % 8 == 1) z(r, i) = reference(r, i) + (1 - 1e-9) * pi;
            if (i % 8 == 2) z(r, i) = reference(r, i) - (1 - 1e-9) * pi;
            if (i % 8 == 3) z(r, i) += 2 * pi * static_cast<double>(1 + trial.sample.below(4));
            if (i % 8 == 4) z(r, i) -= 2 * pi * static_cast<double>(1 + trial.sample.below(4));
        }
    }
    const auto between = [&](const Eigen::MatrixXd& one, const Eigen::MatrixXd& other) {
        return answered(*trial.instance,
                        residual(*trial.instance, columns("measurement", one), columns("reference", other)));
    };
    const Eigen::MatrixXd forth = between(z, reference), back = between(reference, z);
    for (Eigen::Index i = 0; i < count; ++i) {
        INFO("residual of " << text_of(z.col(i)) << " from " << text_of(reference.col(i)));
        const Eigen::VectorXd allowed =
            1e-14 * (z.col(i).cwiseAbs() + reference.col(i).cwiseAbs()) + Eigen::VectorXd::Constant(m, 1e-14);
        const std::string off = first_difference(
            Eigen::VectorXd(forth.col(i)), Eigen::VectorXd(z.col(i) - reference.col(i)), allowed, trial.measurement);
        if (!off.empty()) FAIL(off << ", full turns apart");
        const std::string askew =
            first_difference(Eigen::VectorXd(forth.col(i)), Eigen::VectorXd(-back.col(i)), allowed, trial.measurement);
        if (!askew.empty()) FAIL(askew << ": the residual the other way, negated");
        for (int r = 0; r < m; ++r)
            if (trial.measurement[r].angle && !(forth(r, i) > -pi && forth(r, i) <= pi))
                FAIL(trial.measurement[r].name << " is " << forth(r, i) << ", expected in (-pi, pi]");
    }
}

}  // namespace pelorus::conformance
