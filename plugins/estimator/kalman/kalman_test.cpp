// The filter against known answers, against the textbook's formulas, and against statistics.
#include "../../../tests/support/estimator_under_test.hpp"
#include "../../../tests/support/reference.hpp"

#include <random>

#include <catch2/catch.hpp>
#include <Eigen/LU>
#include <pelorus/small_matrix.hpp>

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

double relative(const MatrixXd& a, const MatrixXd& b) {
    if (a.rows() != b.rows() || a.cols() != b.cols()) return std::numeric_limits<double>::infinity();
    return (a - b).cwiseAbs().maxCoeff() / std::max(1e-300, b.cwiseAbs().maxCoeff());
}

/// A motion, sensors, and the filter that holds them.
struct Filter {
    Filter(const std::string& motion_name, const Values& motion_values, const std::string& sensor_name,
           const Values& sensor_values)
        : motion("motion", motion_name, motion_values),
          sensor("sensor", sensor_name, sensor_values),
          instance("estimator", "kalman", {}, {{"motion", "", &motion}, {"sensors", "radar", &sensor}}),
          filter(instance) {}

    Batch predicted(double dt, const Batch& record) const {
        Call call(record.count);
        Batch out(filter.record_size(), 1, record.count);
        if (filter.predict(call, pelorus::common_view(&dt, 1, 1, record.count), record, out) != PLR_OK)
            throw std::runtime_error(call.message());
        if (call.scratch_used() != 0) throw std::runtime_error("scratch was not given back");
        return out;
    }
    /// Mean and covariance of item i.
    VectorXd mean(Batch& record, std::int64_t i = 0) const { return record[i].topRows(filter.n()); }
    MatrixXd covariance(Batch& record, std::int64_t i = 0) const {
        const std::int64_t n = filter.n();
        return Eigen::Map<MatrixXd>(record[i].data() + n, n, n);
    }

    Instance motion, sensor, instance;
    EstimatorUnderTest filter;
};

MatrixXd random_covariance(std::int64_t n, std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    const MatrixXd a = MatrixXd::NullaryExpr(n, n, [&] { return normal(engine); });
    return a * a.transpose() + MatrixXd::Identity(n, n);
}

/// F and Q of the motion itself, whose own test vouches for them.
std::pair<MatrixXd, MatrixXd> step_of(const Filter& f, double dt) {
    const auto motion = f.motion.as<pelorus::MotionPart>();
    const std::int64_t n = f.filter.n();
    const VectorXd zero = VectorXd::Zero(n);
    MatrixXd transition(n, n), noise(n, n);
    Call call;
    auto jacobian = pelorus::arguments<plr_motion_jacobian>();
    jacobian.dt = pelorus::const_view(&dt, 1, 1, 1);
    jacobian.state = pelorus::const_view(zero.data(), n, 1, 1);
    jacobian.out = pelorus::view(transition.data(), n, n, 1);
    REQUIRE(motion.call(&plr_motion::jacobian, call, jacobian) == PLR_OK);
    auto ask = pelorus::arguments<plr_motion_noise>();
    ask.dt = jacobian.dt;
    ask.out = pelorus::view(noise.data(), n, n, 1);
    REQUIRE(motion.call(&plr_motion::noise, call, ask) == PLR_OK);
    return {transition, noise};
}

/// ln N(e; 0, S).
double log_normal(const VectorXd& e, const MatrixXd& s) {
    const double squared = e.dot(s.inverse() * e);
    return -0.5 *
           (static_cast<double>(e.size()) * std::log(2.0 * std::acos(-1.0)) + std::log(s.determinant()) + squared);
}

}  // namespace

TEST_CASE("the extended filter's step agrees with the reference library", "[kalman]") {
    const auto answers = reference("models_and_filters.json");
    const auto& given = answers.at("filter case");
    const auto& expected = answers.at("filter EKF");
    // Theirs: (x, vx, y, vy, z, vz) and (elevation, azimuth, range).
    const std::vector<int> state{0, 2, 4, 1, 3, 5}, measurement{2, 1, 0}, column{0};
    const Filter f("constant_velocity", {{"noise", "1.0"}}, "spherical", {});
    const auto& filter = f.filter;
    Batch record = filter.record_of(reordered(matrix(given.at("x")), state, column),
                                    reordered(matrix(given.at("P")), state, state));
    record = f.predicted(given.at("dt").get<double>(), record);
    CHECK(relative(f.mean(record), reordered(matrix(expected.at("xp")), state, column)) < 1e-14);
    CHECK(relative(f.covariance(record), reordered(matrix(expected.at("Pp")), state, state)) < 1e-14);

    Call call;
    Batch seen(3, 1), projected(3, 3), cross(6, 3);
    REQUIRE(filter.project(call, 0, record, seen, projected, cross) == PLR_OK);
    CHECK(relative(seen[0], reordered(matrix(expected.at("zp")), measurement, column)) < 1e-12);
    const MatrixXd noise = reordered(matrix(given.at("R")), measurement, measurement);
    const MatrixXd innovation = reordered(matrix(expected.at("S")), measurement, measurement);
    // Their Jacobian is made of finite differences, good to 1e-8: what rests on it cannot agree better.
    CHECK(relative(projected[0] + noise, innovation) < 1e-8);

    Batch z(3, 1), out(filter.record_size(), 1);
    z[0] = reordered(matrix(given.at("z")), measurement, column);
    EstimatorUnderTest::Told told(3, 1);
    REQUIRE(filter.update(call, 0, record, z, pelorus::const_view(noise.data(), 3, 3, 1), out, told) == PLR_OK);
    CHECK(relative(told.covariance[0], innovation) < 1e-8);
    CHECK(relative(f.mean(out), reordered(matrix(expected.at("x")), state, column)) < 1e-9);
    CHECK(relative(f.covariance(out), reordered(matrix(expected.at("P")), state, state)) < 3e-8);

    // The same step by the textbook with the exact Jacobian.
    MatrixXd h = MatrixXd::Zero(3, 6);
    auto derive = pelorus::arguments<plr_sensor_jacobian>();
    derive.cartesian = pelorus::const_view(record.numbers.data(), 3, 1, 1);
    derive.out = pelorus::view(h.data(), 3, 3, 1);
    REQUIRE(f.sensor.as<pelorus::SensorPart>().call(&plr_sensor::jacobian, call, derive) == PLR_OK);
    const MatrixXd p = f.covariance(record), s = h * p * h.transpose() + noise, gain = p * h.transpose() * s.inverse();
    CHECK(relative(f.mean(out), f.mean(record) + gain * told.innovation[0]) < 1e-12);
    CHECK(relative(f.covariance(out), p - gain * s * gain.transpose()) < 1e-12);
    CHECK(relative(cross[0], p * h.transpose()) < 1e-12);
    CHECK(call.scratch_used() == 0);
}

TEST_CASE("predict, project and update are the textbook's formulas, for every size", "[kalman]") {
    struct Case {
        const char *motion, *dimension, *noise, *sensor_dimension;
    };
    // Fixed sizes (n 4, 6, 9 x m 2, 3), run-time ones, by structure and by full matrices (one noise an axis).
    const Case cases[] = {
        {"constant_velocity", "2", "0.5", "2"},          {"constant_velocity", "3", "0.5", "3"},
        {"constant_velocity", "3", "0.5", "2"},          {"constant_acceleration", "3", "0.5", "3"},
        {"constant_acceleration", "3", "0.5", "2"},      {"constant_acceleration", "2", "0.5", "2"},
        {"constant_velocity", "1", "0.5", "1"},          {"constant_acceleration", "1", "0.5", "1"},
        {"constant_velocity", "3", "0.5", "1"},          {"constant_velocity", "2", "[1, 2]", "2"},
        {"constant_velocity", "3", "[1, 2, 3]", "3"},    {"constant_acceleration", "3", "[1, 2, 3]", "3"},
        {"constant_acceleration", "3", "[1, 2, 3]", "2"}};
    std::mt19937_64 engine(1);
    std::normal_distribution<double> normal;
    for (const Case& one : cases) {
        CAPTURE(one.motion, one.dimension, one.noise, one.sensor_dimension);
        const Filter f(one.motion, {{"dimension", one.dimension}, {"noise", one.noise}}, "position",
                       {{"dimension", one.sensor_dimension}, {"position", "5"}});
        const auto& filter = f.filter;
        const std::int64_t n = filter.n(), m = filter.m(0);
        const VectorXd x = VectorXd::NullaryExpr(n, [&] { return 10.0 * normal(engine); });
        const MatrixXd p = random_covariance(n, engine);
        const double dt = 1.7;

        const auto [transition, noise] = step_of(f, dt);
        Call call;

        Batch record = f.predicted(dt, filter.record_of(x, p));
        const VectorXd xp = transition * x;
        const MatrixXd pp = transition * p * transition.transpose() + noise;
        CHECK(relative(f.mean(record), xp) < 1e-14);
        CHECK(relative(f.covariance(record), pp) < 1e-14);
        CHECK(f.covariance(record) == f.covariance(record).transpose());

        MatrixXd h = MatrixXd::Zero(m, n);
        h.leftCols(m).setIdentity();
        Batch seen(m, 1), projected(m, m), cross(n, m), cartesian_cross(n, m);
        REQUIRE(filter.project(call, 0, record, seen, projected, cross, &cartesian_cross) == PLR_OK);
        CHECK(cartesian_cross[0] == cross[0]);
        CHECK(relative(seen[0], h * xp - VectorXd::Constant(m, 5.0)) < 1e-14);
        CHECK(relative(projected[0], h * pp * h.transpose()) < 1e-14);
        CHECK(relative(cross[0], pp * h.transpose()) < 1e-14);

        const MatrixXd r = random_covariance(m, engine);
        Batch z(m, 1), out(filter.record_size(), 1);
        z[0] = VectorXd::NullaryExpr(m, [&] { return 10.0 * normal(engine); });
        EstimatorUnderTest::Told told(m, 1);
        REQUIRE(filter.update(call, 0, record, z, pelorus::const_view(r.data(), m, m, 1), out, told) == PLR_OK);
        const MatrixXd s = h * pp * h.transpose() + r, gain = pp * h.transpose() * s.inverse();
        const VectorXd e = z[0] - (h * xp - VectorXd::Constant(m, 5.0));
        CHECK(relative(told.innovation[0], e) < 1e-13);
        CHECK(relative(told.covariance[0], s) < 1e-13);
        CHECK(told.log_likelihood[0](0) == Approx(log_normal(e, s)).epsilon(1e-11));
        CHECK(relative(f.mean(out), xp + gain * e) < 1e-12);
        CHECK(relative(f.covariance(out), pp - gain * s * gain.transpose()) < 1e-12);
        CHECK(f.covariance(out) == f.covariance(out).transpose());
    }
}

TEST_CASE("a batch gives the bytes that single items give", "[kalman]") {
    const std::int64_t count = 37;  // more than one block, and no multiple of it
    for (const char* const noise : {"2.0", "[1, 2, 3]"}) {
        for (const bool common_step : {true, false}) {
            const Filter f("constant_velocity", {{"noise", noise}}, "spherical", {});
            const auto& filter = f.filter;
            std::mt19937_64 engine(7);
            std::normal_distribution<double> normal;
            Batch start(filter.record_size(), 1, count), z(3, 1, count), dt(1, 1, count), noises(3, 3, count);
            for (std::int64_t i = 0; i < count; ++i) {
                const VectorXd x = VectorXd::NullaryExpr(6, [&] { return 1000.0 + 100.0 * normal(engine); });
                start[i] = filter.record_of(x, random_covariance(6, engine))[0];
                z[i] << 1700.0 + 10.0 * normal(engine), 0.8, 0.6;
                dt[i](0) = common_step ? 1.25 : 0.5 + 0.01 * static_cast<double>(i / 3);
                noises[i] = Eigen::Vector3d(100.0, 1e-6, 1e-6).asDiagonal();
            }
            Call call(count);
            Batch batch(filter.record_size(), 1, count);
            EstimatorUnderTest::Told told(3, count);
            const plr_const_view steps = common_step ? pelorus::common_view(dt.numbers.data(), 1, 1, count) : dt.in();
            REQUIRE(filter.predict(call, steps, start, batch) == PLR_OK);
            Batch seen(3, 1, count), projected(3, 3, count), cross(6, 3, count);
            REQUIRE(filter.project(call, 0, batch, seen, projected, cross) == PLR_OK);
            REQUIRE(filter.update(call, 0, batch, z, noises.in(), batch, told) == PLR_OK);  // in place

            for (std::int64_t i = 0; i < count; ++i) {
                Call single;
                Batch record(filter.record_size(), 1), one(filter.record_size(), 1), measured(3, 1), s(3, 1), p(3, 3),
                    c(6, 3);
                EstimatorUnderTest::Told one_told(3, 1);
                record[0] = start[i];
                measured[0] = z[i];
                REQUIRE(filter.predict(single, pelorus::const_view(dt[i].data(), 1, 1, 1), record, one) == PLR_OK);
                REQUIRE(filter.project(single, 0, one, s, p, c) == PLR_OK);
                REQUIRE(filter.update(single, 0, one, measured, pelorus::const_view(noises[i].data(), 3, 3, 1), record,
                                      one_told) == PLR_OK);
                CHECK(batch[i] == record[0]);
                CHECK(seen[i] == s[0]);
                CHECK(projected[i] == p[0]);
                CHECK(cross[i] == c[0]);
                CHECK(told.log_likelihood[i] == one_told.log_likelihood[0]);
                CHECK(told.covariance[i] == one_told.covariance[0]);
            }
        }
    }
}

TEST_CASE("the filter's covariance tells its errors: NEES and NIS within their chi-square bounds", "[kalman]") {
    struct Case {
        const char *motion, *sensor;
        Values motion_values, sensor_values;
        double r, angle;
    };
    const Case cases[] = {{"constant_velocity", "position", {{"noise", "2"}}, {}, 25.0, 25.0},
                          {"singer", "position", {{"maneuver_rate", "0.2"}, {"acceleration", "3"}}, {}, 25.0, 25.0},
                          {"constant_velocity", "spherical", {{"noise", "2"}}, {}, 400.0, 1e-6}};
    for (const Case& one : cases) {
        CAPTURE(one.motion, one.sensor);
        const Filter f(one.motion, one.motion_values, one.sensor, one.sensor_values);
        const auto& filter = f.filter;
        const std::int64_t n = filter.n(), runs = 200;
        const int steps = 40;
        const auto sensor = f.sensor.as<pelorus::SensorPart>();
        const double dt = 1.0;
        const auto [transition, q] = step_of(f, dt);
        using Small = pelorus::small::Bounded<9, 9>;
        Small root = q;
        REQUIRE(pelorus::small::cholesky_semidefinite(Small(q), root));
        Call call;

        std::mt19937_64 engine(3);
        std::normal_distribution<double> normal;
        const auto draw = [&](std::int64_t size) {
            return VectorXd(VectorXd::NullaryExpr(size, [&] { return normal(engine); }));
        };
        const VectorXd spread = (VectorXd(n) << VectorXd::Constant(3, 30.0), VectorXd::Constant(n - 3, 3.0)).finished();
        const Eigen::Vector3d deviation(std::sqrt(one.r), std::sqrt(one.angle), std::sqrt(one.angle));
        const MatrixXd noise = deviation.cwiseAbs2().asDiagonal();
        double nees = 0.0, nis = 0.0;
        for (std::int64_t run = 0; run < runs; ++run) {
            VectorXd truth = VectorXd::Zero(n);
            truth.head(3) << 20e3, 15e3, 6e3;
            truth.segment(3, 3) << -50.0, 80.0, 5.0;
            Batch record = filter.record_of(truth + spread.cwiseProduct(draw(n)), spread.cwiseAbs2().asDiagonal());
            Batch z(3, 1);
            EstimatorUnderTest::Told told(3, 1);
            for (int k = 0; k < steps; ++k) {
                truth = transition * truth + root * draw(n);
                auto measure = pelorus::arguments<plr_sensor_measure>();
                measure.cartesian = pelorus::const_view(truth.data(), 3, 1, 1);
                measure.out = z.out();
                REQUIRE(sensor.call(&plr_sensor::measure, call, measure) == PLR_OK);
                z[0] += deviation.cwiseProduct(draw(3));
                record = f.predicted(dt, record);
                REQUIRE(filter.update(call, 0, record, z, pelorus::const_view(noise.data(), 3, 3, 1), record, told) ==
                        PLR_OK);
                const VectorXd e = told.innovation[0];
                nis += e.dot(told.covariance[0].inverse() * e) / (steps * static_cast<double>(runs));
            }
            const VectorXd error = f.mean(record) - truth;
            nees += error.dot(f.covariance(record).inverse() * error) / static_cast<double>(runs);
        }
        // The mean of k chi-square values of d degrees is normal about d with variance 2 d / k; 3.3 deviations: 0.1 %.
        const double nees_bound = 3.3 * std::sqrt(2.0 * static_cast<double>(n) / static_cast<double>(runs));
        const double nis_bound = 3.3 * std::sqrt(2.0 * 3.0 / (static_cast<double>(runs) * steps));
        CHECK(std::fabs(nees - static_cast<double>(n)) < nees_bound);
        CHECK(std::fabs(nis - 3.0) < nis_bound);
    }
}
