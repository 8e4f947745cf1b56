#include <catch2/catch.hpp>
#include <map>
#include <random>

#include <Eigen/Dense>

#include "../../../tests/support/estimator_under_test.hpp"
#include "cloud.hpp"
#include "host/services.hpp"

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

const bool is_random_offered = (offered_random = &pelorus::host::random_service()) != nullptr;

struct Filter {
    Filter(const Values& with, const Values& moving, const std::vector<std::pair<std::string, Values>>& seeing)
        : motion("motion", "constant_velocity", moving) {
        std::vector<Instance::Filled> parts{{"motion", "", &motion}};
        for (std::size_t s = 0; s < seeing.size(); ++s) {
            sensors.push_back(std::make_unique<Instance>("sensor", seeing[s].first, seeing[s].second));
            parts.push_back({"sensors", "sensor_" + std::to_string(s), sensors.back().get()});
        }
        kalman = std::make_unique<Instance>("estimator", "kalman", Values{}, parts);
        particle = std::make_unique<Instance>("estimator", "particle", with, parts);
        gaussian = std::make_unique<EstimatorUnderTest>(*kalman);
        points = std::make_unique<EstimatorUnderTest>(*particle);
    }
    Instance motion;
    std::vector<std::unique_ptr<Instance>> sensors;
    std::unique_ptr<Instance> kalman, particle;
    std::unique_ptr<EstimatorUnderTest> gaussian, points;
};

/// Keys of a step, one a track.
std::vector<plr_key> keys(std::uint64_t run, std::uint64_t step, std::size_t count = 1) {
    std::vector<plr_key> made;
    for (std::size_t i = 0; i < count; ++i) made.push_back({{1000 * run + i, step}});
    return made;
}
struct Tracked {
    const EstimatorUnderTest& filter;
    std::uint64_t run = 0, step = 0;
    Batch record{filter.record_size(), 1};
    double log_likelihood = 0;  // of all measurements

    void start(const std::vector<std::int32_t>& known, const VectorXd& mean, const MatrixXd& covariance) {
        const auto drawn = keys(run, step++);
        Call call;
        call.raw().keys = drawn.data();
        Batch x(mean.size(), 1), p(mean.size(), mean.size());
        x[0] = mean;
        p[0] = covariance;
        REQUIRE(filter.init(call, known, x, p, record) == PLR_OK);
    }
    void predict(double dt) {
        const auto drawn = keys(run, step++);
        Call call;
        call.raw().keys = drawn.data();
        REQUIRE(filter.predict(call, pelorus::const_view(&dt, 1, 1, 1), record, record) == PLR_OK);
        CHECK(call.scratch_used() == 0);
    }
    EstimatorUnderTest::Told update(std::int32_t sensor, const VectorXd& z, const MatrixXd& noise) {
        const auto drawn = keys(run, step++);
        Call call;
        call.raw().keys = drawn.data();
        Batch measured(z.size(), 1);
        measured[0] = z;
        EstimatorUnderTest::Told told(z.size(), 1);
        const plr_status status = filter.update(call, sensor, record, measured,
                                                pelorus::const_view(noise.data(), z.size(), z.size(), 1), record, told);
        INFO(call.message());
        REQUIRE(status == PLR_OK);
        log_likelihood += told.log_likelihood[0](0);
        return told;
    }
    std::pair<VectorXd, MatrixXd> moments() {
        Call call;
        Batch mean(filter.n(), 1), covariance(filter.n(), filter.n());
        REQUIRE(filter.moments(call, record, mean, covariance) == PLR_OK);
        return {mean[0], covariance[0]};
    }
};

/// Mean of independent runs, and its standard error.
struct Average {
    double sum = 0, squares = 0;
    int count = 0;
    void add(double x) {
        sum += x;
        squares += x * x;
        ++count;
    }
    double mean() const { return sum / count; }
    double deviation() const {
        return std::sqrt(std::max(0.0, squares / count - mean() * mean()) * count / (count - 1));
    }
    double error() const { return deviation() / std::sqrt(count); }
};

}  // namespace

TEST_CASE("particle: where all is linear and Gaussian it is the Kalman filter, to within its Monte Carlo error",
          "[particle]") {
    constexpr int particles = 2000, runs = 40;
    const Filter filters({{"particles", std::to_string(particles)}}, {{"dimension", "1"}, {"noise", "0.5"}},
                         {{"position", {{"dimension", "1"}}}});
    const VectorXd start = Eigen::Vector2d(10, 3);
    const MatrixXd spread = (Eigen::Matrix2d() << 25, 3, 3, 4).finished(), noise = MatrixXd::Constant(1, 1, 4);
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    std::vector<VectorXd> measurements;
    for (int k = 0; k < 10; ++k) measurements.push_back(VectorXd::Constant(1, 10 + 3.2 * (k + 1) + 2 * normal(random)));
    const auto run = [&](Tracked& track) {
        track.start({0, 1}, start, spread);
        for (const VectorXd& z : measurements) {
            track.predict(1);
            track.update(0, z, noise);
        }
        return track.moments();
    };
    Tracked exact{*filters.gaussian};
    const auto [mean, covariance] = run(exact);
    Average position, velocity, variance, cross, likelihood;
    for (int r = 0; r < runs; ++r) {
        Tracked track{*filters.points, static_cast<std::uint64_t>(r)};
        const auto [told, told_covariance] = run(track);
        position.add(told(0) - mean(0));
        velocity.add(told(1) - mean(1));
        variance.add(told_covariance(0, 0) / covariance(0, 0));
        cross.add(told_covariance(1, 0) / covariance(1, 0));
        likelihood.add(std::exp(track.log_likelihood - exact.log_likelihood));
    }
    // What N independent points would have, and what drawing anew in ten steps makes of it.
    const double least = std::sqrt(covariance(0, 0) / particles);
    CHECK(position.deviation() > 0.7 * least);
    CHECK(position.deviation() < 4 * least);
    CHECK(std::abs(position.mean()) < 4.5 * position.error());
    CHECK(std::abs(velocity.mean()) < 4.5 * velocity.error());
    CHECK(std::abs(variance.mean() - 1) < 4.5 * variance.error());
    CHECK(std::abs(cross.mean() - 1) < 4.5 * cross.error());
    CHECK(variance.deviation() < 0.2);
    // The likelihood of all measurements is told without bias (P. Del Moral, Feynman-Kac Formulae, 2004, 7.4.1).
    CHECK(std::abs(likelihood.mean() - 1) < 4.5 * likelihood.error());
    CHECK(likelihood.deviation() < 0.5);
}

TEST_CASE("particle: two ranges leave two places, of which a Gaussian filter takes one", "[particle]") {
    constexpr double a_range = 943.4, b_range = 943.4, deviation = 100, apart = 1000, width = 700;
    const Filter filters({{"particles", "4000"}}, {{"noise", "1"}},
                         {{"spherical", {}}, {"spherical", {{"position", "[1000 m, 0 m, 0 m]"}}}});
    const MatrixXd noise = Eigen::Vector3d(deviation * deviation, 1e8, 1e8).asDiagonal();  // the angles tell nothing
    const VectorXd start = Eigen::Vector3d(450, 150, 0);
    const MatrixXd spread = Eigen::Vector3d(width * width, width * width, 1e-4).asDiagonal();
    const auto run = [&](Tracked& track) {
        track.start({0, 1, 2}, start, spread);
        track.update(0, Eigen::Vector3d(a_range, 0, 0), noise);
        track.update(1, Eigen::Vector3d(b_range, 0, 0), noise);
        return track.moments();
    };
    // The posterior by quadrature; the angles' densities are constant.
    const double pi = std::acos(-1.0);
    double mass = 0, above = 0, y_sum = 0, y_squares = 0;
    constexpr double cell = 10;
    for (double x = -3000; x <= 4000; x += cell)
        for (double y = -3500; y <= 3500; y += cell) {
            const double e_a = (std::hypot(x, y) - a_range) / deviation,
                         e_b = (std::hypot(x - apart, y) - b_range) / deviation;
            const double p_x = (x - start(0)) / width, p_y = (y - start(1)) / width;
            const double density = std::exp(-0.5 * (e_a * e_a + e_b * e_b + p_x * p_x + p_y * p_y)) /
                                   (2 * pi * width * width * 2 * pi * deviation * deviation);
            mass += density * cell * cell;
            above += y > 0 ? density * cell * cell : 0;
            y_sum += y * density * cell * cell;
            y_squares += y * y * density * cell * cell;
        }
    const double angles = std::log(2 * pi * 1e8);  // two of each sensor
    const double share = above / mass, y_mean = y_sum / mass;
    const double y_deviation = std::sqrt(y_squares / mass - y_mean * y_mean);
    CHECK(share > 0.55);
    CHECK(share < 0.75);

    Average likelihood, told_share, told_mean, told_deviation;
    for (int r = 0; r < 30; ++r) {
        Tracked track{*filters.points, static_cast<std::uint64_t>(r)};
        const auto [mean, covariance] = run(track);
        const double* const weights = track.record.numbers.data() + 1;
        const double* const points = weights + 4000;
        double own = 0;
        for (int i = 0; i < 4000; ++i) own += points[i * 6 + 1] > 0 ? std::exp(weights[i]) : 0;
        told_share.add(own);
        told_mean.add(mean(1));
        told_deviation.add(std::sqrt(covariance(1, 1)));
        likelihood.add(std::exp(track.log_likelihood + 2 * angles) / mass);
    }
    CHECK(std::abs(likelihood.mean() - 1) < 4.5 * likelihood.error());
    CHECK(likelihood.error() < 0.05);
    CHECK(std::abs(told_share.mean() - share) < 4.5 * told_share.error());
    CHECK(told_share.error() < 0.03);
    CHECK(std::abs(told_mean.mean() - y_mean) < 4.5 * told_mean.error());
    CHECK(told_deviation.mean() == Approx(y_deviation).epsilon(0.03));
    CHECK(y_deviation > 600);

    Tracked linearised{*filters.gaussian};
    CHECK(std::sqrt(run(linearised).second(1, 1)) < 0.7 * y_deviation);  // sure of one place
}

TEST_CASE("particle: the same bytes whatever the batch, others for other keys", "[particle]") {
    const Filter filters({{"particles", "100"}}, {}, {{"position", {}}});
    const EstimatorUnderTest& filter = *filters.points;
    const auto drawn = keys(7, 0, 3);
    Batch mean(3, 1, 3), covariance(3, 3, 3), record(filter.record_size(), 1, 3);
    for (int i = 0; i < 3; ++i) {
        mean[i] = Eigen::Vector3d(100, 200, 300);
        covariance[i] = 100 * MatrixXd::Identity(3, 3);
    }
    Call call(3);
    call.raw().keys = drawn.data();
    REQUIRE(filter.init(call, {0, 1, 2}, mean, covariance, record) == PLR_OK);
    const double dt = 0.7;
    REQUIRE(filter.predict(call, pelorus::common_view(&dt, 1, 1, 3), record, record) == PLR_OK);
    CHECK(record[0] != record[1]);
    for (int i = 0; i < 3; ++i) {
        Batch x(3, 1), p(3, 3), single(filter.record_size(), 1);
        x[0] = mean[i];
        p[0] = covariance[i];
        Call own;
        own.raw().keys = &drawn[static_cast<std::size_t>(i)];
        REQUIRE(filter.init(own, {0, 1, 2}, x, p, single) == PLR_OK);
        REQUIRE(filter.predict(own, pelorus::const_view(&dt, 1, 1, 1), single, single) == PLR_OK);
        CHECK(single[0] == record[i]);
    }
    Call without;
    Batch x(3, 1), p(3, 3), single(filter.record_size(), 1);
    x[0] = mean[0];
    p[0] = covariance[0];
    CHECK(filter.init(without, {0, 1, 2}, x, p, single) != PLR_OK);
    CHECK_THAT(without.message(), Catch::Contains("draws random numbers"));
}

TEST_CASE("particle: drawn anew, each point is taken as often as its weight says, but for a fraction", "[particle]") {
    const Values moving{{"dimension", "1"}};
    const Filter never({{"particles", "300"}, {"resample_below", "0"}}, moving, {{"position", {{"dimension", "1"}}}});
    const Filter always({{"particles", "300"}, {"resample_below", "1"}}, moving, {{"position", {{"dimension", "1"}}}});
    Tracked weighted{*never.points}, drawn{*always.points};
    for (Tracked* track : {&weighted, &drawn}) {
        track->start({0, 1}, Eigen::Vector2d(0, 0), 100 * MatrixXd::Identity(2, 2));
        track->update(0, VectorXd::Constant(1, 6), MatrixXd::Constant(1, 1, 25));
    }
    std::map<double, int> taken;
    const double *const log_weights = weighted.record.numbers.data() + 1, *const points = log_weights + 300;
    for (int i = 0; i < 300; ++i) ++taken[(drawn.record.numbers.data() + 301)[2 * i]];
    double squares = 0;
    for (int i = 0; i < 300; ++i) {
        const double weight = std::exp(log_weights[i]);
        squares += weight * weight;
        CHECK(std::abs(taken[points[2 * i]] - 300 * weight) < 1);
        CHECK((drawn.record.numbers.data() + 1)[i] == Approx(-std::log(300.0)));
    }
    CHECK(1 / squares < 200);  // there was something to draw
    // A weighted cloud and the one drawn from it have about the same moments.
    CHECK(drawn.moments().first(0) == Approx(weighted.moments().first(0)).margin(0.2));
    CHECK(drawn.moments().second(0, 0) == Approx(weighted.moments().second(0, 0)).epsilon(0.1));
}

TEST_CASE("particle: roughening moves points that were drawn together, as far as it says", "[particle]") {
    const Values moving{{"dimension", "1"}};
    const auto spread_after = [&](const std::string& roughening) {
        const Filter filters({{"particles", "1000"}, {"roughening", roughening}}, moving,
                             {{"position", {{"dimension", "1"}}}});
        Tracked track{*filters.points};
        track.start({0, 1}, Eigen::Vector2d(0, 0), 100 * MatrixXd::Identity(2, 2));
        track.update(0, VectorXd::Constant(1, 20), MatrixXd::Constant(1, 1, 0.01));
        std::map<double, int> places;
        for (int i = 0; i < 1000; ++i) ++places[(track.record.numbers.data() + 1001)[2 * i]];
        return places.size();
    };
    CHECK(spread_after("0") < 100);
    CHECK(spread_after("0.2") == 1000);
}

TEST_CASE("particle: directions are averaged round the circle", "[particle]") {
    const double points[] = {3.1, 1, -3.1, 3}, weights[] = {0.5, 0.5};
    double mean[2], covariance[4];
    particle::moments_of(points, 2, weights, 2, {0}, mean, covariance);
    const double pi = std::acos(-1.0);
    CHECK(std::abs(pelorus::wrap_angle(mean[0] - pi)) < 1e-12);
    CHECK(mean[1] == Approx(2));
    CHECK(covariance[0] == Approx((pi - 3.1) * (pi - 3.1)));
    CHECK(covariance[3] == Approx(1));
    CHECK(covariance[1] == Approx(pi - 3.1));  // the direction turns on as the other grows
}

TEST_CASE("particle: a measurement without noise, and a step back, fail in one line", "[particle]") {
    const Filter filters({{"particles", "50"}}, {{"dimension", "1"}}, {{"position", {{"dimension", "1"}}}});
    Tracked track{*filters.points};
    track.start({0, 1}, Eigen::Vector2d(0, 0), MatrixXd::Identity(2, 2));
    const auto drawn = keys(0, 9);
    Call call, back;
    call.raw().keys = back.raw().keys = drawn.data();
    Batch z(1, 1), out = track.record;
    z[0](0) = 0;
    const double none = 0, past = -1;
    EstimatorUnderTest::Told told(1, 1);
    CHECK(filters.points->update(call, 0, track.record, z, pelorus::const_view(&none, 1, 1, 1), out, told) ==
          PLR_ITEMS_FAILED);
    CHECK(call.status() == PLR_E_NUMERIC);
    CHECK_THAT(call.message(), Catch::Contains("not positive definite"));
    CHECK(filters.points->predict(back, pelorus::const_view(&past, 1, 1, 1), track.record, out) == PLR_ITEMS_FAILED);
    CHECK(back.status() == PLR_E_UNSUPPORTED);
}
