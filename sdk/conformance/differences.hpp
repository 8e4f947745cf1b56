/// Derivatives by differences, with a bound of their own error, and how a Jacobian that disagrees is told.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <pelorus/space.hpp>

namespace pelorus::conformance {

struct DerivativeEstimate {
    Eigen::MatrixXd value;
    Eigen::MatrixXd
        uncertainty;  ///< truncation and rounding, from the spread of several step lengths; infinite: unknown
};

/// Central differences of a function about x with steps from an eighth of each component's scale down to some millionths.
class Differences {
public:
    Differences(const Eigen::VectorXd& x, const Eigen::VectorXd& scales);

    /// Where the function is wanted, a point a column.
    const Eigen::MatrixXd& points() const noexcept { return points_; }
    /// From its values there; NaN where it is not defined. Differences of components that are angles are wrapped.
    DerivativeEstimate estimate(const Eigen::MatrixXd& values, const Space& space) const;

private:
    static constexpr int steps = 16;
    Eigen::Index column(Eigen::Index component, int step, int side) const noexcept {
        return (component * steps + step) * 2 + side;
    }
    Eigen::VectorXd x_, scales_;
    Eigen::MatrixXd points_;
};

/// Compares a Jacobian with differences: the element that is furthest off, by component names, with what might have gone wrong;
/// "" where all agree to a millionth and to the differences' own uncertainty. An element that is not finite disagrees with anything;
/// one whose differences are not known is told by a note.
std::string disagreement(const Eigen::MatrixXd& jacobian, const DerivativeEstimate& differences, const Space& of,
                         const Space& by, const Eigen::VectorXd& scales_of, const Eigen::VectorXd& scales_by);

/// `[1, -2.5]`
std::string text_of(const Eigen::VectorXd& vector);
/// one - other, components that are angles wrapped.
Eigen::VectorXd difference_in(const Space& space, const Eigen::VectorXd& one, const Eigen::VectorXd& other);

}  // namespace pelorus::conformance
