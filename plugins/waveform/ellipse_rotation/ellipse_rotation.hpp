/// waveform.ellipse_rotation: turns the measurement ellipse across the predicted one. See README.md.
#pragma once

#include <array>

#include "../../common/waveform/pulse_library.hpp"

namespace ellipse_rotation {

enum class Rule { published, exact };

constexpr double quarter_turn = 1.57079632679489661923;

/// Determinant of an n x n block (n 1 to 3) of a covariance.
inline double block_determinant(const waveform::Covariance& p, Eigen::Index row, Eigen::Index col,
                                Eigen::Index n) noexcept {
    const auto e = [&](Eigen::Index r, Eigen::Index c) { return p(row + r, col + c); };
    if (n == 1) return e(0, 0);
    if (n == 2) return e(0, 0) * e(1, 1) - e(0, 1) * e(1, 0);
    return e(0, 0) * (e(1, 1) * e(2, 2) - e(1, 2) * e(2, 1)) - e(0, 1) * (e(1, 0) * e(2, 2) - e(1, 2) * e(2, 0)) +
           e(0, 2) * (e(1, 0) * e(2, 1) - e(1, 1) * e(2, 0));
}

/// Eq. 22: phi = pi/2 - arctan(2 det P12/(det P11 - det P22))/2 with P11 the block of positions, P22 that of velocities and
/// P12 the one between them. The plain arctangent, as printed. `velocity`: where the velocities begin.
inline double published_angle(const waveform::Covariance& p, Eigen::Index axes, Eigen::Index velocity) noexcept {
    const double across = 2 * block_determinant(p, 0, velocity, axes);
    const double along = block_determinant(p, 0, 0, axes) - block_determinant(p, velocity, velocity, axes);
    const double ratio = across / along;
    return quarter_turn - 0.5 * (along == 0 && across == 0 ? 0.0 : std::atan(ratio));
}

/// The major axis of what the measurement will be compared with, in (range, range rate), given the angles,
///     A = S0_rv - S0_ra (S0_aa + R_aa)^-1 S0_ar,  psi = atan2(2 A12, A11 - A22)/2,
/// and the rotation that lays the minor axis of R0 along it: pi/2 - psi where R0 is longer in range, else -psi. For an R0
/// without correlation of range and range rate it is, of all rotations, the one of the least posterior determinant.
inline double exact_angle(const waveform::Noise& projected, const waveform::Noise& base) {
    const Eigen::Index angles = base.rows() - 2;
    waveform::Noise root(angles, angles);
    pelorus::small::Bounded<waveform::most_measured, 2> across(angles, 2);
    for (Eigen::Index c = 0; c < angles; ++c)
        for (Eigen::Index r = 0; r < angles; ++r) root(r, c) = projected(2 + r, 2 + c) + base(2 + r, 2 + c);
    for (Eigen::Index c = 0; c < 2; ++c)
        for (Eigen::Index r = 0; r < angles; ++r) across(r, c) = projected(2 + r, c);
    if (!pelorus::small::cholesky(root, root))
        throw pelorus::NumericError("H P H' + R of the angles is not positive definite");
    pelorus::small::solve_lower(root, across);
    pelorus::Matrix<2> a;
    for (Eigen::Index c = 0; c < 2; ++c)
        for (Eigen::Index r = 0; r < 2; ++r) {
            a(r, c) = projected(r, c);
            for (Eigen::Index k = 0; k < angles; ++k) a(r, c) -= across(k, r) * across(k, c);
        }
    const double psi = 0.5 * std::atan2(2 * a(0, 1), a(0, 0) - a(1, 1));
    return base(0, 0) >= base(1, 1) ? quarter_turn - psi : -psi;
}

class EllipseRotation : public pelorus::Waveform<EllipseRotation> {
public:
    static void describe(pelorus::Describe<EllipseRotation>& plugin) {
        plugin.title("Rotation of the measurement ellipse")
            .purpose(
                "Turns the ellipse of range and range rate by a fractional Fourier transform of the pulse until it "
                "lies "
                "across the predicted one. Rule `published` is the paper's, rule `exact` what it is meant to be.")
            .equation(
                "R = L' R0 L, L = [cos phi, -sin phi; sin phi, cos phi]; published: phi = pi/2 - arctan(2 det P12/(det "
                "P11 - det P22))/2; exact: phi = pi/2 - psi or -psi, psi = atan2(2 A12, A11 - A22)/2, A the predicted "
                "(range, range rate) given the angles")
            .source(
                "H. Zhang, J. Xie, J. Ge, B. Zong, W. Lu, Maneuvering target tracking based on waveform scheduling, "
                "Acta Electronica Sinica 47(3), 560-567, 2019, eq. 22");
        plugin.parameter("rule", &EllipseRotation::rule_)
            .initially("exact")
            .choices({{"published", "eq. 22, from the blocks of the predicted covariance"},
                      {"exact", "from the predicted measurement's covariance: least posterior determinant"}})
            .doc("how the angle is chosen");
        plugin.parameter("dimension", &EllipseRotation::dimension_)
            .initially("2")
            .min(2)
            .max(3)
            .doc("2: the sensor measures range, range rate and azimuth; 3: elevation, too");
    }

    void setup(const pelorus::Setup&) {
        measurement_ = waveform::measurement_space(dimension_);
        info.measurement = measurement_.c();
        info.waveform = space_.c();
        info.horizon = 1;
    }

    plr_status choose(const plr_call& call, const plr_waveform_choose& args) const {
        waveform::check_choose(args, measurement_.size(), 1, 1);
        const Eigen::Index velocity = rule_ == Rule::published ? first_velocity(*args.cartesian) : 0;
        return pelorus::for_items(call, args.waveform.count, [&](std::int64_t i) {
            const waveform::Prediction prediction = waveform::load_prediction(args, i, 0);
            const waveform::Noise base = waveform::load_noise(args.base_noise, i);
            const double angle = rule_ == Rule::published
                                     ? published_angle(prediction.covariance, prediction.positions, velocity)
                                     : exact_angle(prediction.projected, base);
            const waveform::Transform t = waveform::rotation(angle);
            waveform::Noise noise = base;
            waveform::transform(t, base, noise);
            const double criterion = waveform::Outlook(prediction, base, waveform::Criterion::determinant)(t);
            waveform::answer(args, i, std::array<double, 1>{angle}, noise, criterion);
        });
    }

    plr_status noise(const plr_call& call, const plr_waveform_noise& args) const {
        return waveform::answer_noise(call, args, measurement_.size(), 1, [&](std::int64_t i) {
            return waveform::rotation(waveform::parameter(args.waveform, i, 0));
        });
    }

private:
    /// Where the velocities stand, as many as there are positions. Throws ArgumentError.
    static Eigen::Index first_velocity(const plr_space& cartesian) {
        int positions = 0;
        const char* at = reinterpret_cast<const char*>(cartesian.components);
        for (std::uint32_t k = 0; k < cartesian.size; ++k) {
            const auto& component = *reinterpret_cast<const plr_component*>(at);
            if (std::strncmp(component.name, "position.", 9) == 0) ++positions;
            if (std::strncmp(component.name, "velocity.", 9) == 0 && positions > 0 &&
                k + static_cast<std::uint32_t>(positions) <= cartesian.size)
                return static_cast<Eigen::Index>(k);
            at += component.struct_size;
        }
        throw pelorus::ArgumentError("cartesian: has no velocities, which rule: published reads");
    }

    Rule rule_ = Rule::exact;
    int dimension_ = 2;
    pelorus::Space measurement_, space_{std::vector<pelorus::Component>{{"rotation", "rad", 0, 1, false}}};
};

}  // namespace ellipse_rotation
