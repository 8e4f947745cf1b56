// Answers of a motion that is not linear, at a state.
#pragma once

#include "motion_checks.hpp"

#include <functional>

#include <pelorus/sensor.hpp>

namespace test_support {

class MotionAt {
public:
    explicit MotionAt(const Instance& instance)
        : part_(instance.as<pelorus::MotionPart>()),
          n_(static_cast<std::int64_t>(part_.info().state->size)),
          c_(static_cast<std::int64_t>(part_.info().cartesian->size)) {}

    std::int64_t size() const noexcept { return n_; }

    Eigen::VectorXd propagate(double dt, const Eigen::VectorXd& x) const {
        auto args = pelorus::arguments<plr_motion_propagate>();
        args.dt = pelorus::const_view(&dt, 1, 1, 1);
        args.state = pelorus::const_view(x.data(), n_, 1, 1);
        Eigen::VectorXd out(n_);
        args.out = pelorus::view(out.data(), n_, 1, 1);
        answer(&plr_motion::propagate, args);
        return out;
    }
    Eigen::MatrixXd jacobian(double dt, const Eigen::VectorXd& x) const {
        auto args = pelorus::arguments<plr_motion_jacobian>();
        args.dt = pelorus::const_view(&dt, 1, 1, 1);
        args.state = pelorus::const_view(x.data(), n_, 1, 1);
        Eigen::MatrixXd out(n_, n_);
        args.out = pelorus::view(out.data(), n_, n_, 1);
        answer(&plr_motion::jacobian, args);
        return out;
    }
    /// Process noise of a step from x, whose covariance is 0.
    Eigen::MatrixXd noise(double dt, const Eigen::VectorXd& x) const {
        const Eigen::VectorXd predicted = propagate(dt, x);
        const Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n_, n_);
        auto args = pelorus::arguments<plr_motion_noise>();
        args.dt = pelorus::const_view(&dt, 1, 1, 1);
        args.state = pelorus::const_view(x.data(), n_, 1, 1);
        args.predicted = pelorus::const_view(predicted.data(), n_, 1, 1);
        args.covariance = pelorus::const_view(covariance.data(), n_, n_, 1);
        Eigen::MatrixXd out(n_, n_);
        args.out = pelorus::view(out.data(), n_, n_, 1);
        answer(&plr_motion::noise, args);
        return out;
    }
    Eigen::VectorXd to_cartesian(const Eigen::VectorXd& x) const { return convert(true, x).first; }
    Eigen::VectorXd from_cartesian(const Eigen::VectorXd& x) const { return convert(false, x).first; }
    Eigen::MatrixXd to_cartesian_jacobian(const Eigen::VectorXd& x) const { return convert(true, x).second; }
    Eigen::MatrixXd from_cartesian_jacobian(const Eigen::VectorXd& x) const { return convert(false, x).second; }

    /// The Jacobian's largest difference from central ones, extrapolated, relative to the largest element of its row.
    double jacobian_error(double dt, const Eigen::VectorXd& x) const {
        return row_error(jacobian(dt, x), differences(x, *part_.info().state, *part_.info().state,
                                                      [&](const Eigen::VectorXd& at) { return propagate(dt, at); }));
    }
    /// The same of to_cartesian at x, and of from_cartesian at its answer.
    double conversion_error(const Eigen::VectorXd& x) const {
        const plr_space &state = *part_.info().state, &cartesian = *part_.info().cartesian;
        const auto [point, to] = convert(true, x);
        const Eigen::MatrixXd from = convert(false, point).second;
        return std::max(row_error(to, differences(x, state, cartesian,
                                                  [&](const Eigen::VectorXd& at) { return to_cartesian(at); })),
                        row_error(from, differences(point, cartesian, state,
                                                    [&](const Eigen::VectorXd& at) { return from_cartesian(at); })));
    }

private:
    template <class Function, class Arguments> void answer(Function function, const Arguments& args) const {
        Call call;
        if (part_.call(function, call, args) != PLR_OK) throw std::runtime_error(call.message());
    }
    std::pair<Eigen::VectorXd, Eigen::MatrixXd> convert(bool to, const Eigen::VectorXd& x) const {
        const std::int64_t rows = to ? c_ : n_, cols = to ? n_ : c_;
        auto args = pelorus::arguments<plr_motion_convert>();
        args.in = pelorus::const_view(x.data(), cols, 1, 1);
        Eigen::VectorXd out(rows);
        Eigen::MatrixXd jacobian(rows, cols);
        args.out = pelorus::view(out.data(), rows, 1, 1);
        args.jacobian = pelorus::view(jacobian.data(), rows, cols, 1);
        answer(to ? &plr_motion::to_cartesian : &plr_motion::from_cartesian, args);
        return {out, jacobian};
    }
    /// How far a component is displaced: so that rounding and what the differences leave out are alike.
    static double displacement(const plr_component& component, double at) {
        const double scale = std::strcmp(component.unit, "m") == 0     ? 100.0
                             : std::strcmp(component.unit, "m/s") == 0 ? 10.0
                                                                       : 0.1;
        return 1e-2 * std::max(scale, 0.1 * std::fabs(at));
    }
    static Eigen::MatrixXd differences(const Eigen::VectorXd& x, const plr_space& by, const plr_space& of,
                                       const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& function) {
        Eigen::MatrixXd out(of.size, by.size);
        for (Eigen::Index c = 0; c < out.cols(); ++c) {
            const double h = displacement(by.components[c], x(c));
            const auto apart = [&](double steps) {
                Eigen::VectorXd up = x, down = x;
                up(c) += steps * h;
                down(c) -= steps * h;
                Eigen::VectorXd difference = function(up) - function(down);
                for (Eigen::Index r = 0; r < out.rows(); ++r)
                    if ((of.components[r].flags & PLR_COMPONENT_ANGLE) != 0)
                        difference(r) = pelorus::wrap_angle(difference(r));
                return Eigen::VectorXd(difference / (2.0 * steps * h));
            };
            // Richardson's extrapolation: what is left is of the eighth order.
            const Eigen::VectorXd d1 = apart(1.0), d2 = apart(0.5), d3 = apart(0.25);
            const Eigen::VectorXd e1 = (4.0 * d2 - d1) / 3.0, e2 = (4.0 * d3 - d2) / 3.0;
            out.col(c) = (16.0 * e2 - e1) / 15.0;
        }
        return out;
    }
    static double row_error(const Eigen::MatrixXd& said, const Eigen::MatrixXd& found) {
        double worst = 0.0;
        for (Eigen::Index r = 0; r < said.rows(); ++r)
            worst = std::max(worst, (said.row(r) - found.row(r)).cwiseAbs().maxCoeff() /
                                        std::max(1e-12, found.row(r).cwiseAbs().maxCoeff()));
        return worst;
    }

    pelorus::MotionPart part_;
    std::int64_t n_, c_;
};

}  // namespace test_support
