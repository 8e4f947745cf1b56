/// A Gaussian filter that looks at its motion and its sensors at points of the state's distribution: the engine of the
/// cubature, the unscented and the Gauss-Hermite filter, which differ in their rule.
///
/// A step, with S the triangular factor of P (held by the record, or found by Cholesky where it holds P):
///     predict  points x + S xi through the motion; G, E, u of their regression; P = G G' + E E' - u u' + Q
///     update   new points of the predicted moments through the sensor; the same, with R; K = S G' (G G' + E E' - u u' + R)^-1
/// Where the motion is linear, F S is G and there are no residuals. A sensor is asked for points that differ in what it looks at:
/// S is triangular, so that points along later axes are the centre to it.
#pragma once

#include "factor_filter.hpp"
#include "point_rule.hpp"

namespace gaussian {

/// The order of the state's components in which a covariance is factored, and so where points lie on its ellipsoid.
enum class ComponentOrder {
    state,  // as the state has them: positions, velocities, accelerations
    axes    // axis by axis: position.x, velocity.x, acceleration.x, position.y, ...; last those of no axis
};

class PointFilter : public FactorFilter {
public:
    static constexpr std::int64_t max_points = 1024;

    plr_status predict(const plr_call& call, const plr_estimator_predict& args) const;
    plr_status project(const plr_call& call, const plr_estimator_project& args) const;
    plr_status update(const plr_call& call, const plr_estimator_update& args) const;

protected:
    /// After setup_filter. Completes `info`.
    void setup_points(const PointRule& rule, ComponentOrder order, plr_estimator_info& info);

private:
    /// What a sensor of the slot needs.
    struct Looker {
        PointRule rule;
        std::vector<int> rows;  // of the points: the state's components that it looks at, or all
        lanes::ByItems<RegressionKernel> regress{};
        lanes::ByItems<LookKernels> look{};
        std::vector<int> angles;  // of its measurement
        bool is_linear = false;   // and so is the way from the state to it
        std::int64_t items = 0;   // in a block
    };
    /// What it sees of a block of records; and what is wanted besides.
    struct Sight {
        plr_view predicted;  // m x 1 x N
        double* factors = nullptr;
        Image image{};
        plr_view cartesian_cross{};  // c x m x N, or data NULL
    };
    Looker looker_of(const SensorInSlot& sensor) const;
    std::int64_t look_doubles(std::size_t sensor) const noexcept;
    plr_status predict_points(const plr_call& call, const plr_estimator_predict& args) const;
    /// Points of a block of records, made of their factors, which are kept.
    void place(const plr_call& call, const PointRule& rule, const std::vector<int>& rows, const plr_const_view& records,
               double* factors, const plr_view& out) const;
    void look(const plr_call& call, std::size_t sensor, const plr_const_view& records, Sight& sight,
              double* memory) const;
    /// Where a sensor's points lie for it and, where the state is not Cartesian, all of their Cartesian components.
    struct Seen {
        plr_view points;  // c of the sensor x p x N
        plr_const_view cartesian;
    };
    Seen see_points(const plr_call& call, std::size_t sensor, const plr_const_view& records, double* factors,
                    double* memory) const;
    void add_cartesian_cross(const PointRule& rule, const double* cartesian, const double* values, std::int64_t m,
                             double* out) const noexcept;

    PointRule rule_;
    std::vector<Looker> lookers_;  // of the sensors
    std::vector<int> all_rows_;    // 0, 1, ..., n - 1
    std::vector<int> order_;       // in which covariances are factored; empty: as the state has its components
    lanes::ByItems<RegressionKernel> regress_{};
    std::int64_t items_ = 0;  // of a block of predictions by points
};

}  // namespace gaussian
