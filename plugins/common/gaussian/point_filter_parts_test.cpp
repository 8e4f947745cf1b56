// Point filters on a state that is not Cartesian, angles, records of motions, mixtures, and what cannot be worked out.
#include "../../../tests/support/filter_under_test.hpp"
#include "../../../tests/support/log_polar_motion.hpp"

#include <catch2/catch.hpp>
#include <Eigen/LU>

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

const std::vector<std::string> names{"cubature", "unscented", "gauss_hermite"};
const std::vector<std::string> forms{"square_root", "covariance"};

struct LogPolarFilter {
    explicit LogPolarFilter(const std::string& name, const std::string& form)
        : instance("estimator", name, {{"form", form}}, {{"motion", "", &motion}, {"sensors", "radar", &sensor}}) {}
    Instance motion{log_polar(), {}, {}, 0};
    Instance sensor{"sensor", "position", {{"dimension", "2"}}};
    Instance instance;
    EstimatorUnderTest filter{instance};

    /// A track at azimuth `azimuth`, range 5, known closely.
    Batch at(double azimuth) const {
        return filter.record_of(Eigen::Vector3d(std::log(5.0), azimuth, 0.0),
                                Eigen::Vector3d(1e-6, 4e-6, 0.09).asDiagonal());
    }
};

}  // namespace

TEST_CASE("points of a state that is not Cartesian reach the sensor as Cartesian ones", "[gaussian]") {
    for (const std::string& name : names) {
        for (const std::string& form : forms) {
            CAPTURE(name, form);
            const LogPolarFilter f(name, form);
            const auto& filter = f.filter;
            Batch record = f.at(0.5), seen(2, 1), covariance(2, 2), cross(3, 2), cartesian(2, 2), mean(2, 1), p(2, 2);
            Call call;
            REQUIRE(filter.project(call, 0, record, seen, covariance, cross, &cartesian) == PLR_OK);
            REQUIRE(filter.summary(call, record, mean, p) == PLR_OK);
            // So close to the mean all is linear: J P J' with J of x = e^l (cos a, sin a).
            Eigen::Matrix<double, 2, 3> j;
            j << 5.0 * std::cos(0.5), -5.0 * std::sin(0.5), 0.0, 5.0 * std::sin(0.5), 5.0 * std::cos(0.5), 0.0;
            const Eigen::Matrix3d own = Eigen::Vector3d(1e-6, 4e-6, 0.09).asDiagonal();
            CHECK(relative(seen[0], Eigen::Vector2d(5.0 * std::cos(0.5), 5.0 * std::sin(0.5))) < 1e-5);
            CHECK(relative(covariance[0], j * own * j.transpose()) < 1e-4);
            CHECK(relative(cross[0], own * j.transpose()) < 1e-4);
            CHECK(relative(cartesian[0], j * own * j.transpose()) < 1e-4);
            CHECK(relative(p[0], j * own * j.transpose()) < 1e-12);
        }
    }
}

TEST_CASE("angles of a state are averaged around the circle and wrapped, in every step", "[gaussian]") {
    const double pi = std::acos(-1.0);
    for (const std::string& name : names) {
        for (const std::string& form : forms) {
            CAPTURE(name, form);
            const LogPolarFilter f(name, form);
            const auto& filter = f.filter;
            Batch here = f.at(pi - 1e-3), there = f.at(0.0), moved(filter.record_size(), 1), same = moved;
            const double dt = 0.5;
            const MatrixXd extent = MatrixXd::Identity(2, 2);
            const auto predict = [&](const Batch& record, Batch& out) {
                auto args = pelorus::arguments<plr_estimator_predict>();
                args.dt = pelorus::const_view(&dt, 1, 1, 1);
                args.extent = pelorus::const_view(extent.data(), 2, 2, 1);
                args.record = record.in();
                args.out = out.out();
                Call call;
                return filter.part().call(&plr_estimator::predict, call, args);
            };
            // Drift spreads the azimuth by 0.15 rad, across the cut in one case and far from it in the other.
            REQUIRE(predict(here, moved) == PLR_OK);
            REQUIRE(predict(there, same) == PLR_OK);
            CHECK(moved[0](1) == Approx(pi - 1e-3));
            CHECK(relative(moved[0].bottomRows(moved.rows - 3), same[0].bottomRows(same.rows - 3)) < 1e-9);
            CHECK(moved[0](3 + 9) == 1.0);  // the motion's record has advanced

            Batch z(2, 1), out(filter.record_size(), 1);
            z[0] << 5.0 * std::cos(pi + 0.01), 5.0 * std::sin(pi + 0.01);
            EstimatorUnderTest::Told told(2, 1);
            const MatrixXd noise = 1e-8 * MatrixXd::Identity(2, 2);
            Call call;
            REQUIRE(filter.update(call, 0, here, z, pelorus::const_view(noise.data(), 2, 2, 1), out, told) == PLR_OK);
            CHECK(out[0](1) == Approx(-pi + 0.01).margin(2e-4));
            CHECK(out[0](3 + 9) == here[0](3 + 9));  // an update leaves it alone
        }
    }
}

TEST_CASE("angles of a measurement are averaged around the circle", "[gaussian]") {
    for (const std::string& name : names) {
        CAPTURE(name);
        const FilterUnderTest f(name, {}, "constant_velocity", {}, "spherical");
        VectorXd behind(6), ahead(6), variances(6);
        behind << -1000.0, 1.0, 0.0, 0.0, 0.0, 0.0;
        ahead << 1000.0, -1.0, 0.0, 0.0, 0.0, 0.0;
        variances << 100.0, 10000.0, 100.0, 1.0, 1.0, 1.0;
        const auto a = f.projected(f.record_of(behind, variances.asDiagonal()));
        const auto b = f.projected(f.record_of(ahead, variances.asDiagonal()));
        CHECK(std::fabs(a.measurement(1)) > 3.1);
        CHECK(relative(a.covariance, b.covariance) < 1e-9);
    }
}

TEST_CASE("factors and covariances mix alike", "[gaussian]") {
    const LogPolarFilter root("cubature", "square_root"), plain("cubature", "covariance");
    const auto mixed = [](const LogPolarFilter& f) {
        const auto* const mix = f.filter.part().extension<plr_estimator_mix>(PLR_ESTIMATOR_MIX);
        if (mix == nullptr) throw std::runtime_error("offers no mixture");
        Batch records(f.filter.record_size(), 3), weights(3, 1), out(f.filter.record_size(), 1);
        records[0].col(0) = f.at(3.1)[0];
        records[0].col(1) = f.at(-3.1)[0];
        records[0].col(2) = f.at(3.0)[0];
        weights[0] << 0.2, 0.5, 0.3;
        const plr_estimator_mix_args args{sizeof args, 0, weights.in(), records.in(), out.out()};
        Call call;
        if (mix->mix(f.filter.part().self(), &static_cast<const plr_call&>(call), &args) != PLR_OK)
            throw std::runtime_error(call.message());
        Batch mean(3, 1), covariance(3, 3);
        if (f.filter.moments(call, out, mean, covariance) != PLR_OK) throw std::runtime_error(call.message());
        return std::pair<VectorXd, MatrixXd>{mean[0], covariance[0]};
    };
    const auto [x, p] = mixed(root);
    const auto [y, q] = mixed(plain);
    CHECK(relative(x, y) < 1e-12);
    CHECK(covariance_difference(p, q) < 1e-12);
    const double pi = std::acos(-1.0), centre = -3.1;
    const double mean = centre + 0.2 * (2 * pi - 6.2) * -1.0 + 0.3 * (6.1 - 2 * pi);
    CHECK(x(1) == Approx(mean + (mean <= -pi ? 2 * pi : 0.0)));
}

TEST_CASE("an item of a point filter that cannot be worked out fails alone, by name", "[gaussian]") {
    for (const std::string& name : names) {
        CAPTURE(name);
        const FilterUnderTest f(name, {{"form", "covariance"}}, "coordinated_turn", {{"dimension", "2"}}, "position",
                                {{"dimension", "2"}});
        const auto& filter = f.filter;
        const std::int64_t count = 20;
        VectorXd x(5);
        x << 1000.0, 2000.0, 10.0, 20.0, 0.1;
        Batch records(filter.record_size(), 1, count), out(filter.record_size(), 1, count), z(2, 1, count);
        for (std::int64_t i = 0; i < count; ++i) {
            records[i] = f.record_of(x, MatrixXd::Identity(5, 5))[0];
            z[i] << 1001.0, 2001.0;
        }
        records[3](5) = -1.0;
        records[17](5) = std::numeric_limits<double>::quiet_NaN();
        const double dt = 1.0;
        Call call(count);
        CHECK(filter.predict(call, pelorus::common_view(&dt, 1, 1, count), records, out) == PLR_ITEMS_FAILED);
        const MatrixXd noise = MatrixXd::Identity(2, 2);
        EstimatorUnderTest::Told told(2, count);
        Call second(count);
        CHECK(filter.update(second, 0, records, z, pelorus::common_view(noise.data(), 2, 2, count), out, told) ==
              PLR_ITEMS_FAILED);
        for (std::int64_t i = 0; i < count; ++i) {
            const auto item = static_cast<std::size_t>(i);
            const bool bad = i == 3 || i == 17;
            CHECK(call.status(item) == (bad ? PLR_E_NUMERIC : PLR_OK));
            CHECK(second.status(item) == (bad ? PLR_E_NUMERIC : PLR_OK));
            if (!bad) CHECK(out[i] == out[0]);
        }
        CHECK(call.message() == "the state's covariance is not positive semidefinite");
        CHECK(second.message() == "the state's covariance is not positive semidefinite");
        CHECK(second.error().item == 3);
        Call strict(count);
        strict.raw().item_status = nullptr;
        CHECK(filter.predict(strict, pelorus::common_view(&dt, 1, 1, count), records, out) == PLR_E_NUMERIC);
    }
}

TEST_CASE("a covariance that is not one cannot be assigned to a factor", "[gaussian]") {
    const FilterUnderTest f("cubature", {}, "constant_velocity", {{"dimension", "1"}}, "position",
                            {{"dimension", "1"}});
    MatrixXd p = MatrixXd::Identity(2, 2);
    p(0, 0) = -1.0;
    CHECK_THROWS_WITH(f.record_of(VectorXd::Zero(2), p), "the state's covariance is not positive semidefinite");
}
