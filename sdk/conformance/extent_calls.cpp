#include "extent_calls.hpp"

#include <algorithm>
#include <array>

#include "machine/check.hpp"

namespace pelorus::conformance {

Eigen::Map<const Eigen::MatrixXd> PointsOfScan::of_item(std::int64_t i) const {
    const auto at = static_cast<std::size_t>(i);
    const std::int64_t first = points.offsets[at], end = points.offsets[at + 1];
    return {points.values.data() + first * points.rows, points.rows, end - first};
}

ExtentCalls::ExtentCalls(const Instance& instance_)
    : instance(instance_),
      table(instance_.table<plr_extent>()),
      joint(instance_.extension<plr_extent_joint>(PLR_EXTENT_JOINT)),
      info(*table.info(instance_.self())),
      d(info.dimension),
      c(joint == nullptr ? 2 * info.dimension : joint->cartesian->size) {}

namespace {

/// The three arguments of a scan, and how they become what the ABI passes.
void add(std::vector<Argument>& in, const PointsOfScan& scan) {
    in.insert(in.end(), {scan.points, scan.noise, scan.weights});
}
plr_extent_points points_at(const Views& views, std::size_t first) {
    return {views.offsets[first], views.in[first], views.in[first + 1], views.in[first + 2]};
}

}  // namespace

namespace {
constexpr std::size_t most_scans = 16;
}

HotCall ExtentCalls::init(const std::vector<PointsOfScan>& scans, const Argument& times, const Argument& mean,
                          const Argument& covariance) const {
    if (scans.size() > most_scans) skip("starts from more scans than the suite makes");
    HotCall call = make_call("init", scans.front().count());
    Argument common = times;
    common.is_common = true;
    call.in = {common, is_joint() ? mean : absent("mean"), is_joint() ? covariance : absent("covariance")};
    for (const PointsOfScan& scan : scans) add(call.in, scan);
    call.out = {output("record", info.record_size, 1, Content::opaque)};
    call.invoke = [own = &table, extension = joint, self = instance.self(), number = scans.size()](
                      const plr_call& context, const Views& v) {
        std::array<plr_extent_points, most_scans> scan;  // no vector: it is the plugin's allocations that are watched
        for (std::size_t s = 0; s < number; ++s) scan[s] = points_at(v, 3 + 3 * s);
        plr_const_view at = v.in[0];
        at.count = 1;
        const auto given = static_cast<std::uint32_t>(number);
        if (extension != nullptr) {
            const plr_joint_init args{sizeof args, given, scan.data(), at, v.in[1], v.in[2], v.out[0]};
            return extension->init(self, &context, &args);
        }
        const plr_extent_init args{sizeof args, given, scan.data(), at, v.out[0]};
        return own->init(self, &context, &args);
    };
    return call;
}

HotCall ExtentCalls::predict(const Argument& dt, const Argument& record, const Argument& before, const Argument& after,
                             const Argument& before_covariance, const Argument& after_covariance) const {
    HotCall call =
        make_call("predict", static_cast<std::int64_t>(record.values.size()) / std::max<std::int64_t>(1, record.rows));
    call.in = {dt, record};
    if (!is_joint()) call.in.insert(call.in.end(), {before, after, before_covariance, after_covariance});
    call.out = {output("out", info.record_size, 1, Content::opaque)};
    call.invoke = [own = &table, extension = joint, self = instance.self()](const plr_call& context, const Views& v) {
        if (extension != nullptr) {
            const plr_joint_predict args{sizeof args, 0, v.in[0], v.in[1], v.out[0]};
            return extension->predict(self, &context, &args);
        }
        const plr_extent_predict args{sizeof args, 0, v.in[0], v.in[2], v.in[4], v.in[3], v.in[5], v.in[1], v.out[0]};
        return own->predict(self, &context, &args);
    };
    return call;
}

HotCall ExtentCalls::effective_noise(const Argument& record, const Argument& noise, const Argument& number) const {
    HotCall call = make_call("effective_noise", static_cast<std::int64_t>(number.values.size()));
    call.in = {record, noise, number};
    call.out = {output("out", d, d, Content::covariance)};
    call.invoke = [own = &table, self = instance.self()](const plr_call& context, const Views& v) {
        const plr_extent_effective_noise args{sizeof args, 0, v.in[0], v.in[1], v.in[2], v.out[0]};
        return own->effective_noise(self, &context, &args);
    };
    return call;
}

HotCall ExtentCalls::update(const PointsOfScan& scan, const Argument& record, const Argument& innovation,
                            const Argument& innovation_covariance, const Argument& kinematics,
                            const Argument& kinematics_covariance) const {
    HotCall call = make_call("update", scan.count());
    call.in = {record};
    add(call.in, scan);
    call.out = {output("out", info.record_size, 1, Content::opaque), output("log_likelihood", 1, 1)};
    if (is_joint()) {
        call.out.push_back(output("innovation", d, 1));
        call.out.push_back(output("innovation_covariance", d, d, Content::covariance));
    } else {
        call.in.insert(call.in.end(), {innovation, innovation_covariance, kinematics, kinematics_covariance});
    }
    call.invoke = [own = &table, extension = joint, self = instance.self()](const plr_call& context, const Views& v) {
        const plr_extent_points points = points_at(v, 1);
        if (extension != nullptr) {
            const plr_joint_update args{sizeof args, 0, points, v.in[0], v.out[0], v.out[1], v.out[2], v.out[3]};
            return extension->update(self, &context, &args);
        }
        const plr_extent_update args{sizeof args, 0,       points,  v.in[4],  v.in[5],
                                     v.in[6],     v.in[7], v.in[0], v.out[0], v.out[1]};
        return own->update(self, &context, &args);
    };
    return call;
}

HotCall ExtentCalls::shape(const Argument& record) const {
    HotCall call =
        make_call("shape", static_cast<std::int64_t>(record.values.size()) / std::max<std::int64_t>(1, record.rows));
    call.in = {record};
    call.out = {output("matrix", d, d, Content::covariance), output("half_axes", d, 1), output("axes", d, d)};
    call.invoke = [own = &table, self = instance.self()](const plr_call& context, const Views& v) {
        const plr_extent_shape args{sizeof args, 0, v.in[0], v.out[0], v.out[1], v.out[2]};
        return own->shape(self, &context, &args);
    };
    return call;
}

HotCall ExtentCalls::gate(const PointsOfScan& scan, const Argument& record, const Argument& predicted,
                          const Argument& covariance) const {
    HotCall call = make_call("gate", scan.count());
    call.in = {record, is_joint() ? absent("predicted") : predicted, is_joint() ? absent("covariance") : covariance};
    add(call.in, scan);
    call.out = {output("squared_distance", 1, 1)};
    call.out[0].offsets = scan.points.offsets;
    call.invoke = [own = &table, extension = joint, self = instance.self()](const plr_call& context, const Views& v) {
        const plr_extent_gate args{sizeof args, 0, v.in[0], v.in[1], v.in[2], points_at(v, 3), v.out[0]};
        return extension != nullptr ? extension->gate(self, &context, &args) : own->gate(self, &context, &args);
    };
    return call;
}

HotCall ExtentCalls::summary(const Argument& record) const {
    HotCall call =
        make_call("summary", static_cast<std::int64_t>(record.values.size()) / std::max<std::int64_t>(1, record.rows));
    call.in = {record};
    call.out = {output("mean", c, 1), output("covariance", c, c, Content::covariance)};
    call.invoke = [extension = joint, self = instance.self()](const plr_call& context, const Views& v) {
        const plr_joint_summary args{sizeof args, 0, v.in[0], v.out[0], v.out[1]};
        return extension->summary(self, &context, &args);
    };
    return call;
}

Body sample_body(const ExtentCalls& calls, Sample& sample) {
    const std::int64_t d = calls.d;
    Body body;
    body.centre = Eigen::VectorXd(d);
    body.velocity = Eigen::VectorXd(d);
    Eigen::VectorXd squares(d);
    for (std::int64_t k = 0; k < d; ++k) {
        body.centre(k) = sample.uniform(-2e4, 2e4);
        body.velocity(k) = sample.uniform(-30.0, 30.0);
        const double half_axis = sample.uniform(0.8, 1.2) * (k == 0 ? 30.0 : 14.0);
        squares(k) = half_axis * half_axis;
    }
    // The long axis lies along the velocity, as that of ships and aircraft does: an extent may take it so.
    Eigen::MatrixXd axes = sample.rotation(static_cast<int>(d));
    const Eigen::VectorXd bisector = axes.col(0) - body.velocity.normalized();
    if (bisector.norm() > 1e-6) axes -= bisector * (bisector.transpose() * axes).eval() * (2 / bisector.squaredNorm());
    const Eigen::MatrixXd scaled = axes * squares.asDiagonal();
    body.shape = scaled * axes.transpose();
    body.shape = 0.5 * (body.shape + body.shape.transpose()).eval();
    body.noise = sample.covariance(Eigen::VectorXd::Constant(d, 1.0));
    return body;
}

PointsOfScan sample_scan(const std::vector<Body>& bodies, const std::vector<std::int64_t>& points, Sample& sample) {
    const std::int64_t d = bodies.front().centre.size();
    PointsOfScan scan;
    std::vector<std::int64_t> offsets{0};
    for (std::size_t i = 0; i < bodies.size(); ++i) offsets.push_back(offsets.back() + points[i]);
    const auto body_of = [&](std::int64_t point) -> const Body& {
        const auto after = std::upper_bound(offsets.begin(), offsets.end(), point);
        return bodies[static_cast<std::size_t>(after - offsets.begin() - 1)];
    };
    scan.points = input("points", d, 1, offsets.back(), [&](double* out, std::int64_t k) {
        const Body& body = body_of(k);
        Eigen::Map<Eigen::VectorXd>(out, d) = sample.normal(body.centre, Eigen::MatrixXd(body.shape + body.noise));
    });
    scan.noise = input("point noise", d, d, offsets.back(),
                       [&](double* out, std::int64_t k) { Eigen::Map<Eigen::MatrixXd>(out, d, d) = body_of(k).noise; });
    scan.points.offsets = scan.noise.offsets = offsets;
    scan.weights = absent("weights");
    return scan;
}

Argument kinematics_of(const ExtentCalls& calls, const std::string& name, const std::vector<Body>& bodies,
                       double seconds) {
    return input(name, calls.c, 1, static_cast<std::int64_t>(bodies.size()), [&](double* out, std::int64_t i) {
        const Body& body = bodies[static_cast<std::size_t>(i)];
        Eigen::Map<Eigen::VectorXd> x(out, calls.c);
        x.setZero();
        x.head(calls.d) = body.centre + seconds * body.velocity;
        if (calls.c >= 2 * calls.d) x.segment(calls.d, calls.d) = body.velocity;
    });
}

StartedExtents start_extents(const ExtentCalls& calls, const std::vector<Body>& bodies, Sample& sample) {
    const std::int64_t scans = calls.info.start_scans;
    std::vector<PointsOfScan> scan;
    for (std::int64_t s = 0; s < scans; ++s) {
        std::vector<Body> then = bodies;
        for (Body& body : then) body.centre -= static_cast<double>(scans - 1 - s) * body.velocity;
        std::vector<std::int64_t> points;
        for (std::size_t i = 0; i < bodies.size(); ++i)
            points.push_back(calls.info.start_points + 3 + static_cast<std::int64_t>(sample.below(6)));
        scan.push_back(sample_scan(then, points, sample));
    }
    const Argument times = input("times", scans, 1, 1, [&](double* out, std::int64_t) {
        for (std::int64_t s = 0; s < scans; ++s) out[s] = static_cast<double>(s);
    });
    const Argument covariance =
        input("covariance", calls.c, calls.c, static_cast<std::int64_t>(bodies.size()), [&](double* out, std::int64_t) {
            Eigen::Map<Eigen::MatrixXd>(out, calls.c, calls.c) = 4.0 * Eigen::MatrixXd::Identity(calls.c, calls.c);
        });
    StartedExtents started;
    started.call = calls.init(scan, times, kinematics_of(calls, "mean", bodies), covariance);
    Argument record = started.call.out[0];
    record.values = execute_leniently(calls.instance, started.call).out[0];
    started.record = record;
    return started;
}

namespace {

std::vector<HotCall> all_calls(const Instance& instance, Sample sample, std::int64_t count) {
    const ExtentCalls calls(instance);
    std::vector<Body> bodies;
    std::vector<std::int64_t> points;
    for (std::int64_t i = 0; i < count; ++i) {
        bodies.push_back(sample_body(calls, sample));
        points.push_back(2 + static_cast<std::int64_t>(sample.below(9)));
    }
    const StartedExtents started = start_extents(calls, bodies, sample);
    const PointsOfScan scan = sample_scan(bodies, points, sample);
    const Argument dt = input("dt", 1, 1, count, [&](double* out, std::int64_t) { *out = sample.uniform(0.05, 2.0); });
    const Argument before = kinematics_of(calls, "before", bodies), after = kinematics_of(calls, "after", bodies, 1.0);
    const auto small = [&](const std::string& name, std::int64_t size, double deviation) {
        return input(name, size, size, count, [&](double* out, std::int64_t) {
            Eigen::Map<Eigen::MatrixXd>(out, size, size) =
                sample.covariance(Eigen::VectorXd::Constant(size, deviation));
        });
    };
    const auto vectors = [&](const std::string& name, double deviation) {
        return input(name, calls.d, 1, count, [&](double* out, std::int64_t) {
            for (std::int64_t k = 0; k < calls.d; ++k) out[k] = sample.normal(0, deviation);
        });
    };
    const Argument position = input("predicted", calls.d, 1, count, [&](double* out, std::int64_t i) {
        Eigen::Map<Eigen::VectorXd>(out, calls.d) = bodies[static_cast<std::size_t>(i)].centre;
    });
    std::vector<HotCall> all{
        started.call,
        calls.predict(dt, started.record, before, after, small("before_covariance", calls.c, 2.0),
                      small("after_covariance", calls.c, 2.0)),
        calls.update(scan, started.record, vectors("innovation", 5.0), small("innovation_covariance", calls.d, 8.0),
                     after, small("kinematics_covariance", calls.c, 2.0)),
        calls.shape(started.record), calls.gate(scan, started.record, position, small("covariance", calls.d, 2.0))};
    PointsOfScan weighted = scan;
    weighted.weights = input("weights", 1, 1, scan.points.offsets.back(),
                             [&](double* out, std::int64_t) { *out = sample.uniform(0.1, 1.0); });
    weighted.weights.offsets = scan.points.offsets;
    for (std::size_t i = 0; i + 1 < scan.points.offsets.size(); ++i) {
        double* const first = weighted.weights.values.data() + scan.points.offsets[i];
        Eigen::Map<Eigen::VectorXd> own(first, scan.points.offsets[i + 1] - scan.points.offsets[i]);
        own /= own.sum();
    }
    HotCall update = all[2];
    for (Argument& argument : update.in)
        if (argument.name == "weights") argument = weighted.weights;
    update.function = "update (weighted points)";
    all.push_back(update);
    if (calls.is_joint()) {
        all.push_back(calls.summary(started.record));
    } else {
        all.push_back(calls.effective_noise(started.record, small("noise", calls.d, 1.0),
                                            input("number", 1, 1, count, [&](double* out, std::int64_t) {
                                                *out = 1.0 + static_cast<double>(sample.below(20));
                                            })));
        all.push_back(
            calls.predict(dt, started.record, before, after, absent("before_covariance"), absent("after_covariance")));
        all.back().function = "predict (covariances unknown)";
    }
    return all;
}

const detail::KindRegistration registration(PLR_EXTENT, all_calls, [](const Instance& instance) {
    return instance.table<plr_extent>().info(instance.self())->scratch_bytes;
});

}  // namespace

}  // namespace pelorus::conformance
