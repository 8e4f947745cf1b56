// The filter on factors of covariances, and with several linearisations.
#include "../../../tests/support/filter_under_test.hpp"

#include <random>

#include <catch2/catch.hpp>
#include <Eigen/Cholesky>
#include <Eigen/LU>

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

VectorXd place(std::int64_t n) {
    VectorXd x = VectorXd::Zero(n);
    x.head(3) << 3000.0, 4000.0, 1000.0;
    x.segment(3, 3) << -50.0, 80.0, 5.0;
    return x;
}

Eigen::Vector3d seen(const VectorXd& x) {
    const Eigen::Vector3d p = x.head(3);
    return {p.norm(), std::atan2(p(1), p(0)), std::asin(p(2) / p.norm())};
}

/// d (range, azimuth, elevation) / d state, written out.
MatrixXd jacobian(const VectorXd& x) {
    MatrixXd h = MatrixXd::Zero(3, x.size());
    const double rho2 = x(0) * x(0) + x(1) * x(1), rho = std::sqrt(rho2), r2 = rho2 + x(2) * x(2), r = std::sqrt(r2);
    h.row(0).head(3) = x.head(3).transpose() / r;
    h(1, 0) = -x(1) / rho2;
    h(1, 1) = x(0) / rho2;
    h.row(2).head(3) << -x(0) * x(2) / (r2 * rho), -x(1) * x(2) / (r2 * rho), rho / r2;
    return h;
}

}  // namespace

TEST_CASE("square roots and covariances are the same filter", "[kalman]") {
    struct Case {
        const char* motion;
        Values motion_values;
        const char* sensor;
    };
    // By structure, by full matrices, by a factor of a singular noise, not linear.
    const Case cases[] = {{"constant_velocity", {}, "spherical"},
                          {"constant_acceleration", {{"noise", "[1, 2, 3]"}}, "spherical"},
                          {"singer", {{"form", "truncated"}, {"acceleration", "[1, 2, 3]"}}, "position"},
                          {"coordinated_turn", {}, "spherical"}};
    for (const Case& one : cases) {
        for (const char* const iterations : {"1", "3"}) {
            CAPTURE(one.motion, iterations);
            FilterUnderTest root("kalman", {{"form", "square_root"}, {"iterations", iterations}}, one.motion,
                                 one.motion_values, one.sensor);
            FilterUnderTest plain("kalman", {{"iterations", iterations}}, one.motion, one.motion_values, one.sensor);
            CHECK(root.filter.info().record_version != plain.filter.info().record_version);
            const std::int64_t n = root.filter.n();
            VectorXd variances = VectorXd::Constant(n, 1.0);
            variances.head(6) << 900.0, 900.0, 900.0, 100.0, 100.0, 100.0;
            if (n == 7) variances(6) = 0.01;
            Batch a = root.record_of(place(n), variances.asDiagonal()),
                  b = plain.record_of(place(n), variances.asDiagonal());
            const bool is_spherical = one.sensor == std::string("spherical");
            const MatrixXd noise =
                (is_spherical ? Eigen::Vector3d(100.0, 1e-5, 1e-5) : Eigen::Vector3d(10.0, 20.0, 5.0)).asDiagonal();
            const Eigen::Vector3d off =
                is_spherical ? Eigen::Vector3d(5.0, 1e-3, -1e-3) : Eigen::Vector3d(3.0, 1.0, -2.0);
            for (int k = 0; k < 10; ++k) {
                a = root.predicted(0.5, a);
                b = plain.predicted(0.5, b);
                CHECK(covariance_difference(root.covariance(a), plain.covariance(b)) < 1e-10);
                const auto p = root.projected(a), q = plain.projected(b);
                CHECK(relative(p.measurement, q.measurement) < 1e-12);
                CHECK(covariance_difference(p.covariance, q.covariance) < 1e-10);
                CHECK(relative(p.cross, q.cross) < 1e-10);
                CHECK(relative(p.cartesian_cross, q.cartesian_cross) < 1e-10);
                a = root.updated(q.measurement + off, noise, a);
                b = plain.updated(q.measurement + off, noise, b);
                CHECK(relative(root.mean(a), plain.mean(b)) < 1e-10);
                CHECK(covariance_difference(root.covariance(a), plain.covariance(b)) < 1e-10);
                CHECK(covariance_difference(root.told.covariance, plain.told.covariance) < 1e-10);
                CHECK(root.told.log_likelihood == Approx(plain.told.log_likelihood).epsilon(1e-10));
            }
        }
    }
}

TEST_CASE("a factor survives a prior of 1e24 and measurements without noise", "[kalman]") {
    FilterUnderTest f("kalman", {{"form", "square_root"}}, "constant_velocity", {{"noise", "0.01"}}, "position");
    Batch record = f.record_of(place(6), 1e24 * MatrixXd::Identity(6, 6));
    for (int k = 1; k <= 40; ++k) {
        record = f.updated(Eigen::Vector3d(3000.0 + k, 4000.0 - k, 500.0), MatrixXd::Identity(3, 3),
                           f.predicted(1.0, record));
        REQUIRE(Eigen::LLT<MatrixXd>(f.covariance(record)).info() == Eigen::Success);
    }
    CHECK(f.mean(record)(3) == Approx(1.0).epsilon(1e-3));
    CHECK(f.covariance(record)(0, 0) < 1.0);
    for (int k = 1; k <= 10; ++k) {
        record =
            f.updated(Eigen::Vector3d(3040.0 + k, 3960.0 - k, 500.0), MatrixXd::Zero(3, 3), f.predicted(1.0, record));
        CHECK(f.mean(record)(0) == Approx(3040.0 + k));
        CHECK(f.covariance(record)(0, 0) < 1e-14);
    }
}

TEST_CASE("iterations find the most probable state, and tell of the prediction", "[kalman]") {
    for (const char* const form : {"covariance", "square_root"}) {
        CAPTURE(form);
        FilterUnderTest one("kalman", {{"form", form}}, "constant_velocity", {}, "spherical");
        FilterUnderTest many("kalman", {{"form", form}, {"iterations", "20"}}, "constant_velocity", {}, "spherical");
        VectorXd variances(6);
        variances << 250000.0, 250000.0, 250000.0, 100.0, 100.0, 100.0;
        MatrixXd p = variances.asDiagonal();
        for (int k = 0; k < 3; ++k) p(k, k + 3) = p(k + 3, k) = 3000.0;
        const VectorXd x = place(6);
        const Eigen::Vector3d z = seen(x) + Eigen::Vector3d(400.0, 0.15, -0.1);
        const MatrixXd noise = Eigen::Vector3d(100.0, 1e-4, 1e-4).asDiagonal();
        const Batch extended = one.updated(z, noise, one.record_of(x, p));
        const Batch iterated = many.updated(z, noise, many.record_of(x, p));
        CHECK((one.told.innovation - many.told.innovation).norm() == 0.0);
        CHECK(one.told.log_likelihood == many.told.log_likelihood);
        CHECK(one.told.covariance == many.told.covariance);

        // There the gradient of the posterior's logarithm is 0, unlike where the extended filter stops.
        const auto gradient = [&](const VectorXd& at) {
            const VectorXd slope = p.inverse() * (x - at) + jacobian(at).transpose() * noise.inverse() * (z - seen(at));
            return (p.diagonal().cwiseSqrt().asDiagonal() * slope).norm();
        };
        CHECK(gradient(one.mean(extended)) > 0.1);
        CHECK(gradient(many.mean(iterated)) < 1e-6);
        const MatrixXd h = jacobian(many.mean(iterated));
        const MatrixXd expected = (p.inverse() + h.transpose() * noise.inverse() * h).inverse();
        CHECK(covariance_difference(many.covariance(iterated), expected) < 1e-6);
    }
}

TEST_CASE("several linearisations of what is linear are one", "[kalman]") {
    FilterUnderTest one("kalman", {}, "constant_velocity", {}, "position");
    FilterUnderTest many("kalman", {{"iterations", "4"}}, "constant_velocity", {}, "position");
    const MatrixXd p = 100.0 * MatrixXd::Identity(6, 6), noise = MatrixXd::Identity(3, 3);
    const Eigen::Vector3d z(3010.0, 4000.0, 990.0);
    CHECK(relative(many.mean(many.updated(z, noise, many.record_of(place(6), p))),
                   one.mean(one.updated(z, noise, one.record_of(place(6), p)))) < 1e-14);
}

TEST_CASE("a batch of iterated updates gives the bytes that single items give, in place too", "[kalman]") {
    const FilterUnderTest f("kalman", {{"form", "square_root"}, {"iterations", "3"}}, "constant_velocity", {},
                            "spherical");
    const auto& filter = f.filter;
    const std::int64_t count = 21;
    Batch records(filter.record_size(), 1, count), z(3, 1, count);
    for (std::int64_t i = 0; i < count; ++i) {
        const double more = static_cast<double>(i);
        records[i] = f.record_of(place(6) + VectorXd::Constant(6, more), (100.0 + more) * MatrixXd::Identity(6, 6))[0];
        z[i] = seen(place(6)) + Eigen::Vector3d(more, 0.001 * more, 0.0);
    }
    const MatrixXd noise = Eigen::Vector3d(100.0, 1e-4, 1e-4).asDiagonal();
    Batch before = records;
    EstimatorUnderTest::Told told(3, count);
    Call call(count);
    REQUIRE(filter.update(call, 0, records, z, pelorus::common_view(noise.data(), 3, 3, count), records, told) ==
            PLR_OK);
    for (std::int64_t i = 0; i < count; ++i) {
        Call single;
        Batch record(filter.record_size(), 1), one(3, 1), out(filter.record_size(), 1);
        record[0] = before[i];
        one[0] = z[i];
        EstimatorUnderTest::Told one_told(3, 1);
        REQUIRE(filter.update(single, 0, record, one, pelorus::const_view(noise.data(), 3, 3, 1), out, one_told) ==
                PLR_OK);
        CHECK(records[i] == out[0]);
        CHECK(told.log_likelihood[i] == one_told.log_likelihood[0]);
    }
}
