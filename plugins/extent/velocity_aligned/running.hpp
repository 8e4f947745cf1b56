/// extent.velocity_aligned, weighing `none`: the main axis is the direction of the velocity. See README.md.
#pragma once

#include "aligned.hpp"

namespace velocity_aligned {

template <int D> struct Running {
    using Shape = InverseWishart<D>;

    /// Scans, and sums over them of the points' mean squares along and across the velocity (m^2), of the sensor's noise in
    /// these directions, and the direction of the newest velocity.
    struct Memory {
        static constexpr int size = 5 + D;
        double numbers[size] = {};
        double& scans() { return numbers[0]; }
        double& along() { return numbers[1]; }
        double& across() { return numbers[2]; }
        double& noise_along() { return numbers[3]; }
        double& noise_across() { return numbers[4]; }
        Eigen::Map<Vector<D>> direction() { return Eigen::Map<Vector<D>>(numbers + 5); }
    };

    static void start(const Parameters&, Memory&, const plr_extent_points*, std::int64_t) {}

    static void turn(const Parameters&, Memory& memory, const plr_extent_predict& args, std::int64_t i, const Shape&) {
        if (const auto direction = direction_of<D>(velocity_of<D>(args.after, i))) memory.direction() = *direction;
    }

    static void learn(const Parameters& is, Memory& memory, const plr_extent_update& args, std::int64_t i,
                      const Scatter<D>& scatter, const Shape& random) {
        const auto direction = direction_of<D>(velocity_of<D>(args.kinematics, i));
        if (direction) memory.direction() = *direction;
        // Half the nanosecond to which times are told.
        if (!direction || scatter.number < 2 || random.age < is.align_after - 0.5e-9) return;
        const Matrix<D> mean = scatter.sum / (scatter.number - 1);
        const double along = direction->dot(mean * *direction), noise = direction->dot(scatter.noise * *direction);
        memory.scans() += 1;
        memory.along() += along;
        memory.across() += (mean.trace() - along) / (D - 1);
        memory.noise_along() += noise;
        memory.noise_across() += (scatter.noise.trace() - noise) / (D - 1);
    }

    static Matrix<D> shape_of(const Parameters& is, Memory memory, const Shape& random) {
        if (!(memory.scans() > 0)) return random.extent();
        const Vector<D> u = memory.direction();
        const double along = std::max((memory.along() - memory.noise_along()) / memory.scans(), least_square),
                     across = std::max((memory.across() - memory.noise_across()) / memory.scans(), least_square);
        Matrix<D> out = Matrix<D>::Identity() * (across / is.lambda);
        pelorus::small::add_outer((along - across) / is.lambda, u, out);
        return out;
    }
    static Matrix<D> noise_shape_of(const Parameters&, const Memory&, const Shape& random) { return random.extent(); }

private:
    static constexpr double least_square = 0.1;  // m^2
};

}  // namespace velocity_aligned
