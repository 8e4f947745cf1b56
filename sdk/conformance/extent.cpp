// The laws of extents, plain and joint, at one step.
#include <cmath>
#include <cstring>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "extent_bench.hpp"
#include "machine/bench.hpp"
#include "machine/check.hpp"
#include "machine/guarded_memory.hpp"
#include "machine/library.hpp"

namespace pelorus::conformance {

namespace {

/// Sums of some dozen squares and a few decompositions of matrices of a condition below 1e3.
constexpr double rounding = 1e-9;

void same_bits(const std::string& what, const std::vector<double>& one, const std::vector<double>& other) {
    for (std::size_t e = 0; e < one.size(); ++e)
        if (!GuardedMemory::is_pattern(one[e]) && std::memcmp(&one[e], &other[e], sizeof(double)) != 0)
            FAIL(what << ": element " << e << " of the record is not the same");
}

/// Fails unless two matrices agree to `tolerance` of the second's size.
void same_matrix(const std::string& what, const Eigen::MatrixXd& told, const Eigen::MatrixXd& expected,
                 double tolerance) {
    if ((told - expected).norm() <= tolerance * expected.norm()) return;
    const Eigen::IOFormat row(Eigen::StreamPrecision, Eigen::DontAlignCols, ", ", "; ", "", "", "[", "]");
    FAIL(what << " is " << told.format(row) << ", expected " << expected.format(row));
}

}  // namespace

PELORUS_CHECK(extent, "extent-start-as-declared", 2,
              "init takes start_scans scans of at least start_points points each; with fewer points it fails that "
              "object, with PLR_E_NUMERIC, and not its neighbours.",
              {"numbers-finite"}) {
    const auto instance = bench.make();
    const ExtentBench extent(*instance);
    if (extent.info.start_scans < 1 || extent.info.start_scans > 2)
        FAIL("info.start_scans is " << extent.info.start_scans << ", expected 1 or 2");
    if (extent.info.start_points < 1)
        FAIL("info.start_points is " << extent.info.start_points << ", expected 1 or more");
    Sample sample = bench.sample();
    const std::vector<Body> bodies = extent.bodies(sample, 3);
    const std::int64_t least = extent.info.start_points;
    // Just as many as it wants, in general position, are enough.
    Execution done = execute(*instance, extent.start_call(bodies, {least, least, least}, sample));
    if (done.status != PLR_OK)
        FAIL("init with just start_points (" << least << ") points a scan answered " << done.told());
    done = execute(*instance, extent.start_call(bodies, {least + 3, least - 1, least + 3}, sample));
    if (done.status != PLR_ITEMS_FAILED || done.items[1] != PLR_E_NUMERIC || done.failed(0) || done.failed(2))
        FAIL("init of three objects, the second with "
             << least - 1 << " points a scan (start_points is " << least << "): answered " << status_name(done.status)
             << ", items " << status_name(done.items[0]) << ", " << status_name(done.items[1]) << ", "
             << status_name(done.items[2]) << "; expected PLR_E_NUMERIC for the second alone");
}

PELORUS_CHECK(extent, "extent-in-place-same-bits", 2,
              "predict and update give the same bits where `out` is `record` itself; trackers call them so.",
              {"numbers-finite"}) {
    const auto instance = bench.make();
    for (HotCall call : hot_calls(*instance, bench.sample(), 4)) {
        std::size_t record = 0;
        while (record < call.in.size() && call.in[record].name != "record") ++record;
        if (record == call.in.size() || call.out[0].name != "out" || call.out[0].content != Content::opaque) continue;
        const Execution apart = execute_well(*instance, call);
        call.invoke = [invoke = call.invoke, record](const plr_call& context, const Views& v) {
            const plr_const_view& from = v.in[record];
            std::copy_n(from.data, from.rows * from.count, v.out[0].data);
            Views views = v;
            views.in[record].data = v.out[0].data;
            return invoke(context, views);
        };
        same_bits(call.function + " with out == record", apart.out[0], execute_well(*instance, call).out[0]);
    }
}

PELORUS_CHECK(extent, "extent-no-points-copies", 2,
              "An update without points copies the record, bit for bit: what was not seen has not changed its shape.",
              {"numbers-finite"}) {
    const auto instance = bench.make();
    const ExtentBench extent(*instance);
    Sample sample = bench.sample();
    const std::vector<Body> bodies = extent.bodies(sample, 3);
    const Argument record = extent.predicted(extent.start(bodies, sample), bodies, 1.0);
    const HotCall call = extent.update_call(record, bodies, sample_scan(bodies, {6, 0, 6}, sample));
    const Execution done = execute_well(*instance, call);
    same_bits("update of an object without points", HotCall::item_of(record, record.values, 1),
              HotCall::item_of(call.out[0], done.out[0], 1));
    for (const std::int64_t seen : {0, 2})
        if (HotCall::item_of(record, record.values, seen) == HotCall::item_of(call.out[0], done.out[0], seen))
            FAIL("update of an object with 6 points leaves its record as it was");
}

PELORUS_CHECK(extent, "extent-shape-consistent", 3,
              "half_axes and axes are those of matrix: descending, unit vectors at right angles, and multiplied out "
              "they are it again.",
              {"covariances-positive"}) {
    const auto instance = bench.make();
    const ExtentBench extent(*instance);
    Sample sample = bench.sample();
    const std::vector<Body> bodies = extent.bodies(sample, 5);
    const HotCall call = extent.shape(extent.start(bodies, sample));
    const Execution done = execute_well(*instance, call);
    for (std::int64_t i = 0; i < call.count; ++i) {
        const Shape shape = extent.shape_at(call, done, i);
        const auto d = static_cast<Eigen::Index>(extent.d);
        for (Eigen::Index k = 0; k < d; ++k) {
            if (!(shape.half_axes(k) > 0)) FAIL("half_axes[" << k << "] is " << shape.half_axes(k) << " m");
            if (k > 0 && shape.half_axes(k) > shape.half_axes(k - 1) * (1 + rounding))
                FAIL("half_axes are " << shape.half_axes.transpose() << ", expected descending");
        }
        same_matrix("axes' axes", shape.axes.transpose() * shape.axes, Eigen::MatrixXd::Identity(d, d), rounding);
        same_matrix("axes diag(half_axes^2) axes', compared with `matrix`,",
                    shape.axes * shape.half_axes.cwiseAbs2().asDiagonal() * shape.axes.transpose(), shape.matrix,
                    rounding);
    }
}

PELORUS_CHECK(extent, "extent-stays-positive", 3,
              "The shape stays symmetric positive definite through starts, predictions and updates with few, many and "
              "far points; a tracker divides by it.",
              {"covariances-positive"}) {
    const auto instance = bench.make();
    const ExtentBench extent(*instance);
    Sample sample = bench.sample();
    std::vector<Body> bodies = extent.bodies(sample, 4);
    bodies[1].shape *= 1e-4;  // smaller than what the sensor's noise makes of it
    bodies[2].noise *= 25.0;
    Argument record = extent.start(bodies, sample);
    for (int k = 0; k < 60; ++k) {
        const double dt = sample.uniform(0.1, 3.0);
        record = extent.predicted(record, bodies, dt);
        for (Body& body : bodies) body.centre += dt * body.velocity;
        std::vector<std::int64_t> points;
        for (std::size_t i = 0; i < bodies.size(); ++i) points.push_back(static_cast<std::int64_t>(sample.below(12)));
        record = extent.updated(record, bodies, sample_scan(bodies, points, sample));
        const HotCall call = extent.shape(record);
        const Execution done = execute_well(*instance, call);
        for (std::int64_t i = 0; i < call.count; ++i) {
            const Eigen::MatrixXd matrix = extent.shape_at(call, done, i).matrix;
            const Eigen::VectorXd values =
                Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
            if (matrix != matrix.transpose() || !(values(0) > 0))
                FAIL("after " << k + 1 << " scans the shape of object " << i
                              << " is not symmetric positive definite: eigenvalues " << values.transpose() << " m2");
        }
    }
}

PELORUS_CHECK(extent, "extent-follows-rotation-and-shift", 3,
              "Points that are turned and shifted give the shape turned, the same likelihood and the same distances; "
              "no direction and no place is special.",
              {"covariances-positive", "extent-shape-consistent"}) {
    const auto instance = bench.make();
    const ExtentBench extent(*instance);
    Sample sample = bench.sample();
    const std::vector<Body> bodies = extent.bodies(sample, 3);
    const Eigen::MatrixXd turn = sample.rotation(static_cast<int>(extent.d));
    const Eigen::VectorXd shift = Eigen::VectorXd::Constant(extent.d, 500.0);
    const auto told = [&](const Motioned& seen) { return extent.whole_step(seen, bench.sample(1)); };
    const ExtentBench::StepAnswer here = told({bodies, Eigen::MatrixXd::Identity(extent.d, extent.d),
                                               Eigen::VectorXd::Zero(extent.d)}),
                                  there = told({bodies, turn, shift});
    // The points' own coordinates round at 1e-12 of 2e4 m, against half axes of 10 m.
    constexpr double turned = 1e-7;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        same_matrix("shape of turned points, turned back,", turn.transpose() * there.shapes[i] * turn, here.shapes[i],
                    turned);
        if (!(std::abs(there.log_likelihood[i] - here.log_likelihood[i]) <=
              turned * (1 + std::abs(here.log_likelihood[i]))))
            FAIL("update: log_likelihood of turned points is " << there.log_likelihood[i] << ", of the points "
                                                               << here.log_likelihood[i]);
    }
    for (std::size_t k = 0; k < here.distances.size(); ++k)
        if (!(std::abs(there.distances[k] - here.distances[k]) <= turned * (1 + here.distances[k])))
            FAIL("gate: squared_distance of a turned point is " << there.distances[k] << ", of the point "
                                                                << here.distances[k]);
}

PELORUS_CHECK(extent, "extent-equal-weights-are-none", 3,
              "Points of weight 1/n each are points without weights; probabilistic association gives such weights.",
              {"covariances-positive"}) {
    const auto instance = bench.make();
    const ExtentBench extent(*instance);
    Sample sample = bench.sample();
    const std::vector<Body> bodies = extent.bodies(sample, 3);
    const Argument record = extent.predicted(extent.start(bodies, sample), bodies, 1.0);
    PointsOfScan scan = sample_scan(bodies, {5, 8, 12}, sample);
    const auto plain = extent.shapes_of(extent.updated(record, bodies, scan));
    scan.weights = input("weights", 1, 1, 25, [](double* out, std::int64_t k) {
        *out = 1.0 / (k < 5 ? 5 : k < 13 ? 8 : 12);
    });
    scan.weights.offsets = scan.points.offsets;
    const auto weighted = extent.shapes_of(extent.updated(record, bodies, scan));
    for (std::size_t i = 0; i < bodies.size(); ++i)
        same_matrix("shape after an update with weights 1/n", weighted[i], plain[i], rounding);
}

PELORUS_CHECK(extent, "extent-effective-noise-shrinks", 3,
              "effective_noise falls as one over the number of points that are averaged, and a single point has at "
              "least the sensor's noise; the tracker's gain hangs on it.",
              {"covariances-positive"}) {
    const auto instance = bench.make();
    const ExtentBench extent(*instance);
    if (extent.is_joint()) skip("a joint extent keeps it to itself");
    Sample sample = bench.sample();
    const std::vector<Body> bodies = extent.bodies(sample, 1);
    const Argument record = extent.start(bodies, sample);
    const Argument noise = input("noise", extent.d, extent.d, 1, [&](double* out, std::int64_t) {
        Eigen::Map<Eigen::MatrixXd>(out, extent.d, extent.d) = bodies[0].noise;
    });
    const auto of = [&](double number) {
        const HotCall call = extent.effective_noise(
            record, noise, input("number", 1, 1, 1, [&](double* out, std::int64_t) { *out = number; }));
        const Execution done = execute_well(*instance, call);
        return Eigen::MatrixXd(Eigen::Map<const Eigen::MatrixXd>(done.out[0].data(), extent.d, extent.d));
    };
    const Eigen::MatrixXd one = of(1), more = one - bodies[0].noise;
    const double least = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(more, Eigen::EigenvaluesOnly).eigenvalues()(0);
    if (!(least >= -rounding * one.norm()))
        FAIL("effective_noise of a single point is smaller than the sensor's noise: least eigenvalue of the difference "
             << least << " m2");
    for (const double number : {2.0, 7.5, 100.0}) {
        std::ostringstream what;
        what << "effective_noise of " << number << " points, times " << number << ",";
        same_matrix(what.str(), number * of(number), one, rounding);
    }
}

PELORUS_CHECK(
    extent, "extent-gate-is-a-distance", 3,
    "The gate's squared distance is zero at the predicted position, grows with the square of the way from it, "
    "and for points of an object that is known well its mean is not above that of chi-square, the dimension (by more "
    "than half).",
    {"covariances-positive"}) {
    const auto instance = bench.make();
    const ExtentBench extent(*instance);
    Sample sample = bench.sample();
    const std::vector<Body> bodies = extent.bodies(sample, 1);
    const Argument record = extent.start(bodies, sample);
    const Eigen::VectorXd centre = extent.position_of(record, bodies[0]);
    const Eigen::VectorXd way = sample.rotation(static_cast<int>(extent.d)).col(0) * 10.0;
    PointsOfScan scan = sample_scan(bodies, {4}, sample);
    for (std::int64_t k = 0; k < 4; ++k)
        Eigen::Map<Eigen::VectorXd>(scan.points.values.data() + k * extent.d, extent.d) =
            centre + (k == 3 ? -1.0 : static_cast<double>(k)) * way;
    const std::vector<double> squares = extent.distances(record, bodies, scan);
    // Rounding of coordinates of 2e4 m against 10 m.
    if (!(std::abs(squares[0]) <= 1e-12)) FAIL("gate: squared_distance at the predicted position is " << squares[0]);
    for (const double square : squares)
        if (!(square >= 0)) FAIL("gate: a squared_distance is " << square);
    if (!(squares[1] > 0)) FAIL("gate: squared_distance is " << squares[1] << " 10 m from the predicted position");
    if (!(std::abs(squares[2] - 4 * squares[1]) <= 1e-6 * squares[2]) ||
        !(std::abs(squares[3] - squares[1]) <= 1e-6 * squares[1]))
        FAIL("gate: squared_distance is " << squares[1] << " at 10 m, " << squares[2] << " at 20 m and " << squares[3]
                                          << " at -10 m; expected d, 4 d and d");
    Argument known = record;
    for (int k = 0; k < 30; ++k) known = extent.updated(known, bodies, sample_scan(bodies, {30}, sample));
    constexpr std::int64_t count = 2000;
    double sum = 0;
    for (const double square : extent.distances(known, bodies, sample_scan(bodies, {count}, sample))) sum += square;
    const double mean = sum / static_cast<double>(count * extent.d);
    note("squared distances of points of the object are " + std::to_string(mean) + " a dimension");
    if (!(mean <= 1.5))
        FAIL("gate: squared distances of points of the object are " << mean << " a dimension on average, expected 1");
}

}  // namespace pelorus::conformance
