/// What the columns of a recording mean: the rows of the parameter `columns`, checked and brought into the order of the
/// measurement space.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <pelorus/space.hpp>

namespace source_csv {

/// In the order of the words in component_words().
enum class Component {
    x,
    y,
    z,
    range,
    range_rate,
    azimuth,
    bearing,
    elevation,
    zenith,
    latitude,
    longitude,
    height,
    true_x,
    true_y,
    true_z,
    true_velocity_x,
    true_velocity_y,
    true_velocity_z,
    true_speed,
    true_course
};
enum class Unit { si, m, km, ft, nmi, rad, mrad, deg, m_s, km_h, kn };

using Words = std::vector<std::pair<std::string, std::string>>;
const Words& component_words();
const Words& unit_words();

/// One row of the parameter.
struct ColumnRow {
    std::string column;  ///< a name of the header, or a number from 1
    Component component = Component::x;
    Unit unit = Unit::si;
    std::optional<double> deviation;  ///< of the measurement's noise, in `unit`; of geodetic columns in m
};

/// A file column that is read as a number.
struct NumberColumn {
    std::string column;
    Component component = Component::x;
    double factor = 1;  ///< number x factor is in SI
};

/// What a scan's measurements are.
enum class Form { position, spherical, geodetic };

/// The parameter, understood.
struct ColumnPlan {
    Form form = Form::position;
    pelorus::Space measurement;  ///< m components
    std::vector<NumberColumn>
        measured;  ///< position, spherical: one a component, in order; geodetic: latitude, longitude[, height]
    std::vector<double> covariance;           ///< m x m, or empty: none is declared
    std::vector<NumberColumn> true_position;  ///< x, y[, z], or empty: the truth is where it was measured
    std::vector<NumberColumn> true_velocity;  ///< x, y[, z], or empty
    std::optional<NumberColumn> true_speed, true_course;

    bool tells_truth() const noexcept { return !true_position.empty() || !true_velocity.empty() || true_speed; }
    int true_dimension() const noexcept {
        return true_position.empty() ? measurement.size() : static_cast<int>(true_position.size());
    }
    bool has_velocity() const noexcept { return !true_velocity.empty() || true_speed.has_value(); }
};

/// Throws ParameterError pointing into `columns`.
ColumnPlan plan_columns(const std::vector<ColumnRow>& rows);

}  // namespace source_csv
