/// A motion on the bench: its calls as functions of matrices, an item a column.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <pelorus/space.hpp>

#include "call_matrices.hpp"
#include "machine/bench.hpp"
#include "motion_calls.hpp"

namespace pelorus::conformance {

/// Items with all that the calls of a motion may ask of them.
struct MotionItems {
    Argument state, covariance, record, extent;
    std::int64_t count = 0;
    /// One of them, so many times over.
    MotionItems copies(std::int64_t item, std::int64_t times) const;
};

class MotionTrial {
public:
    explicit MotionTrial(const Bench& bench, std::uint64_t stream = 0);

    bool has(unsigned flag) const noexcept { return (info.flags & flag) != 0; }
    MotionItems draw(std::int64_t count);
    /// Seconds, forward.
    Eigen::VectorXd drawn_steps(std::int64_t count);
    /// Items of these states, an item a column.
    MotionItems items_at(const Eigen::MatrixXd& states);

    Eigen::MatrixXd propagate(const Eigen::VectorXd& dt, const MotionItems& items) const;
    /// The same from other states, the records those of the items.
    Eigen::MatrixXd propagate(const Eigen::VectorXd& dt, const Eigen::MatrixXd& states, const MotionItems& items) const;
    /// States in the Cartesian space, an item a column.
    Eigen::MatrixXd to_cartesian(const Eigen::MatrixXd& states) const;
    std::vector<Eigen::MatrixXd> jacobian(const Eigen::VectorXd& dt, const MotionItems& items) const;
    std::vector<Eigen::MatrixXd> jacobian(const Eigen::VectorXd& dt, const Eigen::MatrixXd& states,
                                          const MotionItems& items) const;
    std::vector<Eigen::MatrixXd> noise(const Eigen::VectorXd& dt, const MotionItems& items) const;
    HotCall noise_call(const Eigen::VectorXd& dt, const MotionItems& items) const;

    std::unique_ptr<Instance> instance;
    const plr_motion& table;
    const plr_motion_info& info;
    Space state, cartesian;
    Eigen::VectorXd scales, cartesian_scales;
    Sample sample;
    Eigen::Index n;
};

Argument steps(const Eigen::VectorXd& dt);
/// The states of items, a column each.
Eigen::MatrixXd states_of(const MotionItems& items);

}  // namespace pelorus::conformance
