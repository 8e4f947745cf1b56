// What holds for the cubature, the unscented and the Gauss-Hermite filter alike.
#include "../../../tests/support/filter_under_test.hpp"
#include "../../../tests/support/log_polar_motion.hpp"

#include <random>

#include <catch2/catch.hpp>
#include <Eigen/Cholesky>
#include <Eigen/LU>

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

struct Kind {
    const char* name;
    Values values;
};

/// Every filter, with a rule of its own where it has parameters.
std::vector<Kind> kinds(const std::string& form) {
    return {{"cubature", {{"form", form}}},
            {"unscented", {{"form", form}}},
            // Centres of negative weight: one that makes nothing negative, and one that does.
            {"unscented", {{"form", form}, {"alpha", "0.01"}}},
            {"unscented", {{"form", form}, {"beta", "0"}, {"kappa", "-1"}}},
            {"gauss_hermite", {{"form", form}, {"order", "2"}}}};
}

std::vector<Kind> kinds_of_both_forms() {
    std::vector<Kind> both = kinds("square_root");
    for (const Kind& kind : kinds("covariance")) both.push_back(kind);
    return both;
}

MatrixXd random_covariance(std::int64_t n, std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    const MatrixXd a = MatrixXd::NullaryExpr(n, n, [&] { return normal(engine); });
    return a * a.transpose() + MatrixXd::Identity(n, n);
}

/// A target near (3, 4, 1) km and its covariance, of n components.
VectorXd place(std::int64_t n) {
    VectorXd x = VectorXd::Zero(n);
    x.head(3) << 3000.0, 4000.0, 1000.0;
    x.segment(3, 3) << -50.0, 80.0, 5.0;
    return x;
}

/// z = x^2 for the first component of a 1-D motion.
struct Square : pelorus::Sensor<Square, 1, 1> {
    static constexpr std::uint32_t flags = PLR_SENSOR_CONSTANT_NOISE;
    static void describe(pelorus::Describe<Square>& plugin) { plugin.title("test"); }
    pelorus::Space measurement_space() const {
        return pelorus::Space(std::vector<pelorus::Component>{{"square", "m2", 0.0, 0.0, false}});
    }
    pelorus::Space cartesian_space() const { return pelorus::position_space(1); }
    Measurement measure(const Cartesian& x, const pelorus::Look&) const { return x.cwiseAbs2(); }
    Jacobian jacobian(const Cartesian& x, const pelorus::Look&) const { return 2.0 * x; }
    Noise noise(const Query&, const pelorus::Look&) const { return Noise::Identity(); }
};

const plr_plugin& square() { return *pelorus::detail::plugin<Square>("sensor.test_square", "sensor.test_square"); }
const plr_plugin& line() { return plugin("motion", "constant_velocity"); }

}  // namespace

TEST_CASE("where all is linear a point filter is the Kalman filter", "[gaussian]") {
    struct Case {
        const char* motion;
        Values motion_values, sensor_values;
    };
    // By structure, by full matrices, by a factor of a singular noise; sizes fixed and not.
    const Case cases[] = {{"constant_velocity", {{"dimension", "2"}}, {{"dimension", "2"}}},
                          {"constant_velocity", {}, {}},
                          {"constant_acceleration", {{"dimension", "3"}, {"noise", "[1, 2, 3]"}}, {}},
                          {"singer", {{"form", "truncated"}, {"acceleration", "[1, 2, 3]"}}, {{"dimension", "2"}}},
                          {"constant_velocity", {{"dimension", "1"}}, {{"dimension", "1"}}}};
    for (const Case& one : cases) {
        FilterUnderTest kalman("kalman", {}, one.motion, one.motion_values, "position", one.sensor_values);
        const std::int64_t n = kalman.filter.n(), m = kalman.filter.m(0);
        for (const Kind& kind : kinds_of_both_forms()) {
            if (kind.name == std::string("gauss_hermite") && n == 9) continue;  // 512 points: tried once, below
            if (kind.values.count("kappa") != 0 && n < 2) continue;
            CAPTURE(one.motion, kind.name, kind.values.at("form"), n, m);
            FilterUnderTest f(kind.name, kind.values, one.motion, one.motion_values, "position", one.sensor_values);
            std::mt19937_64 engine(4);
            std::normal_distribution<double> normal;
            const VectorXd x = VectorXd::NullaryExpr(n, [&] { return 10.0 * normal(engine); });
            const MatrixXd p = random_covariance(n, engine);
            Batch expected = kalman.record_of(x, p), got = f.record_of(x, p);
            for (int k = 0; k < 5; ++k) {
                expected = kalman.predicted(0.7, expected);
                got = f.predicted(0.7, got);
                CHECK(relative(f.mean(got), kalman.mean(expected)) < 1e-10);
                CHECK(covariance_difference(f.covariance(got), kalman.covariance(expected)) < 1e-10);
                const auto projected = f.projected(got), wanted = kalman.projected(expected);
                CHECK(relative(projected.measurement, wanted.measurement) < 1e-10);
                CHECK(relative(projected.covariance, wanted.covariance) < 1e-10);
                CHECK(relative(projected.cross, wanted.cross) < 1e-10);
                CHECK(relative(projected.cartesian_cross, wanted.cartesian_cross) < 1e-10);
                const MatrixXd r = random_covariance(m, engine);
                const VectorXd z = wanted.measurement + VectorXd::NullaryExpr(m, [&] { return 3.0 * normal(engine); });
                expected = kalman.updated(z, r, expected);
                got = f.updated(z, r, got);
                CHECK(relative(f.mean(got), kalman.mean(expected)) < 1e-10);
                CHECK(covariance_difference(f.covariance(got), kalman.covariance(expected)) < 1e-10);
                CHECK(relative(f.told.innovation, kalman.told.innovation) < 1e-9);
                CHECK(relative(f.told.covariance, kalman.told.covariance) < 1e-10);
                CHECK(f.told.log_likelihood == Approx(kalman.told.log_likelihood).epsilon(1e-10));
            }
        }
    }
}

TEST_CASE("square roots and covariances tell the same of a nonlinear motion and sensor", "[gaussian]") {
    const Values turning{{"noise", "2"}, {"turn_rate_noise", "1e-5"}, {"prior_turn_rate", "0.1"}};
    const auto roots = kinds("square_root"), plains = kinds("covariance");
    for (std::size_t k = 0; k < roots.size(); ++k) {
        CAPTURE(k);
        FilterUnderTest root(roots[k].name, roots[k].values, "coordinated_turn", turning, "spherical");
        FilterUnderTest plain(plains[k].name, plains[k].values, "coordinated_turn", turning, "spherical");
        VectorXd x = place(7), variances(7);
        x(6) = 0.05;
        variances << 900.0, 900.0, 900.0, 25.0, 25.0, 25.0, 1e-3;
        Batch a = root.record_of(x, variances.asDiagonal()), b = plain.record_of(x, variances.asDiagonal());
        const MatrixXd noise = Eigen::Vector3d(100.0, 1e-5, 1e-5).asDiagonal();
        for (int step = 0; step < 20; ++step) {
            a = root.predicted(2.0, a);
            b = plain.predicted(2.0, b);
            CHECK(relative(root.mean(a), plain.mean(b)) < 1e-8);
            CHECK(covariance_difference(root.covariance(a), plain.covariance(b)) < 1e-8);
            const VectorXd z = root.projected(a).measurement + Eigen::Vector3d(5.0, 1e-3, -1e-3);
            a = root.updated(z, noise, a);
            b = plain.updated(z, noise, b);
            CHECK(relative(root.mean(a), plain.mean(b)) < 1e-8);
            CHECK(covariance_difference(root.covariance(a), plain.covariance(b)) < 1e-8);
            CHECK(root.told.log_likelihood == Approx(plain.told.log_likelihood).epsilon(1e-8));
        }
    }
}

TEST_CASE("moments of a square are exact where the rule says so", "[gaussian]") {
    // x ~ N(3, 4): E x^2 = 13, var x^2 = 4 3^2 4 + 2 4^2 = 176, cov(x, x^2) = 2 3 4 = 24.
    struct Case {
        const char* name;
        Values values;
        double variance;
    };
    const Case cases[] = {{"gauss_hermite", {{"order", "3"}}, 176.0},
                          {"gauss_hermite", {{"order", "8"}, {"form", "covariance"}}, 176.0},
                          {"unscented", {{"alpha", "1"}, {"beta", "0"}, {"kappa", "1"}}, 176.0},  // n + kappa = 3
                          // A cubature rule of degree 3 takes E x^4 for n (E x^2)^2: 2 4^2 (n - 1)/2 = 16 here.
                          {"cubature", {}, 144.0 + 16.0}};
    for (const Case& one : cases) {
        CAPTURE(one.name);
        const FilterUnderTest f(one.name, one.values, line(), square(), {{"dimension", "1"}});
        const auto seen = f.projected(f.record_of(Eigen::Vector2d(3.0, 1.0), Eigen::Vector2d(4.0, 1.0).asDiagonal()));
        CHECK(seen.measurement(0) == Approx(13.0));
        CHECK(seen.covariance(0, 0) == Approx(one.variance));
        CHECK(seen.cross(0, 0) == Approx(24.0));
        CHECK(std::fabs(seen.cross(1, 0)) < 1e-12);
    }
}

TEST_CASE("a centre of negative weight that makes an update indefinite fails its item by name", "[gaussian]") {
    for (const char* const form : {"square_root", "covariance"}) {
        CAPTURE(form);
        // lambda = kappa = -1.5 of n = 2: points at sqrt(0.5), centre -3; x^2 of N(0, 1) gets 0.5 - 1 = -0.5 or less.
        FilterUnderTest f("unscented", {{"form", form}, {"beta", "0"}, {"kappa", "-1.5"}}, line(), square(),
                          {{"dimension", "1"}});
        const Batch start = f.record_of(VectorXd::Zero(2), MatrixXd::Identity(2, 2));
        CHECK_THROWS_WITH(f.updated(VectorXd::Constant(1, 1.0), MatrixXd::Constant(1, 1, 0.1), start),
                          "the updated covariance is indefinite: a point of negative weight takes more away than there "
                          "is");
        const double variance = f.projected(start).covariance(0, 0);
        CHECK(variance < -0.1);
        CHECK_NOTHROW(f.updated(VectorXd::Constant(1, 1.0), MatrixXd::Constant(1, 1, 0.1 - variance), start));
    }
}

TEST_CASE("a motion's points are those of the published transform", "[gaussian]") {
    // By hand, from Cholesky's factor, with the weights of Wan and van der Merwe.
    const FilterUnderTest f("unscented", {{"alpha", "0.8"}, {"beta", "2"}, {"kappa", "1"}}, "coordinated_turn",
                            {{"dimension", "2"}, {"noise", "0"}, {"turn_rate_noise", "0"}}, "position",
                            {{"dimension", "2"}});
    const std::int64_t n = 5;
    VectorXd x(n), variances(n);
    x << 100.0, 200.0, 30.0, -40.0, 0.2;
    variances << 400.0, 300.0, 25.0, 16.0, 0.04;
    MatrixXd p = variances.asDiagonal();
    p(0, 2) = p(2, 0) = 40.0;
    p(3, 4) = p(4, 3) = 0.3;
    const double spread = 0.64 * 6.0, lambda = spread - 5.0;
    const MatrixXd root = std::sqrt(spread) * MatrixXd(Eigen::LLT<MatrixXd>(p).matrixL());
    MatrixXd points(n, 11), moved(n, 11);
    points.col(0) = x;
    for (int j = 0; j < n; ++j) {
        points.col(1 + j) = x + root.col(j);
        points.col(6 + j) = x - root.col(j);
    }
    const double dt = 3.0;
    Call call;
    auto propagate = pelorus::arguments<plr_motion_propagate>();
    propagate.dt = pelorus::const_view(&dt, 1, 1, 1);
    propagate.state = pelorus::const_view(points.data(), n, 11, 1);
    propagate.out = pelorus::view(moved.data(), n, 11, 1);
    propagate.mean = pelorus::const_view(x.data(), n, 1, 1);
    REQUIRE(f.motion.as<pelorus::MotionPart>().call(&plr_motion::propagate, call, propagate) == PLR_OK);
    VectorXd weights = VectorXd::Constant(11, 0.5 / spread), covariance_weights = weights;
    weights(0) = lambda / spread;
    covariance_weights(0) = weights(0) + 1.0 - 0.64 + 2.0;
    const VectorXd mean = moved * weights;
    const MatrixXd off = moved.colwise() - mean;
    const MatrixXd expected = off * covariance_weights.asDiagonal() * off.transpose();

    const Batch record = f.predicted(dt, f.record_of(x, p));
    CHECK(relative(f.mean(record), mean) < 1e-12);
    CHECK(covariance_difference(f.covariance(record), expected) < 1e-10);
}

TEST_CASE("points lie along the factor of a covariance in the order of components that is asked for", "[gaussian]") {
    // By hand: Cholesky's factor of [x vx y vy z vz], its rows put back, through range and angles.
    const std::vector<int> order{0, 3, 1, 4, 2, 5};
    std::mt19937_64 engine(9);
    const VectorXd x = place(6);
    MatrixXd p = 400.0 * random_covariance(6, engine), permuted(6, 6), root(6, 6);
    p.topLeftCorner(3, 3) *= 100.0;
    p += 1e5 * MatrixXd::Identity(6, 6);
    for (int r = 0; r < 6; ++r)
        for (int c = 0; c < 6; ++c)
            permuted(r, c) = p(order[static_cast<std::size_t>(r)], order[static_cast<std::size_t>(c)]);
    const MatrixXd factor = Eigen::LLT<MatrixXd>(permuted).matrixL();
    for (int r = 0; r < 6; ++r) root.row(order[static_cast<std::size_t>(r)]) = std::sqrt(6.0) * factor.row(r);
    MatrixXd points(6, 12), seen(3, 12);
    points << root, -root;
    points.colwise() += x;
    for (int k = 0; k < 12; ++k) {
        const Eigen::Vector3d at = points.col(k).head(3);
        seen.col(k) << at.norm(), std::atan2(at(1), at(0)), std::asin(at(2) / at.norm());
    }
    const VectorXd mean = seen.rowwise().mean();
    const MatrixXd off = seen.colwise() - mean, difference = points.colwise() - x;
    const MatrixXd covariance = off * off.transpose() / 12.0, cross = difference * off.transpose() / 12.0;
    const MatrixXd noise = Eigen::Vector3d(100.0, 1e-4, 1e-4).asDiagonal(), s = covariance + noise;
    const VectorXd innovation = Eigen::Vector3d(30.0, -0.01, 0.02);
    const MatrixXd gain = cross * s.inverse(), after = p - gain * s * gain.transpose();
    for (const char* const form : {"square_root", "covariance"}) {
        CAPTURE(form);
        FilterUnderTest f("cubature", {{"form", form}, {"component_order", "axes"}}, "constant_velocity", {},
                          "spherical");
        const Batch record = f.record_of(x, p);
        const auto told = f.projected(record);
        CHECK(relative(told.measurement, mean) < 1e-12);
        CHECK(relative(told.covariance, covariance) < 1e-10);
        CHECK(relative(told.cross, cross) < 1e-10);
        CHECK(relative(told.cartesian_cross, cross) < 1e-10);
        const Batch updated = f.updated(mean + innovation, noise, record);
        CHECK(relative(f.mean(updated), x + gain * innovation) < 1e-12);
        CHECK(covariance_difference(f.covariance(updated), after) < 1e-9);
        // Records stay what they are, so that every order may go on from them.
        FilterUnderTest other("cubature", {{"form", form}}, "constant_velocity", {}, "spherical");
        CHECK(relative(other.mean(other.predicted(1.0, updated)), f.mean(f.predicted(1.0, updated))) < 1e-14);
        CHECK(covariance_difference(other.covariance(other.predicted(1.0, updated)),
                                    f.covariance(f.predicted(1.0, updated))) < 1e-12);
    }
}

TEST_CASE("a point filter tells of its errors: NEES and NIS within their chi-square bounds", "[gaussian]") {
    const std::int64_t runs = 200, n = 6;
    const int steps = 20;
    for (const Kind& kind : kinds("square_root")) {
        CAPTURE(kind.name);
        FilterUnderTest f(kind.name, kind.values, "constant_velocity", {{"noise", "2"}}, "spherical");
        std::mt19937_64 engine(3);
        std::normal_distribution<double> normal;
        const auto draw = [&](std::int64_t size) {
            return VectorXd(VectorXd::NullaryExpr(size, [&] { return normal(engine); }));
        };
        const double dt = 1.0;
        // The motion's F and Q, by its definition.
        MatrixXd transition = MatrixXd::Identity(n, n), q = MatrixXd::Zero(n, n);
        for (int k = 0; k < 3; ++k) {
            transition(k, k + 3) = dt;
            q(k, k) = 2.0 / 3.0;
            q(k, k + 3) = q(k + 3, k) = 1.0;
            q(k + 3, k + 3) = 2.0;
        }
        const MatrixXd root = Eigen::LLT<MatrixXd>(q).matrixL();
        VectorXd spread(n);
        spread << VectorXd::Constant(3, 200.0), VectorXd::Constant(3, 10.0);
        const Eigen::Vector3d deviation(20.0, 0.02, 0.02);
        const MatrixXd noise = deviation.cwiseAbs2().asDiagonal();
        double nees = 0.0, nis = 0.0;
        for (std::int64_t run = 0; run < runs; ++run) {
            VectorXd truth = place(n);
            Batch record = f.record_of(truth + spread.cwiseProduct(draw(n)), spread.cwiseAbs2().asDiagonal());
            for (int k = 0; k < steps; ++k) {
                truth = transition * truth + root * draw(n);
                const Eigen::Vector3d p = truth.head(3);
                const Eigen::Vector3d seen(p.norm(), std::atan2(p(1), p(0)), std::asin(p(2) / p.norm()));
                record = f.updated(seen + deviation.cwiseProduct(draw(3)), noise, f.predicted(dt, record));
                nis += f.told.innovation.dot(f.told.covariance.inverse() * f.told.innovation) /
                       (steps * static_cast<double>(runs));
            }
            const auto [mean, covariance] = f.moments(record);
            const VectorXd error = mean - truth;
            nees += error.dot(covariance.inverse() * error) / static_cast<double>(runs);
        }
        // As the mean of k chi-square values of d degrees: 4 deviations of sqrt(2 d / k).
        CHECK(std::fabs(nees - 6.0) < 4.0 * std::sqrt(2.0 * 6.0 / static_cast<double>(runs)));
        CHECK(std::fabs(nis - 3.0) < 4.0 * std::sqrt(2.0 * 3.0 / (static_cast<double>(runs) * steps)));
    }
}

TEST_CASE("a covariance of 1e24 survives a point filter and is forgotten", "[gaussian]") {
    for (const Kind& kind : kinds_of_both_forms()) {
        CAPTURE(kind.name, kind.values.at("form"));
        FilterUnderTest f(kind.name, kind.values, "constant_velocity", {{"noise", "0.01"}}, "position");
        FilterUnderTest modest("kalman", {}, "constant_velocity", {{"noise", "0.01"}}, "position");
        const MatrixXd noise = MatrixXd::Identity(3, 3);
        VectorXd start = place(6);
        Batch record = f.record_of(start, 1e24 * MatrixXd::Identity(6, 6));
        Batch plain = modest.record_of(start, 1e8 * MatrixXd::Identity(6, 6));
        for (int k = 1; k <= 40; ++k) {
            const Eigen::Vector3d z(3000.0 + 10.0 * k, 4000.0 - 20.0 * k, 500.0 + k);
            record = f.updated(z, noise, f.predicted(1.0, record));
            plain = modest.updated(z, noise, modest.predicted(1.0, plain));
            const MatrixXd p = f.covariance(record);
            CAPTURE(k);
            REQUIRE(Eigen::LLT<MatrixXd>(p).info() == Eigen::Success);
            for (int c = 0; c < 6; ++c) REQUIRE(p(c, c) > 0.98 * modest.covariance(plain)(c, c));
        }
        CHECK(covariance_difference(f.covariance(record), modest.covariance(plain)) < 1e-2);
        CHECK((f.mean(record) - modest.mean(plain)).cwiseAbs().maxCoeff() < 0.05);
    }
}

TEST_CASE("batches of a point filter give the bytes that single items give", "[gaussian]") {
    const std::int64_t count = 37;  // more than one block, and no multiple of it
    std::vector<Kind> some = kinds_of_both_forms();
    some.push_back({"gauss_hermite", {{"order", "3"}}});  // one item a block
    for (const char* const form : {"square_root", "covariance"})
        some.push_back({"cubature", {{"form", form}, {"component_order", "axes"}}});
    for (const Kind& kind : some) {
        for (const char* const motion : {"constant_velocity", "coordinated_turn"}) {
            const bool is_turn = motion == std::string("coordinated_turn");
            if (is_turn && kind.values.count("order") != 0 && kind.values.at("order") == "3") continue;  // 2187 points
            CAPTURE(kind.name, motion);
            const FilterUnderTest f(kind.name, kind.values, motion, {}, "spherical");
            const auto& filter = f.filter;
            const std::int64_t n = filter.n();
            std::mt19937_64 engine(7);
            Batch start(filter.record_size(), 1, count), z(3, 1, count), dt(1, 1, count);
            for (std::int64_t i = 0; i < count; ++i) {
                VectorXd x = place(6);
                x.conservativeResize(n);
                if (n == 7) x(6) = 0.01 * static_cast<double>(i);
                MatrixXd p = random_covariance(n, engine);
                if (n == 7) p.row(6) *= 0.01;
                if (n == 7) p.col(6) *= 0.01;
                start[i] = f.record_of(x, p)[0];
                z[i] << 5100.0 + static_cast<double>(i), 0.93, 0.2;
                dt[i](0) = 0.5 + 0.01 * static_cast<double>(i / 3);
            }
            const MatrixXd noise = Eigen::Vector3d(100.0, 1e-6, 1e-6).asDiagonal();
            Call call(count);
            Batch batch(filter.record_size(), 1, count), seen(3, 1, count), covariance(3, 3, count), cross(n, 3, count);
            EstimatorUnderTest::Told told(3, count);
            REQUIRE(filter.predict(call, dt.in(), start, batch) == PLR_OK);
            REQUIRE(filter.project(call, 0, batch, seen, covariance, cross) == PLR_OK);
            REQUIRE(filter.update(call, 0, batch, z, pelorus::common_view(noise.data(), 3, 3, count), batch, told) ==
                    PLR_OK);  // in place
            CHECK(call.scratch_used() == 0);
            for (std::int64_t i = 0; i < count; ++i) {
                Call single;
                Batch record(filter.record_size(), 1), one(filter.record_size(), 1), measured(3, 1), s(3, 1), p(3, 3),
                    c(n, 3);
                EstimatorUnderTest::Told one_told(3, 1);
                record[0] = start[i];
                measured[0] = z[i];
                REQUIRE(filter.predict(single, pelorus::const_view(dt[i].data(), 1, 1, 1), record, one) == PLR_OK);
                REQUIRE(filter.project(single, 0, one, s, p, c) == PLR_OK);
                REQUIRE(filter.update(single, 0, one, measured, pelorus::const_view(noise.data(), 3, 3, 1), record,
                                      one_told) == PLR_OK);
                CHECK(batch[i] == record[0]);
                CHECK(seen[i] == s[0]);
                CHECK(cross[i] == c[0]);
                CHECK(told.log_likelihood[i] == one_told.log_likelihood[0]);
            }
        }
    }
}
