/// A batch of measurements as positions: without bias, and with covariances that may be those at the predicted places.
///
/// A sensor's `invert` tells the covariance of a converted measurement's error as if the object were where the measurement says. Such
/// a covariance depends on the error itself: of two measurements, the one that is wrong towards the sensor looks the surer one, so that
/// a filter that weighs by it is drawn there. Evaluated where the object is predicted to be, it knows nothing of the error:
///     R = E Var(c(z) | x),   x ~ N(prediction),   Var(c(z) | x) = what `invert` tells at h(x)
/// which, c being unbiased, is the covariance of c(z) - x that the best linear estimate asks for. The mean over x is the third-degree
/// cubature over 2d points: exact for the terms that go with the square of a coordinate, as r^2 sigma^2 does.
/// Source: S. Bordonaro, P. Willett, Y. Bar-Shalom, Decorrelated unbiased converted measurement Kalman filter, IEEE Transactions on
/// Aerospace and Electronic Systems 50(2), 1431-1444, 2014 (for polar and spherical measurements; there in closed form).
#pragma once

#include <cmath>

#include <pelorus/small_matrix.hpp>

#include "../batches/batches.hpp"

namespace sensing {

/// Where the covariance of a converted measurement is evaluated.
enum class Conversion { predicted, measured };

/// Converts what a sensor measures into what its `invert` tells: d components, all that it looks at. All functions are [hot].
class Converter {
public:
    static constexpr int most = 6;  ///< components of a measurement

    Converter() = default;
    /// The sensor must be one that `fits`.
    explicit Converter(const pelorus::SensorPart& sensor) : sensor_(sensor), d_(sensor.info().inverse->size) {}

    /// Whether a measurement tells all that the sensor looks at, and nothing besides.
    static bool fits(const pelorus::SensorPart& sensor) {
        const plr_sensor_info& info = sensor.info();
        return (info.flags & PLR_SENSOR_CAN_INVERT) != 0 && info.inverse != nullptr && info.inverse->size <= most &&
               info.inverse->size == info.measurement->size &&
               pelorus::Space(*info.inverse).same(pelorus::Space(*info.cartesian));
    }

    std::int64_t size() const noexcept { return d_; }
    /// Doubles that `convert` needs for each item of a block.
    std::int64_t doubles() const noexcept { return 3 * d_ + 2 * d_ * d_; }

    struct Given {
        plr_const_view measurement, noise;  ///< d x 1 x N, and its covariance d x d x N, in the sensor's units
        plr_const_view place, spread;       ///< d x 1 x N, d x d x N: the prediction of what the sensor looks at
    };
    /// Into `mean`, d x 1 x N, and `covariance`, d x d x N, of what the sensor looks at. `memory` holds N doubles().
    void convert(const plr_call& call, Conversion at, const Given& given, const plr_view& mean,
                 const plr_view& covariance, double* memory) const {
        invert(call, given.measurement, given.noise, mean,
               at == Conversion::measured ? covariance : pelorus::absent_output());
        if (at == Conversion::predicted) average(call, given, covariance, memory);
    }

private:
    void invert(const plr_call& call, const plr_const_view& measurement, const plr_const_view& noise,
                const plr_view& mean, const plr_view& covariance) const {
        auto args = pelorus::arguments<plr_sensor_invert>();
        args.measurement = measurement;
        args.noise = noise;
        args.mean = mean;
        args.covariance = covariance;
        batches::tolerate(sensor_.call(&plr_sensor::invert, call, args));
    }

    void average(const plr_call& call, const Given& given, const plr_view& covariance, double* memory) const {
        const std::int64_t count = given.place.count, area = d_ * d_;
        const plr_view points = pelorus::view(memory, d_, 1, count),
                       seen = pelorus::view(memory + d_ * count, d_, 1, count),
                       told = pelorus::view(memory + 2 * d_ * count, d_, 1, count),
                       one = pelorus::view(memory + 3 * d_ * count, d_, d_, count),
                       roots = pelorus::view(memory + (3 * d_ + area) * count, d_, d_, count);
        factorise(call, given.spread, roots);
        for (std::int64_t i = 0; i < count; ++i) std::fill_n(batches::at(covariance, i), area, 0.0);
        const double reach = std::sqrt(static_cast<double>(d_)), weight = 0.5 / static_cast<double>(d_);
        for (std::int64_t p = 0; p < 2 * d_; ++p) {
            const double along = p % 2 == 0 ? reach : -reach;
            for (std::int64_t i = 0; i < count; ++i) {
                const double *const place = batches::at(given.place, i), *const step =
                                                                             batches::at(roots, i) + p / 2 * d_;
                for (std::int64_t r = 0; r < d_; ++r) batches::at(points, i)[r] = place[r] + along * step[r];
            }
            auto measure = pelorus::arguments<plr_sensor_measure>();
            measure.cartesian = pelorus::as_const(points);
            measure.out = seen;
            batches::tolerate(sensor_.call(&plr_sensor::measure, call, measure));
            invert(call, pelorus::as_const(seen), given.noise, told, one);
            for (std::int64_t i = 0; i < count; ++i)
                for (std::int64_t e = 0; e < area; ++e)
                    batches::at(covariance, i)[e] += weight * batches::at(one, i)[e];
        }
    }

    void factorise(const plr_call& call, const plr_const_view& spread, const plr_view& roots) const {
        batches::tolerate(batches::for_good_items(call, roots.count, [&](std::int64_t i) {
            using Square = pelorus::small::Bounded<most, most>;
            Square root = Eigen::Map<const Eigen::MatrixXd>(batches::at(spread, i), d_, d_);
            const bool is_good = pelorus::small::cholesky_semidefinite(root, root);
            if (!is_good) root.setZero();  // the item has failed, but is still asked for
            std::copy_n(root.data(), d_ * d_, batches::at(roots, i));
            if (!is_good)
                throw pelorus::NumericError(
                    "the predicted covariance of what the sensor looks at is not finite, or "
                    "not positive semidefinite");
        }));
    }

    pelorus::SensorPart sensor_;
    std::int64_t d_ = 0;
};

}  // namespace sensing
