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

        void add(const Scatter<D>& scan) {
            if (!(scan.number > 1)) return;
            freedoms() += scan.number - 1;
            scatter() += scan.sum;
            noise() += (scan.number - 1) * scan.noise;
        }
    };

    static void start(const Parameters&, Memory& memory, const plr_extent_points* scan, std::int64_t i) {
        memory.add(scatter_of<D>(scan[0], i));
        memory.add(scatter_of<D>(scan[1], i));
    }

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
        memory.add(scatter);
        memory.weight() = direction ? weight(is, args, i, scatter, random, velocity) : 0.0;
    }

    static Matrix<D> shape_of(const Parameters& is, Memory memory, const Shape& random) {
        if (!(memory.weight() > 0) || !(memory.freedoms() > 0)) return random.extent();
        const Matrix<D> spread = memory.scatter() / memory.freedoms();
        const Matrix<D> turned =
            with_floor<D>(spread - memory.noise() / memory.freedoms(), 0.05 * spread.trace() / D) / is.lambda;
        Matrix<D> out = (1 - memory.weight()) * random.extent() + memory.weight() * turned;
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
            if (const auto rotation = smallest_rotation<D>(from, *to)) {
                Matrix<D> turned;
                pelorus::small::symmetric_product(*rotation, Matrix<D>(memory.scatter()), turned);
                memory.scatter() = turned;
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

    /// w = s_F^2/(s_F^2 + s_G^2): s_G^2 is the variance of the velocity's direction; s_F^2 that of the random matrix's main axis,
    /// y1 y2/((y1 - y2)^2 n) with y the eigenvalues of lambda X + R and n the points remembered, and what it lags behind by a
    /// turn that is not known.
    static double weight(const Parameters& is, const plr_extent_update& args, std::int64_t i, const Scatter<D>& scatter,
                         const Shape& random, const Vector<D>& velocity) {
        const Vector<D> u = velocity.normalized();
        const double square = velocity.squaredNorm();
        const double by_velocity = direction_variance(args.kinematics_covariance, i, 1, u) / square;
        if (!std::isfinite(by_velocity)) return 0;
        const double rate = direction_variance(args.kinematics_covariance, i, 2, u) / square;
        Vector<D> values;
        Matrix<D> vectors;
        if (!pelorus::small::symmetric_eigen(Matrix<D>(is.lambda * random.extent() + scatter.noise), values, vectors))
            throw pelorus::NumericError("the shape is not finite");
        double less = 0;
        for (int k = 0; k < D - 1; ++k) less += values(k) / (D - 1);
        const double apart = values(D - 1) - less;
        const double points = random.degrees - (2 * D + 2);
        const double information = points * apart * apart / (values(D - 1) * less);
        const double lag = is.decay > 0 ? rate / (is.decay * is.decay) : 0;
        const double by_points = 1 / information + lag;
        return information > 0 ? by_points / (by_points + by_velocity) : 1.0;
    }
};

}  // namespace velocity_aligned
