// What becomes of a measurement on its way into the filter.
#include "converted.hpp"

#include <algorithm>
#include <cstring>

namespace converted {

using batches::at;
using batches::expect_packed;
using batches::for_good_items;
using batches::in_blocks;
using batches::tolerate;
using pelorus::as_const;
using pelorus::PartError;
using pelorus::Scratch;
using pelorus::slice;
using sensing::Conversion;
namespace small = pelorus::small;

namespace {

using Square = small::Bounded<sensing::Converter::most, sensing::Converter::most>;

Square square_at(const plr_view& view, std::int64_t i) {
    return Eigen::Map<const Eigen::MatrixXd>(at(view, i), view.rows, view.cols);
}

/// out = A J', for A of any number of rows.
void times_transposed(const double* a, std::int64_t rows, const Square& jacobian, double* out) {
    std::fill_n(out, rows * jacobian.rows(), 0.0);
    for (Eigen::Index m = 0; m < jacobian.rows(); ++m)
        for (Eigen::Index k = 0; k < jacobian.cols(); ++k)
            for (std::int64_t r = 0; r < rows; ++r) out[m * rows + r] += a[k * rows + r] * jacobian(m, k);
}

/// ln |det J|, by the factor of J J': its rows may differ in scale by any power.
double log_determinant(const Square& jacobian) {
    Square root(jacobian.rows(), jacobian.rows());
    small::gram(jacobian, root);
    if (!small::cholesky(root, root))
        throw pelorus::NumericError("what the sensor measures tells no position at the converted measurement");
    return root.diagonal().array().log().sum();
}

}  // namespace

// -------------------------------------------------------------------------------------------------------- setup

void Filter::build(const pelorus::Setup& setup) {
    filter_ = setup.part<pelorus::EstimatorPart>("estimator");
    const plr_estimator_info& held = filter_.info();
    std::vector<pelorus::SensorPart> inside;
    const char* place = reinterpret_cast<const char*>(held.sensors);
    for (std::uint32_t s = 0; s < held.sensor_count; ++s) {
        inside.emplace_back(*reinterpret_cast<const plr_part*>(place));
        place += held.sensors->struct_size;
    }
    const auto sensors = setup.parts<pelorus::SensorPart>("sensors");
    for (const auto& sensor : sensors) routes_.push_back(route_of(sensor, inside));
    if (routes_.empty()) throw PartError("sensors", "slot sensors is empty, one sensor at least is needed");
    sensors_ = &sensors.front().raw();
}

/// As it is, where the filter has a sensor of the same name for it; else by what `invert` tells.
Filter::Route Filter::route_of(const pelorus::SensorPart& sensor,
                               const std::vector<pelorus::SensorPart>& inside) const {
    const pelorus::Space measured(*sensor.info().measurement);
    const auto number = [&](auto accepts) {
        return static_cast<std::int32_t>(std::find_if(inside.begin(), inside.end(), accepts) - inside.begin());
    };
    Route route;
    route.sensor = sensor;
    route.inside = number([&](const pelorus::SensorPart& own) {
        return own.name() == sensor.name() && pelorus::Space(*own.info().measurement).same(measured);
    });
    if (static_cast<std::size_t>(route.inside) < inside.size()) return route;
    if (!sensing::Converter::fits(sensor))
        throw PartError("sensors", sensor.name() + " (" + sensor.id() + ") cannot be converted: a measurement (" +
                                       measured.text() +
                                       ") does not tell just what the sensor looks at; give the filter a sensor of "
                                       "that name, which takes it as it is");
    const pelorus::Space told(*sensor.info().inverse);
    route.inside = number([&](const pelorus::SensorPart& own) {
        const plr_sensor_info& info = own.info();
        return (info.flags & PLR_SENSOR_LINEAR) != 0 && pelorus::Space(*info.measurement).same(told) &&
               pelorus::Space(*info.cartesian).same(told);
    });
    if (static_cast<std::size_t>(route.inside) == inside.size())
        throw PartError("estimator", "has no linear sensor of " + told.text() + ", into which " + sensor.name() + " (" +
                                         sensor.id() + ") is converted: sensor.position is one");
    route.is_converted = true;
    route.points = inside[static_cast<std::size_t>(route.inside)];
    route.converter = sensing::Converter(sensor);
    const pelorus::Space known(*filter_.info().cartesian);
    for (const pelorus::Component& component : told.components()) route.index.push_back(known.index(component.name));
    return route;
}

/// The filter's own, but for the sensors. Its flags hold, since every call that they speak of is the filter's.
plr_estimator_info Filter::told() const {
    plr_estimator_info info = filter_.info();
    info.struct_size = sizeof info;
    info.flags &= ~std::uint32_t{PLR_FLAG_ANY_STRIDE};
    info.sensor_count = static_cast<std::uint32_t>(routes_.size());
    info.sensors = sensors_;
    std::int64_t most = 0;
    std::uint64_t parts = filter_.info().scratch_bytes;
    for (const Route& by : routes_) {
        parts = std::max(parts, by.sensor.info().scratch_bytes);
        if (by.is_converted) most = std::max(most, doubles(by));
    }
    info.scratch_bytes = static_cast<std::uint64_t>(batches::block_size * most) * sizeof(double) + parts + 2 * 64;
    return info;
}

const Filter::Route& Filter::route(std::int32_t sensor) const {
    if (sensor < 0 || static_cast<std::size_t>(sensor) >= routes_.size())
        throw pelorus::ArgumentError("sensor: is " + std::to_string(sensor) + ", expected 0 to " +
                                     std::to_string(routes_.size() - 1));
    return routes_[static_cast<std::size_t>(sensor)];
}

/// Of an item of a block: the look (see there), and what a projection or an update needs besides.
std::int64_t Filter::doubles(const Route& by) const {
    const std::int64_t d = by.converter.size(), n = filter_.info().state->size, c = filter_.info().cartesian->size;
    const std::int64_t looking = c + 3 * d + 2 * d * d, crosses = (n + c) * d, converting = 3 * d + 2 * d * d;
    return looking + std::max(crosses, converting + by.converter.doubles());
}

// ----------------------------------------------------------------------------------------------------- the look

/// `inside` tells the records and, by choice, where the filter's cross-covariances go. `memory` holds c + 3 d + 2 d d an item.
Filter::Looked Filter::look(const plr_call& call, const Route& by, const plr_estimator_project& inside,
                            double* memory) const {
    const std::int64_t count = inside.record.count, d = by.converter.size(), c = filter_.info().cartesian->size;
    const Looked out{pelorus::view(memory, d, 1, count), pelorus::view(memory + d * count, d, d, count),
                     pelorus::view(memory + (d + d * d) * count, d, 1, count),
                     pelorus::view(memory + (2 * d + d * d) * count, d, d, count)};
    double* const rest = memory + 2 * (d + d * d) * count;
    auto ask = pelorus::arguments<plr_estimator_moments>();
    ask.record = inside.record;
    ask.mean = pelorus::view(rest, c, 1, count);
    ask.covariance = pelorus::absent_output();
    tolerate(filter_.call(&plr_estimator::summary, call, ask));
    for (std::int64_t i = 0; i < count; ++i)
        for (std::int64_t k = 0; k < d; ++k)
            at(out.place, i)[k] = at(ask.mean, i)[by.index[static_cast<std::size_t>(k)]];

    plr_estimator_project project = inside;
    project.sensor = by.inside;
    project.measurement = pelorus::view(rest + c * count, d, 1, count);
    project.covariance = out.spread;
    tolerate(filter_.call(&plr_estimator::project, call, project));

    auto measure = pelorus::arguments<plr_sensor_measure>();
    measure.cartesian = as_const(out.place);
    measure.out = out.seen;
    tolerate(by.sensor.call(&plr_sensor::measure, call, measure));
    slope(call, by, as_const(out.place), out.jacobian);
    return out;
}

void Filter::slope(const plr_call& call, const Route& by, const plr_const_view& places, const plr_view& out) const {
    auto derive = pelorus::arguments<plr_sensor_jacobian>();
    derive.cartesian = places;
    derive.out = out;
    tolerate(by.sensor.call(&plr_sensor::jacobian, call, derive));
}

/// h(x) and J P J': what a gate in the sensor's own units needs.
plr_status Filter::project(const plr_call& call, const plr_estimator_project& args) const {
    const Route& by = route(args.sensor);
    if (!by.is_converted) {
        plr_estimator_project own = args;
        own.sensor = by.inside;
        return filter_.call(&plr_estimator::project, call, own);
    }
    const plr_estimator_info& held = filter_.info();
    const std::int64_t count = args.measurement.count, d = by.converter.size(), n = held.state->size,
                       c = held.cartesian->size;
    expect_packed(args.record, held.record_size, 1, count, "record");
    expect_packed(args.measurement, d, 1, count, "measurement");
    expect_packed(args.covariance, d, d, count, "covariance");
    if (args.cross.data != nullptr) expect_packed(args.cross, n, d, count, "cross");
    if (args.cartesian_cross.data != nullptr) expect_packed(args.cartesian_cross, c, d, count, "cartesian_cross");
    const Scratch scratch(call, batches::block_size * doubles(by));
    return in_blocks(call, count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        double* const crosses = scratch.data() + items * (c + 3 * d + 2 * d * d);
        auto inside = pelorus::arguments<plr_estimator_project>();
        inside.record = slice(args.record, first, items);
        if (args.cross.data != nullptr) inside.cross = pelorus::view(crosses, n, d, items);
        if (args.cartesian_cross.data != nullptr)
            inside.cartesian_cross = pelorus::view(crosses + items * n * d, c, d, items);
        const Looked looked = look(block, by, inside, scratch.data());
        return for_good_items(block, items, [&](std::int64_t i) {
            const Square jacobian = square_at(looked.jacobian, i);
            Square seen(d, d);
            small::symmetric_product(jacobian, square_at(looked.spread, i), seen);
            std::copy_n(at(looked.seen, i), d, at(args.measurement, first + i));
            std::copy_n(seen.data(), d * d, at(args.covariance, first + i));
            if (args.cross.data != nullptr)
                times_transposed(at(inside.cross, i), n, jacobian, at(args.cross, first + i));
            if (args.cartesian_cross.data != nullptr)
                times_transposed(at(inside.cartesian_cross, i), c, jacobian, at(args.cartesian_cross, first + i));
        });
    });
}

// --------------------------------------------------------------------------------------------------- the update

plr_status Filter::update(const plr_call& call, const plr_estimator_update& args) const {
    const Route& by = route(args.sensor);
    plr_estimator_update own = args;
    own.sensor = by.inside;
    if (!by.is_converted) return filter_.call(&plr_estimator::update, call, own);
    const std::int64_t count = args.out.count, d = by.converter.size(), record = filter_.info().record_size;
    expect_packed(args.record, record, 1, count, "record");
    expect_packed(args.measurement, d, 1, count, "measurement");
    expect_packed(args.noise, d, d, count, "noise");
    expect_packed(args.out, record, 1, count, "out");
    if (args.log_likelihood.data != nullptr) expect_packed(args.log_likelihood, 1, 1, count, "log_likelihood");
    if (args.innovation.data != nullptr) expect_packed(args.innovation, d, 1, count, "innovation");
    if (args.innovation_covariance.data != nullptr)
        expect_packed(args.innovation_covariance, d, d, count, "innovation_covariance");
    const Scratch scratch(call, batches::block_size * doubles(by));
    return in_blocks(call, count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        plr_estimator_update run = own;
        run.record = slice(args.record, first, items);
        run.measurement = slice(args.measurement, first, items);
        run.noise = slice(args.noise, first, items);
        run.out = slice(args.out, first, items);
        run.log_likelihood = slice(args.log_likelihood, first, items);
        run.innovation = slice(args.innovation, first, items);
        run.innovation_covariance = slice(args.innovation_covariance, first, items);
        return update_block(block, by, run, scratch.data());
    });
}

plr_status Filter::update_block(const plr_call& call, const Route& by, const plr_estimator_update& args,
                                double* memory) const {
    const std::int64_t count = args.out.count, d = by.converter.size(), c = filter_.info().cartesian->size;
    auto inside = pelorus::arguments<plr_estimator_project>();
    inside.record = args.record;
    const Looked looked = look(call, by, inside, memory);
    tell_innovation(call, by, looked, args);

    double* const rest = memory + count * (c + 3 * d + 2 * d * d);
    const plr_view mean = pelorus::view(rest, d, 1, count), covariance = pelorus::view(rest + d * count, d, d, count),
                   given = pelorus::view(rest + (d + d * d) * count, d, 1, count),
                   slopes = pelorus::view(rest + (2 * d + d * d) * count, d, d, count);
    by.converter.convert(call, conversion_,
                         {args.measurement, args.noise, as_const(looked.place), as_const(looked.spread)}, mean,
                         covariance, rest + (3 * d + 2 * d * d) * count);
    slope(call, by, as_const(mean), slopes);
    auto measure = pelorus::arguments<plr_sensor_measure>();
    measure.cartesian = as_const(mean);
    measure.out = given;
    tolerate(by.points.call(&plr_sensor::measure, call, measure));

    plr_estimator_update own = args;
    own.measurement = as_const(given);
    own.noise = as_const(covariance);
    own.innovation = own.innovation_covariance = pelorus::absent_output();
    tolerate(filter_.call(&plr_estimator::update, call, own));
    // A density over positions is one over measurements by |d position / d measurement|.
    return for_good_items(call, count, [&](std::int64_t i) {
        const double stretch = -log_determinant(square_at(slopes, i));
        if (args.log_likelihood.data != nullptr) *at(args.log_likelihood, i) += stretch;
    });
}

void Filter::tell_innovation(const plr_call& call, const Route& by, const Looked& looked,
                             const plr_estimator_update& args) const {
    if (args.innovation.data != nullptr) {
        auto compare = pelorus::arguments<plr_sensor_residual>();
        compare.measurement = args.measurement;
        compare.reference = as_const(looked.seen);
        compare.out = args.innovation;
        tolerate(by.sensor.call(&plr_sensor::residual, call, compare));
    }
    if (args.innovation_covariance.data == nullptr) return;
    const std::int64_t d = by.converter.size();
    for (std::int64_t i = 0; i < args.out.count; ++i) {
        Square seen(d, d);
        small::symmetric_product(square_at(looked.jacobian, i), square_at(looked.spread, i), seen);
        for (std::int64_t e = 0; e < d * d; ++e)
            at(args.innovation_covariance, i)[e] = seen.data()[e] + at(args.noise, i)[e];
    }
}

// --------------------------------------------------------------------------------------------------- the plugin

template <bool assigns> void Converted<assigns>::describe(pelorus::Describe<Converted>& plugin) {
    plugin.title("Converted measurements")
        .purpose(
            "Gives any filter positions in the place of ranges and angles, so that its update is linear however far "
            "away and however coarse the angles are. The covariance of a converted measurement is that at the "
            "predicted "
            "place, on which the error of the measurement has no influence: else the estimate is drawn to one side.")
        .equation(
            "z -> c(z) without bias; R = E Var(c(z) | x) over x ~ N(prediction) (predicted), or Var(c(z) | x = c(z)) "
            "(measured); the filter's update with c(z), R; ln L = ln L_filter + ln |dc/dz|")
        .source(
            "S. Bordonaro, P. Willett, Y. Bar-Shalom, Decorrelated unbiased converted measurement Kalman filter, IEEE "
            "Transactions on Aerospace and Electronic Systems 50(2), 1431-1444, 2014");
    plugin.slot("estimator", "estimator", 1, 1,
                "the filter that is given positions: with sensor.position among its sensors, for what is converted");
    plugin.slot("sensors", "sensor", 1, -1,
                "what measures; a sensor of a name that the filter has for the same measurement is not converted");
    plugin.parameter("conversion", &Converted::conversion_)
        .initially("predicted")
        .choices({{"predicted", "the covariance is the mean over where the object is predicted to be"},
                  {"measured", "the covariance is that at the measured place, which depends on the error"}})
        .doc("where the covariance of a converted measurement is evaluated");
}

template <bool assigns> void Converted<assigns>::setup(const pelorus::Setup& setup) {
    this->build(setup);
    this->info = this->told();
    mix_inside_ = filter().template extension<plr_estimator_mix>(PLR_ESTIMATOR_MIX);
    modes_inside_ = filter().template extension<plr_estimator_modes>(PLR_ESTIMATOR_MODES);
    if (modes_inside_ == nullptr) return;
    modes_ = {sizeof modes_, modes_inside_->mode_count, modes_inside_->names,
              [](const void* self, const plr_call* call, const plr_const_view* record, const plr_view* out) {
                  const auto& own = *static_cast<const Converted*>(self);
                  return own.modes_inside_->probabilities(own.filter().self(), call, record, out);
              }};
}

template <bool assigns> const void* Converted<assigns>::extension(const char* id) const noexcept {
    static constexpr plr_estimator_mix mixing{
        sizeof(plr_estimator_mix), 0, &pelorus::detail::forward<Converted, plr_estimator_mix_args, &Converted::mix>};
    if (mix_inside_ != nullptr && std::strcmp(id, PLR_ESTIMATOR_MIX) == 0) return &mixing;
    return modes_inside_ != nullptr && std::strcmp(id, PLR_ESTIMATOR_MODES) == 0 ? &modes_ : nullptr;
}

template class Converted<true>;
template class Converted<false>;

}  // namespace converted
