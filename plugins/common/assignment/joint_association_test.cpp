#include "joint_association.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "../../../tests/support/reference.hpp"

using assignment::associate_jointly;
using assignment::JointWeights;
using assignment::LikelihoodRatio;

namespace {

constexpr double no_limit = 1e7;

/// Weights by listing all events, one choice a track after another, and adding up those that are possible.
JointWeights by_listing(const std::vector<LikelihoodRatio>& pairs, std::size_t tracks) {
    JointWeights weights;
    weights.pairs.assign(pairs.size(), 0.0);
    weights.none.assign(tracks, 0.0);
    std::vector<std::vector<std::size_t>> options(tracks);
    for (std::size_t i = 0; i < pairs.size(); ++i) options[pairs[i].track].push_back(i);
    std::vector<std::size_t> choice(tracks, 0);  // 0: none
    double total = 0;
    for (bool more = true; more;) {
        std::vector<std::size_t> seen;
        double product = 1;
        for (std::size_t t = 0; t < tracks; ++t) {
            if (choice[t] == 0) continue;
            const LikelihoodRatio& pair = pairs[options[t][choice[t] - 1]];
            if (std::find(seen.begin(), seen.end(), pair.detection) != seen.end()) product = 0;
            seen.push_back(pair.detection);
            product *= std::exp(pair.log_ratio);
        }
        total += product;
        for (std::size_t t = 0; t < tracks; ++t)
            (choice[t] == 0 ? weights.none[t] : weights.pairs[options[t][choice[t] - 1]]) += product;
        more = false;
        for (std::size_t t = 0; t < tracks && !more; ++t) {
            more = choice[t] < options[t].size();
            choice[t] = more ? choice[t] + 1 : 0;
        }
    }
    for (double& weight : weights.pairs) weight /= total;
    for (double& weight : weights.none) weight /= total;
    return weights;
}

}  // namespace

TEST_CASE("Joint association gives the published library's weights for two tracks and three detections",
          "[assignment]") {
    const auto entry = test_support::reference("models_and_filters.json").at("JPDA 2 tracks 3 detections");
    // Constant velocity, order x, vx, y, vy; the position is measured.
    const double dt = entry.at("dt"), q = entry.at("q");
    Eigen::Matrix4d f = Eigen::Matrix4d::Identity(), noise = Eigen::Matrix4d::Zero();
    for (const int axis : {0, 2}) {
        f(axis, axis + 1) = dt;
        noise.block<2, 2>(axis, axis) << q * dt * dt * dt / 3, q * dt * dt / 2, q * dt * dt / 2, q * dt;
    }
    Eigen::Matrix<double, 2, 4> h = Eigen::Matrix<double, 2, 4>::Zero();
    h(0, 0) = h(1, 2) = 1;
    const Eigen::Matrix4d predicted = f * Eigen::Matrix4d(test_support::matrix(entry.at("P"))) * f.transpose() + noise;
    const Eigen::Matrix2d s = h * predicted * h.transpose() + Eigen::Matrix2d(test_support::matrix(entry.at("R")));
    const assignment::DetectionModel model{entry.at("pd"), entry.at("pg"), entry.at("clutter")};
    std::vector<LikelihoodRatio> pairs;
    for (std::size_t t = 0; t < 2; ++t)
        for (std::size_t d = 0; d < 3; ++d) {
            const Eigen::Vector2d e = Eigen::Vector2d(test_support::matrix(entry.at("z").at(d))) -
                                      h * f * Eigen::Vector4d(test_support::matrix(entry.at("tracks").at(t)));
            const double squared = e.dot(s.inverse() * e);
            pairs.push_back({t, d, assignment::log_detection_ratio(squared, std::log(s.determinant()), 2, model)});
        }
    const JointWeights weights = associate_jointly(pairs, 2, no_limit);
    CHECK(weights.dropped == 0);
    for (std::size_t t = 0; t < 2; ++t) {
        const auto& beta = entry.at("result").at(t).at("beta");
        CHECK(weights.none[t] == Approx(beta.at("miss").get<double>()).epsilon(1e-12));
        for (std::size_t d = 0; d < 3; ++d)
            CHECK(weights.pairs[3 * t + d] == Approx(beta.at(std::to_string(d)).get<double>()).epsilon(1e-12));
    }
}

TEST_CASE("Joint association adds up what listing all events adds up", "[assignment]") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> log_ratio(-4, 8);
    for (int trial = 0; trial < 200; ++trial) {
        const std::size_t tracks = 1 + random() % 5;
        std::vector<LikelihoodRatio> pairs;
        for (std::size_t t = 0; t < tracks; ++t)
            for (std::size_t d = 0; d < 6; ++d)
                if (random() % 3 == 0) pairs.push_back({t, 10 * d, log_ratio(random)});
        const JointWeights weights = associate_jointly(pairs, tracks, no_limit), expected = by_listing(pairs, tracks);
        for (std::size_t t = 0; t < tracks; ++t) REQUIRE(weights.none[t] == Approx(expected.none[t]).margin(1e-14));
        for (std::size_t i = 0; i < pairs.size(); ++i)
            REQUIRE(weights.pairs[i] == Approx(expected.pairs[i]).margin(1e-14));
    }
}

TEST_CASE("Joint association of ratios beyond all exponents still tells a detection's owner", "[assignment]") {
    // Both claim the only detection; the first does with a ratio e^3 times as large. Ten such clusters.
    std::vector<LikelihoodRatio> pairs;
    for (std::size_t t = 0; t < 20; ++t) pairs.push_back({t, t / 2, t % 2 == 0 ? 703.0 : 700.0});
    const JointWeights weights = associate_jointly(pairs, 20, no_limit);
    for (std::size_t t = 0; t < 20; t += 2) {
        CHECK(weights.pairs[t] == Approx(1 / (1 + std::exp(-3.0))));
        CHECK(weights.none[t + 1] == Approx(weights.pairs[t]));
    }
    const JointWeights hopeless = associate_jointly({{0, 0, -900}, {1, 0, -901}}, 2, no_limit);
    CHECK(hopeless.none[0] == 1);
    CHECK(hopeless.pairs[1] == 0);
}

TEST_CASE("Joint association of a crowd leaves out its weakest pairs and no more than it must", "[assignment]") {
    // Tracks and detections in a line; each track reaches its own detection and, weakly, its neighbours': one cluster.
    std::vector<LikelihoodRatio> pairs;
    const std::size_t tracks = 12;
    for (std::size_t t = 0; t < tracks; ++t)
        for (std::size_t d = t == 0 ? 0 : t - 1; d <= t + 1 && d < tracks; ++d)
            pairs.push_back({t, d, d == t ? 6.0 : 0.01 * static_cast<double>(t)});
    const JointWeights exact = associate_jointly(pairs, tracks, no_limit);
    CHECK(exact.dropped == 0);
    const JointWeights split = associate_jointly(pairs, tracks, 500);
    CHECK(split.dropped > 0);
    CHECK(split.dropped < 20);
    for (std::size_t i = 0; i < pairs.size(); ++i) CHECK(split.pairs[i] == Approx(exact.pairs[i]).margin(0.02));
    std::vector<double> sums = split.none;
    for (std::size_t i = 0; i < pairs.size(); ++i) sums[pairs[i].track] += split.pairs[i];
    for (const double sum : sums) CHECK(sum == Approx(1));
    CHECK(associate_jointly(pairs, tracks, 2).dropped == pairs.size() - tracks);  // each track keeps its own detection
}

TEST_CASE("Joint association of nothing is nothing", "[assignment]") {
    const JointWeights weights = associate_jointly({}, 3, no_limit);
    CHECK(weights.none == std::vector<double>{1, 1, 1});
    CHECK(weights.pairs.empty());
}
