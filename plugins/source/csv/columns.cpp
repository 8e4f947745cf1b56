#include "columns.hpp"

#include <algorithm>
#include <map>

#include <pelorus/failure.hpp>

namespace source_csv {

namespace {

constexpr double pi = 3.14159265358979323846;

enum class Quantity { any, length, angle, speed };

struct UnitFacts {
    Quantity quantity;
    double factor;
};
UnitFacts facts(Unit unit) {
    switch (unit) {
        case Unit::m:
            return {Quantity::length, 1};
        case Unit::km:
            return {Quantity::length, 1000};
        case Unit::ft:
            return {Quantity::length, 0.3048};
        case Unit::nmi:
            return {Quantity::length, 1852};
        case Unit::rad:
            return {Quantity::angle, 1};
        case Unit::mrad:
            return {Quantity::angle, 1e-3};
        case Unit::deg:
            return {Quantity::angle, pi / 180};
        case Unit::m_s:
            return {Quantity::speed, 1};
        case Unit::km_h:
            return {Quantity::speed, 1 / 3.6};
        case Unit::kn:
            return {Quantity::speed, 1852.0 / 3600};
        default:
            return {Quantity::any, 1};
    }
}

Quantity quantity_of(Component component) {
    switch (component) {
        case Component::azimuth:
        case Component::bearing:
        case Component::elevation:
        case Component::zenith:
        case Component::latitude:
        case Component::longitude:
        case Component::true_course:
            return Quantity::angle;
        case Component::range_rate:
        case Component::true_velocity_x:
        case Component::true_velocity_y:
        case Component::true_velocity_z:
        case Component::true_speed:
            return Quantity::speed;
        default:
            return Quantity::length;
    }
}

const std::string& word(Component component) { return component_words()[static_cast<std::size_t>(component)].first; }
const std::string& word(Unit unit) { return unit_words()[static_cast<std::size_t>(unit)].first; }

[[noreturn]] void refuse(const std::string& what, const std::string& where = "columns") {
    throw pelorus::ParameterError(where, what);
}

/// The rows by component.
class Given {
public:
    explicit Given(const std::vector<ColumnRow>& rows) : rows_(rows) {
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const ColumnRow& row = rows[i];
            const std::string where = "columns[" + std::to_string(i) + "]";
            const UnitFacts unit = facts(row.unit);
            if (unit.quantity != Quantity::any && unit.quantity != quantity_of(row.component))
                refuse(word(row.unit) + " is no unit for " + word(row.component), where + ".unit");
            if (row.deviation && !(*row.deviation > 0)) refuse("must be greater than 0", where + ".deviation");
            if (row.deviation && row.component >= Component::true_x)
                refuse("belongs to measured components, not to " + word(row.component), where + ".deviation");
            if (!index_.emplace(row.component, i).second) refuse(word(row.component) + " is given twice", where);
        }
    }

    bool has(Component component) const { return index_.count(component) != 0; }
    bool has_any(const std::vector<Component>& components) const {
        return std::any_of(components.begin(), components.end(), [&](Component c) { return has(c); });
    }
    NumberColumn column(Component component) const {
        const ColumnRow& row = rows_[index_.at(component)];
        return {row.column, component, facts(row.unit).factor};
    }
    std::optional<double> deviation(Component component) const { return rows_[index_.at(component)].deviation; }
    double factor(Component component) const { return facts(rows_[index_.at(component)].unit).factor; }
    /// The first ones of a list, without a gap: x, y of x, y, z.
    std::vector<Component> leading(const std::vector<Component>& list) const {
        std::vector<Component> found;
        for (const Component c : list) {
            if (!has(c)) continue;
            if (c != list[found.size()]) refuse(word(c) + " is given, but not " + word(list[found.size()]));
            found.push_back(c);
        }
        return found;
    }

private:
    const std::vector<ColumnRow>& rows_;
    std::map<Component, std::size_t> index_;
};

const std::vector<Component> positions{Component::x, Component::y, Component::z};
const std::vector<Component> sphericals{Component::range,   Component::range_rate, Component::azimuth,
                                        Component::bearing, Component::elevation,  Component::zenith};
const std::vector<Component> geodetics{Component::latitude, Component::longitude, Component::height};

Form form_of(const Given& given) {
    const bool position = given.has_any(positions), spherical = given.has_any(sphericals),
               geodetic = given.has_any(geodetics);
    if (position + spherical + geodetic > 1)
        refuse("mixes position, spherical and geodetic components; a recording has one kind of measurement");
    if (position + spherical + geodetic == 0) refuse("names no measured component");
    return position ? Form::position : spherical ? Form::spherical : Form::geodetic;
}

/// The components of the measurement space, in canonical order, by what they are read from.
std::vector<Component> measured(const Given& given, Form form) {
    if (form == Form::position) return given.leading(positions);
    if (form == Form::geodetic) {
        const auto found = given.leading(geodetics);
        if (found.size() < 2) refuse("names latitude, but not longitude");
        return found;
    }
    if (given.has(Component::azimuth) && given.has(Component::bearing)) refuse("names both azimuth and bearing");
    if (given.has(Component::elevation) && given.has(Component::zenith)) refuse("names both elevation and zenith");
    std::vector<Component> found;
    for (const Component c : sphericals)
        if (given.has(c)) found.push_back(c);
    return found;
}

pelorus::Component described(Component component) {
    switch (component) {
        case Component::range:
            return {"range", "m", 0, 0, false};
        case Component::range_rate:
            return {"range_rate", "m/s", 0, 0, false};
        case Component::elevation:
            return {"elevation", "rad", 0, 0, true};
        case Component::zenith:
            return {"zenith", "rad", 0, 0, true};
        default:
            return {"azimuth", "rad", 0, 0, true};
    }
}

pelorus::Space space_of(const std::vector<Component>& components, Form form) {
    if (form != Form::spherical) return pelorus::position_space(static_cast<int>(components.size()));
    std::vector<pelorus::Component> described_ones;
    for (const Component c : components) described_ones.push_back(described(c));
    return pelorus::Space(std::move(described_ones));
}

/// The declared noise, m x m. Latitude's deviation is that to the north (y), longitude's that to the east (x).
std::vector<double> covariance_of(const Given& given, const std::vector<Component>& components, Form form) {
    const auto m = components.size();
    std::vector<double> deviations;
    for (const Component c : components) {
        const auto deviation = given.deviation(c);
        if (deviation) deviations.push_back(form == Form::geodetic ? *deviation : *deviation * given.factor(c));
    }
    if (deviations.empty()) return {};
    if (deviations.size() != m) refuse("gives a deviation to some measured components, but not to all");
    if (form == Form::geodetic) std::swap(deviations[0], deviations[1]);
    std::vector<double> covariance(m * m, 0.0);
    for (std::size_t i = 0; i < m; ++i) covariance[i * m + i] = deviations[i] * deviations[i];
    return covariance;
}

void plan_truth(const Given& given, ColumnPlan& plan) {
    for (const Component c : given.leading({Component::true_x, Component::true_y, Component::true_z}))
        plan.true_position.push_back(given.column(c));
    for (const Component c :
         given.leading({Component::true_velocity_x, Component::true_velocity_y, Component::true_velocity_z}))
        plan.true_velocity.push_back(given.column(c));
    if (given.has(Component::true_speed)) plan.true_speed = given.column(Component::true_speed);
    if (given.has(Component::true_course)) plan.true_course = given.column(Component::true_course);
    if (plan.true_speed.has_value() != plan.true_course.has_value())
        refuse("true.speed and true.course belong together");
    if (plan.true_speed && !plan.true_velocity.empty()) refuse("names true.velocity and true.speed");
    const auto dimension = static_cast<std::size_t>(plan.true_dimension());
    if (!plan.true_velocity.empty() && plan.true_velocity.size() != dimension)
        refuse("true velocities have " + std::to_string(plan.true_velocity.size()) + " axes, true positions " +
               std::to_string(dimension));
    if (plan.true_speed && dimension < 2) refuse("true.course needs two axes");
}

}  // namespace

const Words& component_words() {
    static const Words words{{"position.x", ""},
                             {"position.y", ""},
                             {"position.z", ""},
                             {"range", ""},
                             {"range_rate", ""},
                             {"azimuth", "from +x to +y"},
                             {"bearing", "from +y (north) to +x (east); becomes an azimuth"},
                             {"elevation", "from the x-y plane to +z"},
                             {"zenith", "from +z down"},
                             {"latitude", "on WGS84; with longitude it becomes a local position"},
                             {"longitude", ""},
                             {"height", "above the WGS84 ellipsoid"},
                             {"true.position.x", "where the object really is"},
                             {"true.position.y", ""},
                             {"true.position.z", ""},
                             {"true.velocity.x", ""},
                             {"true.velocity.y", ""},
                             {"true.velocity.z", ""},
                             {"true.speed", "over ground, with true.course"},
                             {"true.course", "from +y (north) to +x (east)"}};
    return words;
}

const Words& unit_words() {
    static const Words words{{"SI", "m, rad or m/s"},
                             {"m", ""},
                             {"km", ""},
                             {"ft", ""},
                             {"nmi", ""},
                             {"rad", ""},
                             {"mrad", ""},
                             {"deg", ""},
                             {"m/s", ""},
                             {"km/h", ""},
                             {"kn", ""}};
    return words;
}

ColumnPlan plan_columns(const std::vector<ColumnRow>& rows) {
    const Given given(rows);
    ColumnPlan plan;
    plan.form = form_of(given);
    const std::vector<Component> components = measured(given, plan.form);
    plan.measurement = space_of(components, plan.form);
    for (const Component c : components) plan.measured.push_back(given.column(c));
    plan.covariance = covariance_of(given, components, plan.form);
    plan_truth(given, plan);
    return plan;
}

}  // namespace source_csv
