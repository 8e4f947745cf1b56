// What a motion promises of its mean: propagate, jacobian, and the flags that speak of them.
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <fmt/format.h>

#include "differences.hpp"
#include "motion_trial.hpp"
#include "space_laws.hpp"

namespace pelorus::conformance {

namespace {

constexpr std::int64_t batch = 5;

/// What rounding may do to a state that a step has moved: relative to the terms that it is summed of.
Eigen::VectorXd rounding_of(const Eigen::MatrixXd& f, const Eigen::VectorXd& x, const Eigen::VectorXd& y) {
    return f.cwiseAbs() * x.cwiseAbs() + y.cwiseAbs();
}

/// Where a space has position.x and velocity.x, and likewise y and z.
struct VelocityComponents {
    explicit VelocityComponents(const Space& space) {
        for (const char* const axis : {"x", "y", "z"}) {
            const int p = space.index(std::string("position.") + axis),
                      v = space.index(std::string("velocity.") + axis);
            if (p < 0 || v < 0) continue;
            positions.push_back(p);
            velocities.push_back(v);
        }
    }
    std::vector<int> positions, velocities;
};

/// How fast each Cartesian component changes as a step begins, an item a column: from steps of 0.1 s down, each half the one before.
DerivativeEstimate rates_at_once(const MotionTrial& trial, const MotionItems& items, const Eigen::MatrixXd& before) {
    constexpr int halvings = 20;
    DerivativeEstimate best{Eigen::MatrixXd::Zero(before.rows(), before.cols()),
                            Eigen::MatrixXd::Constant(before.rows(), before.cols(), HUGE_VAL)};
    Eigen::ArrayXXd slope, straight, change;  // of the step before; `straight` without what falls with dt
    for (int k = 0; k < halvings; ++k) {
        const double dt = std::ldexp(0.1, -k);
        const Eigen::MatrixXd moved =
            trial.to_cartesian(trial.propagate(Eigen::VectorXd::Constant(before.cols(), dt), items));
        const Eigen::ArrayXXd now = (moved - before).array() / dt;
        const Eigen::ArrayXXd extrapolated = k == 0 ? now : Eigen::ArrayXXd(2 * now - slope);
        const Eigen::ArrayXXd changed = k == 0 ? now : Eigen::ArrayXXd((extrapolated - straight).abs());
        if (k > 2) {
            const Eigen::ArrayXXd rounding =
                8 * std::numeric_limits<double>::epsilon() * (moved.array().abs() + before.array().abs()) / dt;
            // What is left falls by four with each halving. Two changes, because one may vanish by chance.
            const Eigen::ArrayXXd uncertainty = changed.max(change / 4) + rounding;
            for (Eigen::Index e = 0; e < now.size(); ++e) {
                if (!(uncertainty(e) < best.uncertainty(e))) continue;
                best.value(e) = extrapolated(e);
                best.uncertainty(e) = uncertainty(e);
            }
        }
        slope = now;
        straight = extrapolated;
        change = changed;
    }
    return best;
}

}  // namespace

PELORUS_CHECK(motion, "motion-spaces-well-formed", 2,
              "State and Cartesian space have known names with their units, in canonical order, positions first, each "
              "component with a prior; models meet by these names, and unknown components start from these priors.",
              {}) {
    const MotionTrial trial(bench);
    for (const std::string& fault : faults_of(trial.info.state, "state", Priors::positive)) FAIL_CHECK(fault);
    for (const std::string& fault : faults_of(trial.info.cartesian, "cartesian", Priors::positive)) FAIL_CHECK(fault);
    if (leading_positions(*trial.info.cartesian) == 0)
        FAIL_CHECK("cartesian begins with " << trial.cartesian[0].name << ", expected position.x");
}

PELORUS_CHECK(motion, "motion-table-agrees-with-info", 2,
              "The functions that the table has are those that info and the spaces ask for; a holder decides by info "
              "what it calls.",
              {}) {
    const MotionTrial trial(bench);
    const plr_motion& table = trial.table;
    const auto told = [](const void* pointer) { return pointer == nullptr ? "is NULL" : "is there"; };
    if (table.propagate == nullptr || table.jacobian == nullptr || table.noise == nullptr)
        FAIL("propagate, jacobian and noise must all be there");
    const bool has_record = trial.info.record_size > 0;
    if ((table.init_record != nullptr) != has_record || (table.advance_record != nullptr) != has_record)
        FAIL_CHECK("record_size is " << trial.info.record_size << ", init_record "
                                     << told(reinterpret_cast<const void*>(table.init_record)) << " and advance_record "
                                     << told(reinterpret_cast<const void*>(table.advance_record))
                                     << "; both are there with a record and NULL without");
    if ((table.to_cartesian != nullptr) != (table.from_cartesian != nullptr))
        FAIL_CHECK("to_cartesian " << told(reinterpret_cast<const void*>(table.to_cartesian)) << " and from_cartesian "
                                   << told(reinterpret_cast<const void*>(table.from_cartesian))
                                   << "; expected both or none");
    if (table.to_cartesian == nullptr && table.from_cartesian == nullptr && !trial.state.same(trial.cartesian))
        FAIL_CHECK("to_cartesian is NULL and the state (" << trial.state.text() << ") is not the Cartesian space ("
                                                          << trial.cartesian.text() << ")");
    const auto* structure = trial.instance->extension<plr_motion_structure>(PLR_MOTION_STRUCTURE);
    if (structure != nullptr && std::int64_t{structure->block} * structure->dimension != trial.n)
        FAIL_CHECK("extension " << PLR_MOTION_STRUCTURE << " has " << structure->block << " blocks of "
                                << structure->dimension << " axes, the state has " << trial.n << " components");
    if (structure != nullptr && !(trial.has(PLR_MOTION_LINEAR) && trial.has(PLR_MOTION_CONSTANT_NOISE)))
        FAIL_CHECK("extension " << PLR_MOTION_STRUCTURE << " is for motions that are LINEAR with CONSTANT_NOISE");
    const auto* factor = trial.instance->extension<plr_motion_noise_factor>(PLR_MOTION_NOISE_FACTOR);
    if (factor != nullptr && (factor->columns < 1 || factor->columns > trial.n))
        FAIL_CHECK("extension " << PLR_MOTION_NOISE_FACTOR << " has " << factor->columns << " columns, expected 1 to "
                                << trial.n);
}

PELORUS_CHECK(motion, "motion-zero-step-is-identity", 3,
              "A step of dt = 0 moves nothing: propagate answers the state, jacobian the identity and, with "
              "EXACT_NOISE, noise 0; two scans of one time are filtered by such steps.",
              {"numbers-finite"}) {
    MotionTrial trial(bench);
    const MotionItems items = trial.draw(batch);
    const Eigen::VectorXd dt = Eigen::VectorXd::Zero(batch);
    const Eigen::MatrixXd before = states_of(items), after = trial.propagate(dt, items);
    const auto jacobians = trial.jacobian(dt, items);
    const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(trial.n, trial.n);
    const Eigen::MatrixXd ratios = trial.scales * trial.scales.cwiseInverse().transpose();
    for (Eigen::Index i = 0; i < batch; ++i) {
        INFO("dt = 0, state " << text_of(before.col(i)));
        const std::string moved = first_difference(after.col(i), before.col(i),
                                                   1e-12 * (before.col(i).cwiseAbs() + trial.scales), trial.state);
        if (!moved.empty()) FAIL("propagate: " << moved);
        const std::string turned = first_difference(jacobians[static_cast<std::size_t>(i)], identity, 1e-12 * ratios,
                                                    trial.state, trial.state);
        if (!turned.empty()) FAIL("jacobian: " << turned);
    }
    if (!trial.has(PLR_MOTION_EXACT_NOISE)) return;
    for (const Eigen::MatrixXd& q : trial.noise(dt, items)) {
        const std::string left =
            first_difference(q, Eigen::MatrixXd::Zero(trial.n, trial.n),
                             1e-20 * element_scales(trial.scales.cwiseAbs2().asDiagonal()), trial.state, trial.state);
        if (!left.empty()) FAIL("noise with EXACT_NOISE: " << left);
    }
}

PELORUS_CHECK(motion, "motion-jacobian-is-derivative", 3,
              "jacobian is the derivative of propagate; a filter with another one diverges without a word.",
              {"motion-points-equal-singles"}) {
    MotionTrial trial(bench);
    const MotionItems items = trial.draw(batch);
    const Eigen::MatrixXd x = states_of(items);
    const Eigen::VectorXd dt = trial.drawn_steps(batch);
    const auto said = trial.jacobian(dt, items);
    std::vector<Differences> differences;
    for (Eigen::Index i = 0; i < batch; ++i) differences.emplace_back(x.col(i), trial.scales);
    const Eigen::Index points = differences[0].points().cols();
    const Argument spread = input("state", trial.n, points, batch, [&](double* out, std::int64_t i) {
        Eigen::Map<Eigen::MatrixXd>(out, trial.n, points) = differences[static_cast<std::size_t>(i)].points();
    });
    // The mean is held fixed: the points are displaced about it.
    const Eigen::MatrixXd moved = answered(
        *trial.instance, motion_calls::propagate(*trial.instance, steps(dt), spread, items.record, items.state));
    for (Eigen::Index i = 0; i < batch; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const DerivativeEstimate found = differences[at].estimate(moved.middleCols(i * points, points), trial.state);
        const std::string wrong = disagreement(said[at], found, trial.state, trial.state, trial.scales, trial.scales);
        if (!wrong.empty()) FAIL("jacobian: " << wrong << " at dt = " << dt(i) << " s, state " << text_of(x.col(i)));
    }
}

PELORUS_CHECK(motion, "motion-linear-means-linear", 3,
              "With LINEAR, propagate is F x with one F for a dt, whatever the state; estimators then take F once for "
              "all tracks.",
              {"motion-jacobian-is-derivative"}) {
    MotionTrial trial(bench);
    if (!trial.has(PLR_MOTION_LINEAR)) skip("does not say LINEAR");
    const MotionItems items = trial.draw(batch);
    const Eigen::VectorXd dt = Eigen::VectorXd::Constant(batch, trial.sample.step());
    const Eigen::MatrixXd x = states_of(items), y = trial.propagate(dt, items);
    const auto f = trial.jacobian(dt, items);
    for (Eigen::Index i = 0; i < batch; ++i) {
        INFO("dt = " << dt(0) << " s");
        const std::string other =
            first_difference(f[static_cast<std::size_t>(i)], f[0], 1e-12 * f[0].cwiseAbs(), trial.state, trial.state);
        if (!other.empty())
            FAIL("jacobian: " << other << ": F differs between the states " << text_of(x.col(i)) << " and "
                              << text_of(x.col(0)));
        const std::string bent =
            first_difference(y.col(i), f[0] * x.col(i), 1e-11 * rounding_of(f[0], x.col(i), y.col(i)), trial.state);
        if (!bent.empty()) FAIL("propagate: " << bent << " (F x) at state " << text_of(x.col(i)));
    }
}

PELORUS_CHECK(motion, "motion-steps-compose", 3,
              "With TIME_INVARIANT, a step of a and one of b lead where one of a + b leads, F(a + b) = F(b) F(a); "
              "estimators then cut steps as scans come.",
              {"motion-jacobian-is-derivative"}) {
    MotionTrial trial(bench);
    if (!trial.has(PLR_MOTION_TIME_INVARIANT)) skip("does not say TIME_INVARIANT");
    const MotionItems items = trial.draw(batch);
    const Eigen::VectorXd a = trial.drawn_steps(batch), b = trial.drawn_steps(batch);
    const Eigen::MatrixXd between = trial.propagate(a, items), after = trial.propagate(b, between, items);
    const Eigen::MatrixXd at_once = trial.propagate(a + b, items);
    const auto fa = trial.jacobian(a, items), fb = trial.jacobian(b, between, items),
               fab = trial.jacobian(a + b, items);
    for (Eigen::Index i = 0; i < batch; ++i) {
        const auto k = static_cast<std::size_t>(i);
        INFO("a = " << a(i) << " s, b = " << b(i) << " s, state " << text_of(states_of(items).col(i)));
        // A millionth of the way, for motions that integrate.
        const Eigen::VectorXd way = (at_once.col(i) - states_of(items).col(i)).cwiseAbs();
        const Eigen::VectorXd rounding =
            rounding_of(fb[k].cwiseAbs() * fa[k].cwiseAbs(), states_of(items).col(i), at_once.col(i));
        const std::string apart =
            first_difference(at_once.col(i), after.col(i), 1e-6 * way + 1e-10 * rounding, trial.state);
        if (!apart.empty()) FAIL("propagate(a + b): " << apart << " (a, then b)");
        const Eigen::MatrixXd product = fb[k] * fa[k];
        const Eigen::MatrixXd allowed = 1e-6 * (fb[k].cwiseAbs() * fa[k].cwiseAbs() + fab[k].cwiseAbs()) +
                                        1e-10 * trial.scales * trial.scales.cwiseInverse().transpose();
        const std::string matrix = first_difference(fab[k], product, allowed, trial.state, trial.state);
        if (!matrix.empty()) FAIL("jacobian(a + b): " << matrix << " (F(b) F(a))");
    }
}

PELORUS_CHECK(motion, "motion-backward-undoes-forward", 3,
              "With TIME_INVARIANT and BACKWARD, a step of -dt leads back to where a step of dt came from; smoothing "
              "and belated scans go that way.",
              {"motion-steps-compose"}) {
    MotionTrial trial(bench);
    if (!trial.has(PLR_MOTION_BACKWARD)) skip("does not say BACKWARD");
    if (!trial.has(PLR_MOTION_TIME_INVARIANT)) skip("does not say TIME_INVARIANT");
    const MotionItems items = trial.draw(batch);
    const Eigen::VectorXd dt = trial.drawn_steps(batch);
    const Eigen::MatrixXd before = states_of(items), after = trial.propagate(dt, items);
    const Eigen::MatrixXd back = trial.propagate(-dt, after, items);
    const auto f = trial.jacobian(dt, items), b = trial.jacobian(-dt, after, items);
    for (Eigen::Index i = 0; i < batch; ++i) {
        const auto k = static_cast<std::size_t>(i);
        INFO("dt = " << dt(i) << " s, state " << text_of(before.col(i)));
        // Back from a state that has decayed multiplies rounding: by the terms of F(-dt) F(dt).
        const Eigen::VectorXd rounding =
            rounding_of(b[k].cwiseAbs() * f[k].cwiseAbs(), before.col(i), b[k].cwiseAbs() * after.col(i).cwiseAbs());
        const Eigen::VectorXd way = (after.col(i) - before.col(i)).cwiseAbs();
        const std::string lost =
            first_difference(back.col(i), before.col(i), 1e-6 * way + 1e-10 * rounding, trial.state);
        if (!lost.empty()) FAIL("propagate(-dt) after propagate(dt): " << lost);
    }
}

PELORUS_CHECK(motion, "motion-velocity-is-derivative", 3,
              "In the Cartesian space velocity.x is the rate at which position.x changes, on every axis that has both: "
              "the limit for short steps. Sensors of Doppler and the measures of error take it for that. A state that "
              "holds another velocity (through the air) gives it another name, and to_cartesian answers that over "
              "the ground.",
              {"motion-zero-step-is-identity"}) {
    MotionTrial trial(bench);
    const VelocityComponents components(trial.cartesian);
    if (components.velocities.empty()) skip("its Cartesian space has no velocity beside a position");
    const MotionItems items = trial.draw(batch);
    const Eigen::MatrixXd before = trial.to_cartesian(states_of(items));
    const DerivativeEstimate rates = rates_at_once(trial, items, before);
    for (Eigen::Index i = 0; i < batch; ++i)
        for (std::size_t axis = 0; axis < components.velocities.size(); ++axis) {
            const int p = components.positions[axis], v = components.velocities[axis];
            const double said = before(v, i), found = rates.value(p, i);
            // A millionth, for motions that integrate.
            const double allowed =
                3 * rates.uncertainty(p, i) + 1e-6 * std::fabs(said) + 1e-8 * trial.cartesian_scales(v);
            if (!(std::fabs(said - found) <= allowed))
                FAIL(
                    fmt::format("propagate: {} changes by {:.9g} m/s as dt becomes 0 (within {:.1g}), {} is {:.9g} m/s "
                                "in the state {}; is a term of the velocity left out or scaled?",
                                trial.cartesian[p].name, found, allowed, trial.cartesian[v].name, said,
                                text_of(states_of(items).col(i))));
        }
}

PELORUS_CHECK(motion, "motion-refuses-backward-steps", 2,
              "Without BACKWARD, dt < 0 is refused by PLR_E_UNSUPPORTED for its item alone, by every call that takes a "
              "dt; a belated scan must not be filtered by a step that means nothing.",
              {"item-statuses-agree", "same-bytes-again"}) {
    MotionTrial trial(bench);
    if (trial.has(PLR_MOTION_BACKWARD)) skip("says BACKWARD");
    const MotionItems items = trial.draw(3);
    const Eigen::VectorXd forward = trial.drawn_steps(3);
    Eigen::VectorXd dt = forward;
    dt(1) = -dt(1);
    using namespace motion_calls;
    const auto calls_with = [&](const Eigen::VectorXd& step) {
        const Argument predicted = columns("predicted", trial.propagate(forward, items));
        std::vector<HotCall> calls{
            motion_calls::propagate(*trial.instance, steps(step), items.state, items.record, absent("mean")),
            motion_calls::jacobian(*trial.instance, steps(step), items.state, items.record, absent("mean")),
            motion_calls::noise(*trial.instance, steps(step), items.state, items.covariance, predicted, items.extent,
                                items.record)};
        if (trial.instance->extension<plr_motion_noise_factor>(PLR_MOTION_NOISE_FACTOR) != nullptr)
            calls.push_back(noise_factor(*trial.instance, steps(step), items.state, items.covariance, predicted,
                                         items.extent, items.record));
        return calls;
    };
    const std::vector<HotCall> well = calls_with(forward), partly = calls_with(dt);
    for (std::size_t c = 0; c < well.size(); ++c) {
        INFO(well[c].function << " with dt = " << text_of(dt) << " s");
        const Execution all = execute_well(*trial.instance, well[c]), some = execute(*trial.instance, partly[c]);
        if (some.status != PLR_ITEMS_FAILED || some.items[1] != PLR_E_UNSUPPORTED)
            FAIL("item 1 must be refused with PLR_E_UNSUPPORTED and the call answer PLR_ITEMS_FAILED; it answered "
                 << some.told() << ", its item " << some.items[1]);
        for (const std::int64_t other : {0, 2}) {
            std::string difference;
            if (!same_item(well[c], all, other, partly[c], some, other, difference))
                FAIL("the refusal of item 1 reaches another: " << difference);
        }
    }
    if (trial.instance->extension<plr_motion_structure>(PLR_MOTION_STRUCTURE) == nullptr) return;
    const Execution done = execute(*trial.instance, blocks(*trial.instance, -1.0));
    if (done.status != PLR_E_UNSUPPORTED)
        FAIL("structure.blocks with dt = -1 s answered " << done.told() << ", expected PLR_E_UNSUPPORTED");
}

}  // namespace pelorus::conformance
