// What a motion promises of its process noise, and of its extensions.
#include <cmath>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "differences.hpp"
#include "motion_trial.hpp"

namespace pelorus::conformance {

namespace {

constexpr std::int64_t batch = 5;

/// Every row r of the small matrix on every axis.
Eigen::MatrixXd spread(const Eigen::MatrixXd& block, Eigen::Index dimension) {
    Eigen::MatrixXd full = Eigen::MatrixXd::Zero(block.rows() * dimension, block.cols() * dimension);
    for (Eigen::Index r = 0; r < block.rows(); ++r)
        for (Eigen::Index c = 0; c < block.cols(); ++c)
            full.block(r * dimension, c * dimension, dimension, dimension).diagonal().setConstant(block(r, c));
    return full;
}

/// The state before a step, but for the components that a step, however short, draws anew (their rows of F are 0, and Q says how
/// well they are known): these as they are after it.
Eigen::VectorXd without_drawn_anew(const Eigen::VectorXd& before, const Eigen::VectorXd& after,
                                   const Eigen::MatrixXd& f, const Eigen::MatrixXd& q) {
    Eigen::VectorXd expected = before;
    for (Eigen::Index r = 0; r < before.size(); ++r)
        if (f.row(r).isZero(0.0) && q(r, r) > 0) expected(r) = after(r);
    return expected;
}

}  // namespace

PELORUS_CHECK(motion, "motion-constant-noise-is-constant", 3,
              "With CONSTANT_NOISE, Q is a function of dt alone: the same for every state, covariance and predicted "
              "state, and without them; estimators do not hand them over.",
              {"numbers-finite"}) {
    MotionTrial trial(bench);
    if (!trial.has(PLR_MOTION_CONSTANT_NOISE)) skip("does not say CONSTANT_NOISE");
    const MotionItems items = trial.draw(batch);
    const Eigen::VectorXd dt = Eigen::VectorXd::Constant(batch, trial.sample.step());
    const auto given = trial.noise(dt, items);
    const auto bare = answered_matrices(
        *trial.instance, motion_calls::noise(*trial.instance, steps(dt), absent("state"), absent("covariance"),
                                             absent("predicted"), items.extent, items.record));
    for (std::size_t i = 0; i < given.size(); ++i) {
        INFO("dt = " << dt(0) << " s, state " << text_of(states_of(items).col(static_cast<Eigen::Index>(i))));
        const Eigen::MatrixXd allowed = 1e-12 * element_scales(bare[0]);
        const std::string differs = first_difference(given[i], bare[i], allowed, trial.state, trial.state);
        if (!differs.empty()) FAIL("noise: " << differs << " (without state, covariance and predicted)");
    }
}

PELORUS_CHECK(motion, "motion-noise-composes", 3,
              "With EXACT_NOISE, the noise of a step of a + b is that of a, carried on, and that of b: "
              "Q(a + b) = F(b) Q(a) F(b)' + Q(b); otherwise how certain a track is depends on how often one looks.",
              {"motion-steps-compose"}) {
    MotionTrial trial(bench);
    if (!trial.has(PLR_MOTION_EXACT_NOISE)) skip("does not say EXACT_NOISE");
    const MotionItems items = trial.draw(batch);
    const Eigen::VectorXd a = trial.drawn_steps(batch), b = trial.drawn_steps(batch);
    const auto qa = trial.noise(a, items), qb = trial.noise(b, items), qab = trial.noise(a + b, items);
    const auto fb = trial.jacobian(b, trial.propagate(a, items), items);
    for (std::size_t i = 0; i < qa.size(); ++i) {
        const Eigen::MatrixXd sum = fb[i] * qa[i] * fb[i].transpose() + qb[i];
        const Eigen::MatrixXd terms =
            element_scales(sum) + fb[i].cwiseAbs() * element_scales(qa[i]) * fb[i].cwiseAbs().transpose();
        const std::string off = first_difference(qab[i], sum, 1e-8 * terms, trial.state, trial.state);
        const auto at = static_cast<Eigen::Index>(i);
        if (!off.empty())
            FAIL("noise(a + b): " << off << " (F(b) Q(a) F(b)' + Q(b)) at a = " << a(at) << " s, b = " << b(at)
                                  << " s");
    }
}

PELORUS_CHECK(motion, "motion-steps-long-and-short", 3,
              "Steps from a nanosecond to hours are answered, a very short one moves next to nothing, and with "
              "EXACT_NOISE and CONSTANT_NOISE the noise never shrinks as the step grows; closed forms that cancel or "
              "overflow fail here.",
              {"motion-zero-step-is-identity"}) {
    MotionTrial trial(bench);
    const std::vector<double> ladder{1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1, 10, 60, 600, 3600, 1e4};
    const auto count = static_cast<std::int64_t>(ladder.size());
    const MotionItems items = trial.draw(1).copies(0, count);
    const Eigen::VectorXd dt = Eigen::Map<const Eigen::VectorXd>(ladder.data(), count);
    const Eigen::VectorXd x = states_of(items).col(0);
    HotCall moved = motion_calls::propagate(*trial.instance, steps(dt), items.state, items.record, absent("mean"));
    HotCall turned = motion_calls::jacobian(*trial.instance, steps(dt), items.state, items.record, absent("mean"));
    // What is too long for the doubles of an unstable motion may be refused, item by item.
    moved.may_refuse = turned.may_refuse = true;
    const Execution after = execute_well(*trial.instance, moved);
    HotCall spread = motion_calls::noise(*trial.instance, steps(dt), items.state, items.covariance,
                                         renamed(items.state, "predicted"), items.extent, items.record);
    spread.may_refuse = true;
    const Execution noises = execute_well(*trial.instance, spread);
    const Execution jacobians = execute_well(*trial.instance, turned);
    const std::pair<const HotCall*, const Execution*> all[] = {
        {&moved, &after}, {&turned, &jacobians}, {&spread, &noises}};
    constexpr double always = 60;  // s: up to here every motion answers
    for (const auto& [call, done] : all)
        for (std::int64_t i = 0; i < count; ++i) {
            const double step = ladder[static_cast<std::size_t>(i)];
            if (done->failed(i) && step <= always)
                FAIL(call->function << " refuses dt = " << step << " s: " << done->told());
            if (done->failed(i)) continue;
            for (const double value : HotCall::item_of(call->out[0], done->out[0], i))
                if (!std::isfinite(value)) FAIL(call->function << " answers " << value << " at dt = " << step << " s");
        }
    for (std::int64_t i = 0; i < count && ladder[static_cast<std::size_t>(i)] <= 1e-6; ++i) {
        const auto values = HotCall::item_of(moved.out[0], after.out[0], i);
        // A microsecond moves a component by no more than a thousandth of its scale: a rate of a thousand scales a second.
        const std::string jump = first_difference(
            Eigen::Map<const Eigen::VectorXd>(values.data(), trial.n),
            without_drawn_anew(x, Eigen::Map<const Eigen::VectorXd>(values.data(), trial.n),
                               item_matrix(turned, jacobians, 0, i), item_matrix(spread, noises, 0, i)),
            Eigen::VectorXd(1e-3 * trial.scales + 1e-12 * x.cwiseAbs()), trial.state);
        if (!jump.empty())
            FAIL("propagate: " << jump << " at dt = " << ladder[static_cast<std::size_t>(i)] << " s: it jumps");
    }
    if (!trial.has(PLR_MOTION_EXACT_NOISE) || !trial.has(PLR_MOTION_CONSTANT_NOISE)) return;
    // Q(b) - Q(a) = F(a) Q(b - a) F(a)' has no negative variance, for a < b. (F(a) and F(b - a) commute.)
    for (std::int64_t i = 1; i < count; ++i) {
        if (noises.failed(i) || noises.failed(i - 1)) continue;
        const auto shorter = HotCall::item_of(spread.out[0], noises.out[0], i - 1),
                   longer = HotCall::item_of(spread.out[0], noises.out[0], i);
        for (Eigen::Index r = 0; r < trial.n; ++r) {
            const auto at = static_cast<std::size_t>(r * trial.n + r);
            if (longer[at] < shorter[at] * (1 - 1e-9) || shorter[at] < 0)
                FAIL(fmt::format("noise: the variance of {} is {:.9g} at dt = {:g} s and {:.9g} at dt = {:g} s",
                                 trial.state[static_cast<int>(r)].name, shorter[at],
                                 ladder[static_cast<std::size_t>(i - 1)], longer[at],
                                 ladder[static_cast<std::size_t>(i)]));
        }
    }
}

PELORUS_CHECK(
    motion, "motion-structure-agrees", 3,
    "The extension's small matrices, spread over the axes, are what jacobian and noise answer; estimators use "
    "them instead.",
    {"motion-linear-means-linear", "motion-constant-noise-is-constant"}) {
    MotionTrial trial(bench);
    const auto* structure = trial.instance->extension<plr_motion_structure>(PLR_MOTION_STRUCTURE);
    if (structure == nullptr) skip(std::string("does not offer ") + PLR_MOTION_STRUCTURE);
    if (std::int64_t{structure->block} * structure->dimension != trial.n) skip("its sizes do not fit the state");
    const MotionItems items = trial.draw(batch);
    Eigen::VectorXd dt = trial.drawn_steps(batch);
    if (trial.has(PLR_MOTION_BACKWARD)) dt(batch - 1) = -dt(batch - 1);
    const auto f = trial.jacobian(dt, items), q = trial.noise(dt, items);
    for (Eigen::Index i = 0; i < batch; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const Execution done = execute_well(*trial.instance, motion_calls::blocks(*trial.instance, dt(i)));
        const Eigen::Index b = structure->block;
        const Eigen::MatrixXd f1 = Eigen::Map<const Eigen::MatrixXd>(done.out[0].data(), b, b),
                              q1 = Eigen::Map<const Eigen::MatrixXd>(done.out[1].data(), b, b);
        const std::string mean = first_difference(spread(f1, structure->dimension), f[at], 1e-13 * f[at].cwiseAbs(),
                                                  trial.state, trial.state);
        if (!mean.empty()) FAIL("structure.blocks: F1 (x) I: " << mean << " (jacobian) at dt = " << dt(i) << " s");
        const std::string noise = first_difference(spread(q1, structure->dimension), q[at],
                                                   1e-13 * element_scales(q[at]), trial.state, trial.state);
        if (!noise.empty()) FAIL("structure.blocks: Q1 (x) I: " << noise << " (noise) at dt = " << dt(i) << " s");
    }
}

PELORUS_CHECK(motion, "motion-noise-factor-agrees", 3,
              "The extension's factor G of the noise has G G' = Q; square-root filters use it instead.",
              {"numbers-finite"}) {
    MotionTrial trial(bench);
    const auto* factor = trial.instance->extension<plr_motion_noise_factor>(PLR_MOTION_NOISE_FACTOR);
    if (factor == nullptr) skip(std::string("does not offer ") + PLR_MOTION_NOISE_FACTOR);
    if (factor->columns < 1 || factor->columns > trial.n) skip("its size does not fit the state");
    const MotionItems items = trial.draw(batch);
    Eigen::VectorXd dt = trial.drawn_steps(batch);
    if (trial.has(PLR_MOTION_BACKWARD)) dt(batch - 1) = -dt(batch - 1);
    const auto q = trial.noise(dt, items);
    const auto g = answered_matrices(
        *trial.instance,
        motion_calls::noise_factor(*trial.instance, steps(dt), items.state, items.covariance,
                                   columns("predicted", trial.propagate(dt, items)), items.extent, items.record));
    for (std::size_t i = 0; i < q.size(); ++i) {
        const std::string off =
            first_difference(g[i] * g[i].transpose(), q[i], 1e-10 * element_scales(q[i]), trial.state, trial.state);
        if (!off.empty())
            FAIL("noise_factor.factor: G G': " << off << " (noise) at dt = " << dt(static_cast<Eigen::Index>(i))
                                               << " s");
    }
}

}  // namespace pelorus::conformance
