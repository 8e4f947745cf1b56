// What holds for every motion plugin, whatever its model: to be called within a test case.
#pragma once

#include "plugin_instance.hpp"

#include <catch2/catch.hpp>
#include <pelorus/small_matrix.hpp>

namespace test_support {

/// Answers of a motion for one item.
class MotionUnderTest {
public:
    explicit MotionUnderTest(const Instance& instance)
        : part_(instance.as<pelorus::MotionPart>()), n_(static_cast<std::int64_t>(part_.info().state->size)) {}

    std::int64_t size() const noexcept { return n_; }
    std::uint32_t flags() const noexcept { return part_.info().flags; }
    const pelorus::MotionPart& part() const noexcept { return part_; }
    const plr_component& component(std::size_t i) const { return part_.info().state->components[i]; }
    const plr_motion_structure* structure() const {
        return part_.extension<plr_motion_structure>(PLR_MOTION_STRUCTURE);
    }

    plr_status try_propagate(double dt, const Eigen::VectorXd& x, Eigen::VectorXd& out, Call& call) const {
        auto args = pelorus::arguments<plr_motion_propagate>();
        args.dt = pelorus::const_view(&dt, 1, 1, 1);
        args.state = pelorus::const_view(x.data(), n_, 1, 1);
        out.resize(n_);
        args.out = pelorus::view(out.data(), n_, 1, 1);
        return part_.call(&plr_motion::propagate, call, args);
    }
    Eigen::VectorXd propagate(double dt, const Eigen::VectorXd& x) const {
        Call call;
        Eigen::VectorXd out;
        if (try_propagate(dt, x, out, call) != PLR_OK) throw std::runtime_error(call.message());
        return out;
    }
    Eigen::MatrixXd jacobian(double dt) const {
        Call call;
        const Eigen::VectorXd x = Eigen::VectorXd::Zero(n_);
        Eigen::MatrixXd out(n_, n_);
        auto args = pelorus::arguments<plr_motion_jacobian>();
        args.dt = pelorus::const_view(&dt, 1, 1, 1);
        args.state = pelorus::const_view(x.data(), n_, 1, 1);
        args.out = pelorus::view(out.data(), n_, n_, 1);
        if (part_.call(&plr_motion::jacobian, call, args) != PLR_OK) throw std::runtime_error(call.message());
        return out;
    }
    Eigen::MatrixXd noise(double dt) const {
        Call call;
        Eigen::MatrixXd out(n_, n_);
        auto args = pelorus::arguments<plr_motion_noise>();
        args.dt = pelorus::const_view(&dt, 1, 1, 1);
        args.out = pelorus::view(out.data(), n_, n_, 1);
        if (part_.call(&plr_motion::noise, call, args) != PLR_OK) throw std::runtime_error(call.message());
        return out;
    }
    /// G of the noise factor extension; empty where it is not offered.
    Eigen::MatrixXd factor(double dt) const {
        const auto* const extension = part_.extension<plr_motion_noise_factor>(PLR_MOTION_NOISE_FACTOR);
        if (extension == nullptr) return {};
        Call call;
        Eigen::MatrixXd out(n_, extension->columns);
        auto args = pelorus::arguments<plr_motion_noise>();
        args.dt = pelorus::const_view(&dt, 1, 1, 1);
        args.out = pelorus::view(out.data(), n_, extension->columns, 1);
        if (extension->factor(part_.self(), &static_cast<const plr_call&>(call), &args) != PLR_OK)
            throw std::runtime_error(call.message());
        return out;
    }

private:
    pelorus::MotionPart part_;
    std::int64_t n_;
};

inline double relative_difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    if (a.rows() != b.rows() || a.cols() != b.cols()) return std::numeric_limits<double>::infinity();
    return (a - b).cwiseAbs().maxCoeff() / std::max(1e-300, b.cwiseAbs().maxCoeff());
}

/// Checks what the flags and extensions of a linear motion promise, for steps a and b (s, > 0).
inline void check_linear_motion(const MotionUnderTest& motion, double a, double b) {
    const std::int64_t n = motion.size();
    REQUIRE((motion.flags() & PLR_MOTION_LINEAR) != 0);
    const Eigen::MatrixXd fa = motion.jacobian(a), fb = motion.jacobian(b), qa = motion.noise(a), qb = motion.noise(b);
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(n, -3.0, 7.0);
    CHECK(relative_difference(motion.propagate(a, x), fa * x) < 1e-15);
    CHECK(qa == qa.transpose());
    const Eigen::VectorXd scale = qa.diagonal().cwiseSqrt().cwiseMax(1e-150).cwiseInverse();
    pelorus::small::Bounded<12, 12> correlation = scale.asDiagonal() * qa * scale.asDiagonal(), factor = correlation;
    CHECK(pelorus::small::cholesky_semidefinite(correlation, factor));

    const bool invariant = relative_difference(fb * fa, motion.jacobian(a + b)) < 1e-13;
    CHECK(invariant == ((motion.flags() & PLR_MOTION_TIME_INVARIANT) != 0));
    const bool exact = relative_difference(fb * qa * fb.transpose() + qb, motion.noise(a + b)) < 1e-13;
    CHECK(exact == ((motion.flags() & PLR_MOTION_EXACT_NOISE) != 0));
    if ((motion.flags() & PLR_MOTION_BACKWARD) != 0) {
        const Eigen::MatrixXd back = motion.jacobian(-a);
        CHECK(relative_difference(back * fa, Eigen::MatrixXd::Identity(n, n)) < 1e-13);
        CHECK(relative_difference(motion.noise(-a), back * qa * back.transpose()) < 1e-12);
    } else {
        Call call;
        Eigen::VectorXd out;
        CHECK(motion.try_propagate(-a, x, out, call) == PLR_ITEMS_FAILED);
        CHECK(call.status() == PLR_E_UNSUPPORTED);
    }

    if (const Eigen::MatrixXd g = motion.factor(a); g.size() > 0)
        CHECK(relative_difference(g * g.transpose(), qa) < 1e-14);
    if (const plr_motion_structure* const structure = motion.structure(); structure != nullptr) {
        const int block = structure->block, axes = structure->dimension;
        REQUIRE(block * axes == n);
        Call call;
        Eigen::MatrixXd f1(block, block), q1(block, block);
        REQUIRE(structure->blocks(motion.part().self(), &static_cast<const plr_call&>(call), a, f1.data(), q1.data()) ==
                PLR_OK);
        Eigen::MatrixXd f = Eigen::MatrixXd::Zero(n, n), q = f;
        for (int r = 0; r < block; ++r) {
            for (int c = 0; c < block; ++c) {
                f.block(r * axes, c * axes, axes, axes).diagonal().setConstant(f1(r, c));
                q.block(r * axes, c * axes, axes, axes).diagonal().setConstant(q1(r, c));
            }
        }
        CHECK(f == fa);
        CHECK(q == qa);
    }
}

}  // namespace test_support
