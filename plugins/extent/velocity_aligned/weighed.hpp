/// extent.velocity_aligned, weighing `covariance`: scatter that turns with the velocity, as far as its direction is known. See
/// README.md.
#pragma once

#include <limits>

#include "aligned.hpp"

namespace velocity_aligned {

template <int D> struct Weighed {
    using Shape = InverseWishart<D>;

    /// Sums over the scans, forgotten by and by: of n - 1, of the scatter turned with the velocity, of (n - 1) R; then the
    /// weight of what they say, the direction of the newest velocity (zero: none yet).
    struct Memory {
        static constexpr int size = 2 + 2 * D * D + D;
        double numbers[size] = {};
        double& freedoms() { return numbers[0]; }
        double& weight() { return numbers[1]; }
        Eigen::Map<Matrix<D>> scatter() { return Eigen::Map<Matrix<D>>(numbers + 2); }
        Eigen::Map<Matrix<D>> noise() { return Eigen::Map<Matrix<D>>(numbers + 2 + D * D); }
        Eigen::Map<Vector<D>> direction() { return Eigen::Map<Vector<D>>(numbers + 2 + 2 * D * D); }

        void add(double share, const Scatter<D>& scan) {
            if (!(scan.number > 1)) return;
            freedoms() += share * (scan.number - 1);
            scatter() += share * scan.sum;
            noise() += share * (scan.number - 1) * scan.noise;
        }
        /// G; nothing before the first scan.
        std::optional<Matrix<D>> turned(double lambda) {
            if (!(freedoms() > 0)) return std::nullopt;
            const Matrix<D> spread = scatter() / freedoms();
            const Matrix<D> clean = with_floor<D>(spread - noise() / freedoms(), least_axis(spread));
            return Matrix<D>(rounded(clean, spread) / lambda);
        }
        /// What the noise leaves of an axis may be nothing; then it is as thin as chance may have it: by one standard deviation
        /// of the scatter's least eigenvalue.
        double least_axis(const Matrix<D>& spread) {
            Vector<D> values;
            Matrix<D> vectors;
            if (!pelorus::small::symmetric_eigen(spread, values, vectors))
                throw pelorus::NumericError("the scatter of the points is not finite");
            return std::max(values(0), 1e-6 * values(D - 1)) * std::sqrt(2 / std::max(freedoms(), 2.0));
        }
        /// Eigenvalues of a scatter are farther apart than those of the shape. Where they may be apart by chance, they are drawn
        /// to their mean: by (1.5 r)^4, at most 1, r the variance of the scatter over its distance from a sphere (after Ledoit,
        /// Wolf 2004, whose share is r; the fourth power leaves a shape alone that is clearly no sphere).
        Matrix<D> rounded(const Matrix<D>& clean, const Matrix<D>& spread) {
            const Matrix<D> sphere = Matrix<D>::Identity() * (clean.trace() / D);
            const double apart = (clean - sphere).squaredNorm();
            const double chance = (spread.trace() * spread.trace() + spread.squaredNorm()) / freedoms();
            const double share = std::min(1.0, std::pow(1.5 * chance / std::max(apart, 1e-300), 4));
            return (1 - share) * clean + share * sphere;
        }
    };

    static void start(const Parameters&, Memory&, const plr_extent_points*, std::int64_t) {}

    /// G turns as the velocity does; F as far as the turn is not chance (James, Stein): by max(0, 1 - 3 s^2/t^2) of its angle
    /// t, s^2 its variance by the covariance of the acceleration.
    static void turn(const Parameters& is, Memory& memory, const plr_extent_predict& args, std::int64_t i,
                     Shape& random) {
        const double dt = args.dt.data[i * args.dt.item_stride], kept = std::exp(-dt / is.memory);
        memory.freedoms() *= kept;
        memory.scatter() *= kept;
        memory.noise() *= kept;
        const Vector<D> before = velocity_of<D>(args.before, i), after = velocity_of<D>(args.after, i);
        const auto to = direction_of<D>(after);
        face(memory, direction_of<D>(before));
        face(memory, to);
        const auto from = direction_of<D>(before);
        if (!from || !to) return;
        const double angle = std::acos(std::min(1.0, from->dot(*to)));
        const double variance =
            direction_variance(args.before_covariance, i, 2, *from) * dt * dt / before.squaredNorm();
        const double part = angle > 0 ? std::max(0.0, 1 - 3 * variance / (angle * angle)) : 0.0;
        const Vector<D> there = *from + part * (*to - *from);
        if (const auto rotation = turn_of<D>(*from, there)) random.turn(*rotation);
    }

    static void learn(const Parameters& is, Memory& memory, const plr_extent_update& args, std::int64_t i,
                      const Scatter<D>& scatter, const Shape& random) {
        const Vector<D> velocity = velocity_of<D>(args.kinematics, i);
        const auto direction = direction_of<D>(velocity);
        face(memory, direction);
        memory.weight() = 0;
        if (!direction) return;
        const Axis axis = axis_of(is.lambda * random.extent() + scatter.noise, random.degrees - (2 * D + 2));
        const double relative =
            direction_variance(args.kinematics_covariance, i, 1, *direction) / velocity.squaredNorm();
        if (!std::isfinite(relative)) return;
        // Beyond small angles a direction is off by far more than its variance says: of a target that hardly moves.
        const double by_velocity = relative * (1 + 10 * relative);
        // Scatter that was turned by chance tells little of the shape.
        memory.add(axis.variance / (axis.variance + by_velocity), scatter);
        if (const auto turned = memory.turned(is.lambda))
            memory.weight() =
                weight(axis, by_velocity, axis_of(is.lambda * *turned + scatter.noise, memory.freedoms()));
    }

    static Matrix<D> shape_of(const Parameters& is, Memory memory, const Shape& random) {
        const auto turned = memory.turned(is.lambda);
        if (!turned || !(memory.weight() > 0)) return random.extent();
        Matrix<D> out = (1 - memory.weight()) * random.extent() + memory.weight() * *turned;
        pelorus::small::symmetrise(out);
        return out;
    }
    static Matrix<D> noise_shape_of(const Parameters& is, const Memory& memory, const Shape& random) {
        return shape_of(is, memory, random);
    }

private:
    /// Turns what has been collected to the direction of a newer velocity.
    static void face(Memory& memory, const std::optional<Vector<D>>& to) {
        if (!to) return;
        const Vector<D> from = memory.direction();
        if (from.squaredNorm() > 0.5)
            if (const auto rotation = smallest_rotation<D>(from, *to))
                for (Eigen::Map<Matrix<D>> sum : {memory.scatter(), memory.noise()}) {
                    Matrix<D> turned;
                    pelorus::small::symmetric_product(*rotation, Matrix<D>(sum), turned);
                    sum = turned;
                }
        memory.direction() = *to;
    }

    /// Mean variance across `direction` of a derivative (1: velocity, 2: acceleration); infinite where it is not known.
    static double direction_variance(const plr_const_view& covariance, std::int64_t i, int derivative,
                                     const Vector<D>& direction) {
        if (covariance.data == nullptr) return std::numeric_limits<double>::infinity();
        if (covariance.rows < (derivative + 1) * D) return 0;  // a motion without acceleration is sure of it
        const double* const at = covariance.data + i * covariance.item_stride;
        Matrix<D> block;
        for (int col = 0; col < D; ++col)
            for (int row = 0; row < D; ++row)
                block(row, col) =
                    at[(derivative * D + col) * covariance.col_stride + (derivative * D + row) * covariance.row_stride];
        const double across = (block.trace() - direction.dot(block * direction)) / (D - 1);
        if (!std::isfinite(across)) throw pelorus::NumericError("the covariance of the kinematics is not finite");
        return std::max(across, 0.0);
    }

    /// The main axis of points of that covariance, and the variance of its direction (rad^2) if there were so many:
    /// y1 y2/((y1 - y2)^2 n), y the eigenvalues.
    struct Axis {
        Vector<D> direction;
        double variance;
        double points;
    };
    static Axis axis_of(const Matrix<D>& covariance, double points) {
        Vector<D> values;
        Matrix<D> vectors;
        if (!pelorus::small::symmetric_eigen(covariance, values, vectors))
            throw pelorus::NumericError("the shape is not finite");
        double less = 0;
        for (int k = 0; k < D - 1; ++k) less += values(k) / (D - 1);
        const double apart = values(D - 1) - less;
        return {vectors.col(D - 1), std::min(values(D - 1) * less / (points * apart * apart), no_direction), points};
    }

    /// w = s_F^2/(s_F^2 + s_G^2), s_G^2 the variance of the velocity's direction, and where G is made of fewer points than F, a
    /// share of its own axis' variance. How far the two main axes are apart beyond what the variances explain is put down to
    /// the random matrix, which lags behind turns.
    static double weight(const Axis& of_random, double by_velocity, const Axis& of_turned) {
        const double apart = std::acos(std::min(1.0, std::fabs(of_random.direction.dot(of_turned.direction))));
        const double lag =
            std::max(0.0, apart * apart / (D - 1) - of_random.variance - by_velocity - of_turned.variance);
        const double known_less = of_turned.variance * std::max(0.0, 1 - of_turned.points / of_random.points);
        return (of_random.variance + lag) / (of_random.variance + lag + by_velocity + known_less);
    }

    static constexpr double no_direction = 1.3;  ///< rad^2: more than a direction can be off
};

}  // namespace velocity_aligned
