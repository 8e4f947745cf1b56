#include "extent_bench.hpp"

namespace pelorus::conformance {

namespace {

Argument matrices(const std::string& name, std::int64_t count, const Eigen::MatrixXd& value) {
    return input(name, value.rows(), value.cols(), count,
                 [&](double* out, std::int64_t) { std::copy_n(value.data(), value.size(), out); });
}

Body moved(const Body& body, const Motioned& seen) {
    Body out = body;
    out.centre = seen.turn * body.centre + seen.shift;
    out.velocity = seen.turn * body.velocity;
    out.shape = seen.turn * body.shape * seen.turn.transpose();
    out.noise = seen.turn * body.noise * seen.turn.transpose();
    out.noise = 0.5 * (out.noise + out.noise.transpose()).eval();
    return out;
}
std::vector<Body> moved(const Motioned& seen) {
    std::vector<Body> out;
    for (const Body& body : seen.bodies) out.push_back(moved(body, seen));
    return out;
}
/// The points of the bodies, moved with them.
PointsOfScan moved(PointsOfScan scan, const Motioned& seen) {
    const Eigen::Index d = seen.shift.size(), total = static_cast<Eigen::Index>(scan.points.values.size()) / d;
    for (Eigen::Index k = 0; k < total; ++k) {
        Eigen::Map<Eigen::VectorXd> point(scan.points.values.data() + k * d, d);
        point = (seen.turn * point + seen.shift).eval();
        Eigen::Map<Eigen::MatrixXd> noise(scan.noise.values.data() + k * d * d, d, d);
        const Eigen::MatrixXd turned = seen.turn * noise * seen.turn.transpose();
        noise = 0.5 * (turned + turned.transpose());
    }
    return scan;
}
Motioned as_they_are(const std::vector<Body>& bodies) {
    const Eigen::Index d = bodies.front().centre.size();
    return {bodies, Eigen::MatrixXd::Identity(d, d), Eigen::VectorXd::Zero(d)};
}

}  // namespace

std::vector<Body> ExtentBench::bodies(Sample& sample, int count) const {
    std::vector<Body> made;
    for (int i = 0; i < count; ++i) made.push_back(sample_body(*this, sample));
    return made;
}

Execution ExtentBench::well(const HotCall& call) const {
    // Who writes where it should not is found by the checks of all models; here there are many calls.
    ExecuteOptions plain;
    plain.is_guarded = false;
    return execute_well(instance, call, plain);
}

Argument ExtentBench::run(const HotCall& call) const {
    Argument record = call.out[0];
    record.name = "record";
    record.values = well(call).out[0];
    return record;
}

HotCall ExtentBench::start_call(const Motioned& seen, const std::vector<std::int64_t>& points, Sample& sample) const {
    const std::int64_t scans = info.start_scans, count = static_cast<std::int64_t>(seen.bodies.size());
    std::vector<PointsOfScan> scan;
    for (std::int64_t s = 0; s < scans; ++s) {
        std::vector<Body> then = seen.bodies;
        for (Body& body : then) body.centre -= static_cast<double>(scans - 1 - s) * body.velocity;
        scan.push_back(moved(sample_scan(then, points, sample), seen));
    }
    const Argument times = input("times", scans, 1, 1, [&](double* out, std::int64_t) {
        for (std::int64_t s = 0; s < scans; ++s) out[s] = static_cast<double>(s);
    });
    return init(scan, times, kinematics_of(*this, "mean", moved(seen)),
                matrices("covariance", count, 4.0 * Eigen::MatrixXd::Identity(c, c)));
}

HotCall ExtentBench::start_call(const std::vector<Body>& bodies, const std::vector<std::int64_t>& points,
                                Sample& sample) const {
    return start_call(as_they_are(bodies), points, sample);
}

Argument ExtentBench::start(const std::vector<Body>& bodies, Sample& sample) const {
    return run(start_call(bodies, std::vector<std::int64_t>(bodies.size(), info.start_points + 4), sample));
}

Argument ExtentBench::predicted(const Argument& record, const std::vector<Body>& bodies, double dt) const {
    Argument step = input("dt", 1, 1, 1, [&](double* out, std::int64_t) { *out = dt; });
    step.is_common = true;
    return run(predict(step, record, kinematics_of(*this, "before", bodies), kinematics_of(*this, "after", bodies, dt),
                       absent("before_covariance"), absent("after_covariance")));
}

HotCall ExtentBench::update_call(const Argument& record, const std::vector<Body>& bodies,
                                 const PointsOfScan& scan) const {
    const std::int64_t count = scan.count();
    const Argument innovation = input("innovation", d, 1, count, [&](double* out, std::int64_t i) {
        Eigen::Map<Eigen::VectorXd> e(out, d);
        e.setZero();
        if (scan.of_item(i).cols() > 0)
            e = scan.of_item(i).rowwise().mean() - bodies[static_cast<std::size_t>(i)].centre;
    });
    // As a tracker forms it: H P H' (here 1 m2) and the noise of the centroid.
    const Argument spread = input("innovation_covariance", d, d, count, [&](double* out, std::int64_t i) {
        const Body& body = bodies[static_cast<std::size_t>(i)];
        const auto points = static_cast<double>(std::max<std::int64_t>(1, scan.of_item(i).cols()));
        const Eigen::MatrixXd s = Eigen::MatrixXd::Identity(d, d) + (body.shape + body.noise) / points;
        Eigen::Map<Eigen::MatrixXd>(out, d, d) = 0.5 * (s + s.transpose());
    });
    return update(scan, record, innovation, spread, kinematics_of(*this, "kinematics", bodies),
                  absent("kinematics_covariance"));
}

Argument ExtentBench::updated(const Argument& record, const std::vector<Body>& bodies, const PointsOfScan& scan) const {
    return run(update_call(record, bodies, scan));
}

Shape ExtentBench::shape_at(const HotCall& call, const Execution& done, std::int64_t i) const {
    const auto of = [&](std::size_t output) {
        const Argument& argument = call.out[output];
        return Eigen::MatrixXd(Eigen::Map<const Eigen::MatrixXd>(
            done.out[output].data() + i * argument.rows * argument.cols, argument.rows, argument.cols));
    };
    return {of(0), of(1), of(2)};
}

std::vector<Eigen::MatrixXd> ExtentBench::shapes_of(const Argument& record) const {
    const HotCall call = shape(record);
    const Execution done = well(call);
    std::vector<Eigen::MatrixXd> shapes;
    for (std::int64_t i = 0; i < call.count; ++i) shapes.push_back(shape_at(call, done, i).matrix);
    return shapes;
}

Eigen::VectorXd ExtentBench::position_of(const Argument& record, const Body& body) const {
    if (!is_joint()) return body.centre;
    return Eigen::Map<const Eigen::VectorXd>(well(summary(record)).out[0].data(), d);
}

std::vector<double> ExtentBench::distances(const Argument& record, const std::vector<Body>& bodies,
                                           const PointsOfScan& scan) const {
    const Argument centre = input("predicted", d, 1, scan.count(), [&](double* out, std::int64_t i) {
        Eigen::Map<Eigen::VectorXd>(out, d) = bodies[static_cast<std::size_t>(i)].centre;
    });
    return well(gate(scan, record, centre, matrices("covariance", scan.count(), Eigen::MatrixXd::Identity(d, d))))
        .out[0];
}

ExtentBench::StepAnswer ExtentBench::whole_step(const Motioned& seen, Sample sample) const {
    const std::vector<std::int64_t> points(seen.bodies.size(), info.start_points + 4);
    Motioned now = seen;
    Argument record = run(start_call(now, points, sample));
    record = predicted(record, moved(now), 1.0);
    for (Body& body : now.bodies) body.centre += body.velocity;
    const PointsOfScan scan = moved(sample_scan(now.bodies, points, sample), now);
    const std::vector<Body> bodies = moved(now);
    StepAnswer answer;
    answer.distances = distances(record, bodies, scan);
    const HotCall call = update_call(record, bodies, scan);
    const Execution done = well(call);
    answer.log_likelihood = done.out[1];
    record.values = done.out[0];
    answer.shapes = shapes_of(record);
    return answer;
}

}  // namespace pelorus::conformance
