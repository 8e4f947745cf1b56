// Every model that stands in a published config, and every variant listed below, is called through its table with the allocator
// watched: calls marked [hot] in the ABI headers must not touch it.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <unistd.h>
#include <vector>

#include <pelorus/matrix.hpp>
#include <pelorus/parts.hpp>

#include "counter.hpp"
#include "graph/graph.hpp"
#include "host/catalog.hpp"

using namespace pelorus;

namespace {

constexpr std::int64_t items = 7;

/// Memory and context of the calls, made once and never inside the watched region.
struct Bench {
    std::vector<unsigned char> scratch_memory = std::vector<unsigned char>(std::size_t{4} << 20);
    plr_scratch scratch{};
    plr_error error{};
    std::vector<plr_status> status = std::vector<plr_status>(64, PLR_OK);
    std::vector<std::uint64_t> ids;
    std::vector<plr_key> keys;
    plr_call call{};
    std::vector<std::unique_ptr<std::vector<double>>> arrays;
    bool watches = true;  ///< false: calls are made, and may allocate

    Bench() {
        const auto address = reinterpret_cast<std::uintptr_t>(scratch_memory.data());
        const std::size_t shift = (64 - address % 64) % 64;
        scratch = {scratch_memory.data() + shift, scratch_memory.size() - shift, 0};
        error.struct_size = sizeof error;
        for (std::uint64_t i = 0; i < 64; ++i) {
            ids.push_back(i + 1);
            keys.push_back({{17, i}});
        }
        call = {sizeof(plr_call), 0, 0,        0,      ids.data(),    keys.data(),
                nullptr,          0, &scratch, &error, status.data(), nullptr};
    }
    double* array(std::int64_t size, double value = 0) {
        arrays.push_back(
            std::make_unique<std::vector<double>>(static_cast<std::size_t>(std::max<std::int64_t>(size, 1)), value));
        return arrays.back()->data();
    }
    plr_view out(std::int64_t rows, std::int64_t cols, std::int64_t count) {
        return view(array(rows * cols * count), rows, cols, count);
    }
    /// A diagonal matrix for each item.
    plr_const_view diagonal(std::int64_t n, std::int64_t count, double value) {
        double* a = array(n * n * count);
        for (std::int64_t i = 0; i < count; ++i)
            for (std::int64_t r = 0; r < n; ++r) a[i * n * n + r * n + r] = value;
        return const_view(a, n, n, count);
    }
    /// Points that differ from each other and lie far from every singular place.
    plr_const_view states(const plr_space& space, std::int64_t points, std::int64_t count) {
        const std::int64_t n = space.size;
        double* a = array(n * points * count);
        for (std::int64_t i = 0; i < points * count; ++i)
            for (std::int64_t r = 0; r < n; ++r)
                a[i * n + r] = (r < 3 ? 1000.0 + 300.0 * static_cast<double>(r) : 3.0) + 0.5 * static_cast<double>(i);
        return const_view(a, n, points, count);
    }
    plr_const_view seconds(double dt) { return common_view(array(1, dt), 1, 1, items); }
};

/// Runs one call with the allocator watched.
template <class Function> void watched(Bench& bench, const std::string& what, Function&& function) {
    INFO(what);
    std::fill(bench.status.begin(), bench.status.end(), PLR_OK);
    bench.error.code = PLR_OK;
    bench.error.message[0] = 0;
    const std::uint64_t before = test::allocations();
    const plr_status status = function();
    const std::uint64_t after = test::allocations();
    INFO(bench.error.message);
    CHECK(status == PLR_OK);
    if (bench.watches) CHECK(after - before == 0);
}

template <class Args> Args args() { return arguments<Args>(); }

void exercise_motion(Bench& b, const plr_part& part) {
    const MotionPart motion(part);
    const auto& info = motion.info();
    const std::int64_t n = info.state->size, r = info.record_size;
    const plr_const_view x = b.states(*info.state, 1, items), p = b.diagonal(n, items, 2.0);
    const plr_view record = b.out(r, 1, items);
    if (r > 0) {
        auto a = args<plr_motion_record>();
        a.state = x, a.covariance = p, a.out = record;
        watched(b, "init_record", [&] { return motion.call(&plr_motion::init_record, b.call, a); });
        a.dt = b.seconds(0.5), a.record = as_const(record);
        watched(b, "advance_record", [&] { return motion.call(&plr_motion::advance_record, b.call, a); });
    }
    auto propagate = args<plr_motion_propagate>();
    propagate.dt = b.seconds(0.5), propagate.state = x, propagate.record = as_const(record);
    propagate.out = b.out(n, 1, items), propagate.mean = x;
    watched(b, "propagate", [&] { return motion.call(&plr_motion::propagate, b.call, propagate); });
    auto jacobian = args<plr_motion_jacobian>();
    jacobian.dt = propagate.dt, jacobian.state = x, jacobian.record = as_const(record), jacobian.mean = x;
    jacobian.out = b.out(n, n, items);
    watched(b, "jacobian", [&] { return motion.call(&plr_motion::jacobian, b.call, jacobian); });
    auto noise = args<plr_motion_noise>();
    noise.dt = propagate.dt, noise.state = x, noise.covariance = p, noise.predicted = as_const(propagate.out);
    noise.record = as_const(record), noise.out = b.out(n, n, items), noise.extent = b.diagonal(3, items, 4.0);
    watched(b, "noise", [&] { return motion.call(&plr_motion::noise, b.call, noise); });
    if (motion.table().to_cartesian != nullptr) {
        auto convert = args<plr_motion_convert>();
        const std::int64_t c = info.cartesian->size;
        convert.in = x, convert.out = b.out(c, 1, items), convert.jacobian = b.out(c, n, items);
        watched(b, "to_cartesian", [&] { return motion.call(&plr_motion::to_cartesian, b.call, convert); });
        convert.in = b.states(*info.cartesian, 1, items), convert.out = b.out(n, 1, items);
        convert.jacobian = b.out(n, c, items);
        watched(b, "from_cartesian", [&] { return motion.call(&plr_motion::from_cartesian, b.call, convert); });
    }
    if (const auto* structure = motion.extension<plr_motion_structure>(PLR_MOTION_STRUCTURE)) {
        double* f = b.array(structure->block * structure->block);
        double* q = b.array(structure->block * structure->block);
        watched(b, "structure.blocks", [&] { return structure->blocks(motion.self(), &b.call, 0.5, f, q); });
    }
    if (const auto* factor = motion.extension<plr_motion_noise_factor>(PLR_MOTION_NOISE_FACTOR)) {
        noise.out = b.out(n, factor->columns, items);
        watched(b, "noise_factor", [&] { return factor->factor(motion.self(), &b.call, &noise); });
    }
}

void exercise_sensor(Bench& b, const plr_part& part) {
    const SensorPart sensor(part);
    const auto& info = sensor.info();
    const std::int64_t m = info.measurement->size, c = info.cartesian->size;
    auto measure = args<plr_sensor_measure>();
    measure.cartesian = b.states(*info.cartesian, 2, items), measure.out = b.out(m, 2, items);
    watched(b, "measure", [&] { return sensor.call(&plr_sensor::measure, b.call, measure); });
    auto jacobian = args<plr_sensor_jacobian>();
    jacobian.cartesian = b.states(*info.cartesian, 1, items), jacobian.out = b.out(m, c, items);
    watched(b, "jacobian", [&] { return sensor.call(&plr_sensor::jacobian, b.call, jacobian); });
    auto noise = args<plr_sensor_noise>();
    noise.cartesian = jacobian.cartesian, noise.out = b.out(m, m, items);
    watched(b, "noise", [&] { return sensor.call(&plr_sensor::noise, b.call, noise); });
    auto residual = args<plr_sensor_residual>();
    residual.measurement = as_const(measure.out), residual.reference = as_const(measure.out),
    residual.out = b.out(m, 2, items);
    watched(b, "residual", [&] { return sensor.call(&plr_sensor::residual, b.call, residual); });
    if ((info.flags & PLR_SENSOR_CAN_INVERT) != 0) {
        auto invert = args<plr_sensor_invert>();
        const plr_view single = b.out(m, 1, items);
        auto one = args<plr_sensor_measure>();
        one.cartesian = jacobian.cartesian, one.out = single;
        REQUIRE(sensor.call(&plr_sensor::measure, b.call, one) == PLR_OK);
        const std::int64_t i = info.inverse->size;
        invert.measurement = as_const(single), invert.noise = as_const(noise.out);
        invert.mean = b.out(i, 1, items), invert.covariance = b.out(i, i, items);
        watched(b, "invert", [&] { return sensor.call(&plr_sensor::invert, b.call, invert); });
    }
}

void exercise_estimator(Bench& b, const plr_part& part) {
    const EstimatorPart estimator(part);
    const auto& info = estimator.info();
    const std::int64_t n = info.state->size, c = info.cartesian->size, r = info.record_size;
    const std::vector<std::int32_t> known = {0, 1};
    auto init = args<plr_estimator_init>();
    init.known = 2, init.components = known.data();
    const plr_view record = b.out(r, 1, items);
    init.mean = const_view(b.array(2 * items, 1200.0), 2, 1, items), init.covariance = b.diagonal(2, items, 25.0);
    init.record = record;
    watched(b, "init", [&] { return estimator.call(&plr_estimator::init, b.call, init); });
    auto predict = args<plr_estimator_predict>();
    predict.dt = b.seconds(1.0), predict.record = as_const(record), predict.out = record;
    predict.extent = b.diagonal(3, items, 4.0);
    watched(b, "predict", [&] { return estimator.call(&plr_estimator::predict, b.call, predict); });
    for (std::uint32_t s = 0; s < info.sensor_count; ++s) {
        const SensorPart sensor(info.sensors[s]);
        const std::int64_t m = sensor.info().measurement->size;
        auto project = args<plr_estimator_project>();
        project.sensor = static_cast<std::int32_t>(s), project.record = as_const(record);
        project.measurement = b.out(m, 1, items), project.covariance = b.out(m, m, items);
        project.cross = b.out(n, m, items), project.cartesian_cross = b.out(c, m, items);
        watched(b, "project", [&] { return estimator.call(&plr_estimator::project, b.call, project); });
        auto update = args<plr_estimator_update>();
        update.sensor = project.sensor, update.record = as_const(record), update.out = record;
        update.measurement = as_const(project.measurement), update.noise = b.diagonal(m, items, 1e-4);
        update.log_likelihood = b.out(1, 1, items), update.innovation = b.out(m, 1, items);
        update.innovation_covariance = b.out(m, m, items);
        watched(b, "update", [&] { return estimator.call(&plr_estimator::update, b.call, update); });
    }
    auto moments = args<plr_estimator_moments>();
    moments.record = as_const(record), moments.mean = b.out(n, 1, items), moments.covariance = b.out(n, n, items);
    watched(b, "moments", [&] { return estimator.call(&plr_estimator::moments, b.call, moments); });
    auto summary = args<plr_estimator_moments>();
    summary.record = as_const(record), summary.mean = b.out(c, 1, items), summary.covariance = b.out(c, c, items);
    watched(b, "summary", [&] { return estimator.call(&plr_estimator::summary, b.call, summary); });
    if ((info.flags & PLR_ESTIMATOR_ASSIGNABLE) != 0) {
        auto assign = args<plr_estimator_assign>();
        assign.record = as_const(record), assign.mean = as_const(moments.mean);
        assign.covariance = as_const(moments.covariance), assign.out = record;
        watched(b, "assign", [&] { return estimator.call(&plr_estimator::assign, b.call, assign); });
    }
    if (const auto* mix = estimator.extension<plr_estimator_mix>(PLR_ESTIMATOR_MIX)) {
        auto a = args<plr_estimator_mix_args>();
        double* weights = b.array(2 * items, 0.5);
        double* records = b.array(2 * r * items);
        for (std::int64_t i = 0; i < items; ++i)
            for (int k = 0; k < 2; ++k)
                std::memcpy(records + (2 * i + k) * r, record.data + i * r,
                            static_cast<std::size_t>(r) * sizeof(double));
        a.weights = const_view(weights, 2, 1, items), a.records = const_view(records, r, 2, items),
        a.out = b.out(r, 1, items);
        watched(b, "mix", [&] { return mix->mix(estimator.self(), &b.call, &a); });
    }
}

/// Ten points an object, spread over a few metres.
struct Cloud {
    std::vector<std::int64_t> offsets;
    plr_extent_points points{};
    Cloud(Bench& b, std::int64_t d) {
        const std::int64_t each = 10;
        for (std::int64_t i = 0; i <= items; ++i) offsets.push_back(i * each);
        double* xyz = b.array(d * each * items);
        for (std::int64_t k = 0; k < each * items; ++k)
            for (std::int64_t axis = 0; axis < d; ++axis)
                xyz[k * d + axis] =
                    1000.0 + static_cast<double>(((7 * k * k + 5 * k * axis + 11 * axis * axis) % 19) - 9) *
                                 (1.0 + static_cast<double>(axis));
        double* noise = b.array(d * d);
        for (std::int64_t axis = 0; axis < d; ++axis) noise[axis * d + axis] = 1.0;
        points = {offsets.data(), const_view(xyz, d, 1, each * items), common_view(noise, d, d, each * items),
                  absent_view()};
    }
};

void exercise_joint(Bench& b, const ExtentPart& extent, const plr_extent_joint& joint, const Cloud& cloud) {
    const auto& info = extent.info();
    const std::int64_t d = info.dimension, r = info.record_size, c = joint.cartesian->size;
    const plr_view record = b.out(r, 1, items);
    const std::vector<plr_extent_points> scans(static_cast<std::size_t>(std::max(info.start_scans, 1)), cloud.points);
    double* times = b.array(static_cast<std::int64_t>(scans.size()));
    for (std::size_t i = 0; i < scans.size(); ++i) times[i] = static_cast<double>(i);
    auto init = args<plr_joint_init>();
    init.scans = static_cast<std::uint32_t>(scans.size()), init.scan = scans.data();
    init.times = const_view(times, static_cast<std::int64_t>(scans.size()), 1, 1);
    init.mean = const_view(b.array(c * items, 10.0), c, 1, items), init.covariance = b.diagonal(c, items, 25.0),
    init.record = record;
    watched(b, "joint init", [&] { return joint.init(extent.self(), &b.call, &init); });
    auto predict = args<plr_joint_predict>();
    predict.dt = b.seconds(1.0), predict.record = as_const(record), predict.out = record;
    watched(b, "joint predict", [&] { return joint.predict(extent.self(), &b.call, &predict); });
    auto update = args<plr_joint_update>();
    update.scan = cloud.points, update.record = as_const(record), update.out = record;
    update.log_likelihood = b.out(1, 1, items), update.innovation = b.out(d, 1, items),
    update.innovation_covariance = b.out(d, d, items);
    watched(b, "joint update", [&] { return joint.update(extent.self(), &b.call, &update); });
    auto summary = args<plr_joint_summary>();
    summary.record = as_const(record), summary.mean = b.out(c, 1, items), summary.covariance = b.out(c, c, items);
    watched(b, "joint summary", [&] { return joint.summary(extent.self(), &b.call, &summary); });
    auto shape = args<plr_extent_shape>();
    shape.record = as_const(record), shape.matrix = b.out(d, d, items);
    watched(b, "shape", [&] { return extent.call(&plr_extent::shape, b.call, shape); });
}

void exercise_extent(Bench& b, const plr_part& part) {
    const ExtentPart extent(part);
    const auto& info = extent.info();
    const std::int64_t d = info.dimension, r = info.record_size, c = 3 * d;
    const Cloud cloud(b, d);
    if (const auto* joint = extent.extension<plr_extent_joint>(PLR_EXTENT_JOINT))
        return exercise_joint(b, extent, *joint, cloud);
    const plr_view record = b.out(r, 1, items);
    const std::vector<plr_extent_points> scans(static_cast<std::size_t>(info.start_scans), cloud.points);
    double* times = b.array(info.start_scans);
    for (int i = 0; i < info.start_scans; ++i) times[i] = i;
    auto init = args<plr_extent_init>();
    init.scans = static_cast<std::uint32_t>(info.start_scans), init.scan = scans.data();
    init.times = const_view(times, info.start_scans, 1, 1), init.record = record;
    watched(b, "init", [&] { return extent.call(&plr_extent::init, b.call, init); });
    const plr_const_view kinematics = const_view(b.array(c * items, 7.0), c, 1, items);
    auto predict = args<plr_extent_predict>();
    predict.dt = b.seconds(1.0), predict.before = kinematics, predict.after = kinematics;
    predict.record = as_const(record), predict.out = record;
    watched(b, "predict", [&] { return extent.call(&plr_extent::predict, b.call, predict); });
    auto noise = args<plr_extent_effective_noise>();
    noise.record = as_const(record), noise.noise = b.diagonal(d, items, 1.0);
    noise.number = const_view(b.array(items, 10.0), 1, 1, items), noise.out = b.out(d, d, items);
    watched(b, "effective_noise", [&] { return extent.call(&plr_extent::effective_noise, b.call, noise); });
    auto gate = args<plr_extent_gate>();
    gate.record = as_const(record), gate.predicted = const_view(b.array(d * items, 1000.0), d, 1, items);
    gate.covariance = b.diagonal(d, items, 4.0), gate.scan = cloud.points;
    gate.squared_distance = b.out(1, 1, cloud.points.points.count);
    watched(b, "gate", [&] { return extent.call(&plr_extent::gate, b.call, gate); });
    auto update = args<plr_extent_update>();
    update.scan = cloud.points, update.innovation = const_view(b.array(d * items, 0.5), d, 1, items);
    update.innovation_covariance = b.diagonal(d, items, 5.0), update.kinematics = kinematics;
    update.record = as_const(record), update.out = record, update.log_likelihood = b.out(1, 1, items);
    watched(b, "update", [&] { return extent.call(&plr_extent::update, b.call, update); });
    auto shape = args<plr_extent_shape>();
    shape.record = as_const(record), shape.matrix = b.out(d, d, items);
    shape.half_axes = b.out(d, 1, items), shape.axes = b.out(d, d, items);
    watched(b, "shape", [&] { return extent.call(&plr_extent::shape, b.call, shape); });
}

void exercise_trajectory(Bench& b, const plr_part& part) {
    const TrajectoryPart trajectory(part);
    const auto& info = trajectory.info();
    const plr_view record = b.out(info.record_size, 1, 1);
    REQUIRE(trajectory.call(&plr_trajectory::realise, b.call, record) == PLR_OK);
    const std::vector<std::int64_t> times = {0, 1000000000, 60000000000};
    const auto t = static_cast<std::int64_t>(times.size()), d = static_cast<std::int64_t>(info.extent_dimension);
    const auto objects = static_cast<std::size_t>(info.objects);
    std::vector<std::uint64_t> ids(objects);
    std::vector<std::int64_t> parents(objects), births(objects), deaths(objects);
    auto states = args<plr_trajectory_states>();
    states.record = as_const(record), states.time_count = t, states.times = times.data();
    states.states = b.out(info.state->size, t, info.objects);
    states.extents = d > 0 ? b.out(d * d, t, info.objects) : absent_output();
    states.ids = ids.data(), states.parents = parents.data(), states.births = births.data(),
    states.deaths = deaths.data();
    watched(b, "states", [&] { return trajectory.call(&plr_trajectory::states, b.call, states); });
}

void exercise(Bench& b, const plr_part& part) {
    INFO(part.address << " (" << part.description->id << ")");
    const std::string table = part.table_id;
    if (table == PLR_MOTION)
        exercise_motion(b, part);
    else if (table == PLR_SENSOR)
        exercise_sensor(b, part);
    else if (table == PLR_ESTIMATOR)
        exercise_estimator(b, part);
    else if (table == PLR_EXTENT)
        exercise_extent(b, part);
    else if (table == PLR_TRAJECTORY)
        exercise_trajectory(b, part);
    else
        FAIL("no exercise for the table " << table);
}

/// A pipeline that holds every model under test, in a file of its own (configs are files).
graph::Graph build(const std::string& text, host::GuardMode guard) {
    const auto file =
        std::filesystem::temp_directory_path() / ("pelorus_hot_calls_" + std::to_string(::getpid()) + ".yaml");
    std::ofstream(file) << text;
    static host::Catalog catalog({PELORUS_PLUGIN_DIR});  // outlives the graphs, which use its plugins
    const auto document = graph::Document::load(file);
    std::filesystem::remove(file);
    graph::BuildOptions options;
    options.guard = guard;
    return graph::Graph::build(document, catalog, options);
}

std::string airship(const std::string& tracker_parts) {
    return R"(
pelorus: 1
graph:
  world:
    use: source.simulation
    with: {scans: 3, period: 1 s}
    parts:
      targets:
        airship:
          use: trajectory.legs
          with:
            start: [0 m, 0 m, 300 m]
            speed: 20 m/s
            heading: 45 deg
            semi_axes: [12 m, 5 m, 5 m]
            points_per_scan: 10
            legs: [{duration: 10 s, turn_rate: 2 deg/s}, {duration: 10 s, acceleration: 0.1 m/s2}]
      sensors:
        radar: {use: sensor.position, with: {noise: 1 m}}
        dish: {use: sensor.spherical, with: {noise: [10 m, 1 mrad, 1 mrad]}}
  tracker:
    use: tracker.extended_target
    in: {scans: world.scans}
    parts:
)" + tracker_parts;
}

std::string with_estimator(const std::string& motion, const std::string& extent) {
    return airship(
        "      estimator: {use: estimator.kalman, parts: {motion: " + motion +
        ", sensors: {radar: {like: world.sensors.radar}, dish: {like: world.sensors.dish}}}}\n      extent: " + extent +
        "\n");
}

}  // namespace

TEST_CASE("an allocation is seen", "[release-only]") {
    const std::uint64_t before = test::allocations();
    const auto block = std::make_unique<std::vector<int>>(1000);
    CHECK(block->size() == 1000);
    CHECK(test::allocations() - before == 2);
}

TEST_CASE("hot calls of all models allocate nothing", "[release-only]") {
    const auto config =
        GENERATE(as<std::string>{},  //
                 with_estimator("{use: motion.singer, with: {form: truncated}}",
                                "{use: extent.random_matrix, with: {update: published}}"),
                 with_estimator("{use: motion.singer, with: {form: exact}}",
                                "{use: extent.random_matrix, with: {update: feldmann, start: consistent}}"),
                 with_estimator("{use: motion.constant_velocity, with: {noise: [1, 2, 3]}}",
                                "{use: extent.random_matrix, with: {innovation_spread: symmetrised}}"),
                 with_estimator("{use: motion.constant_acceleration}",
                                "{use: extent.random_matrix, with: {innovation_spread: feldmann}}"),
                 with_estimator("{use: motion.ballistic, with: {maneuver_rate: 0.1, noise_over_extent: 0.01}}",
                                "{use: extent.group_random_matrix}"),
                 with_estimator("{use: motion.ballistic, with: {integration: held, acceleration: 0.02}}",
                                "{use: extent.random_matrix}"),
                 airship("      extent: {use: extent.random_matrix, with: {update: koch}, parts: {motion: "
                         "{use: motion.singer}, sensors: {radar: {like: world.sensors.radar}, "
                         "dish: {like: world.sensors.dish}}}}\n"));
    // A guarded call may allocate as long as it is checked, which the first ones are.
    const auto guard = GENERATE(host::GuardMode::off, host::GuardMode::start);
    const graph::Graph graph = build(config, guard);
    const std::vector<plr_part> models = graph.models();
    CHECK(models.size() >= 6);
    for (const plr_part& model : models) {
        for (int checked = 0; guard == host::GuardMode::start && checked < 16; ++checked) {
            Bench bench;
            bench.watches = false;
            exercise(bench, model);
        }
        Bench bench;
        exercise(bench, model);
    }
}
