#include "rules.hpp"

#include <Eigen/Dense>

#include "../../../tests/support/reference.hpp"
#include "fusion_rig.hpp"

namespace {

using namespace fusion_rig;
using fusion::Criterion;
using fusion::Fused;
using fusion::Piece;

fusion::CommonSpace plain(int size) {
    fusion::CommonSpace out;
    std::vector<pelorus::Component> components;
    for (int c = 0; c < size; ++c) components.push_back({"c" + std::to_string(c), "m"});
    out.add(pelorus::Space(components), "test");
    return out;
}
std::vector<int> all_of(int size) {
    std::vector<int> out;
    for (int c = 0; c < size; ++c) out.push_back(c);
    return out;
}
void check_same(const MatrixXd& a, const MatrixXd& b, double margin = 1e-12) {
    CHECK((a - b).cwiseAbs().maxCoeff() < margin * std::max(1.0, b.cwiseAbs().maxCoeff()));
}

}  // namespace

TEST_CASE("rules of fusion: components get the reciprocals of their variances as weights", "[fusion]") {
    const auto common = plain(2);
    const Piece one{{0, 1}, vector({10, 4}), diagonal({4, 1})}, other{{0}, vector({13}), diagonal({2})};
    Fused fused;
    REQUIRE(fusion::weigh_components(common, {one, other}, fused));
    check_same(fused.mean, vector({12, 4}));  // (10 / 4 + 13 / 2) / (3 / 4)
    check_same(fused.covariance, diagonal({4.0 / 3, 1}));
    CHECK_FALSE(fusion::weigh_components(common, {other}, fused));  // nobody tells the second
    CHECK_FALSE(fusion::weigh_components(common, {one, {{0}, vector({1}), diagonal({0})}}, fused));
}

TEST_CASE("rules of fusion: angles meet across the cut", "[fusion]") {
    fusion::CommonSpace common;
    common.add(pelorus::Space(std::vector<pelorus::Component>{{"azimuth", "rad", 0, 0, true}}), "test");
    const double pi = std::acos(-1.0);
    const Piece one{{0}, vector({pi - 0.03}), diagonal({1})}, other{{0}, vector({-pi + 0.01}), diagonal({1})};
    for (const bool by_matrix : {false, true}) {
        Fused fused;
        REQUIRE((by_matrix ? fusion::add_information(common, {one, other}, fused)
                           : fusion::weigh_components(common, {one, other}, fused)));
        CHECK(fused.mean(0, 0) == Approx(pi - 0.01));
    }
}

TEST_CASE("rules of fusion: the sum of information is the update of one estimate by the other", "[fusion]") {
    const auto common = plain(3);
    const MatrixXd p = full(3, 1), r = full(2, 2);
    const VectorXd x = vector({1, 2, 3}), z = vector({4, -5});
    MatrixXd h = MatrixXd::Zero(2, 3);
    h(0, 2) = h(1, 0) = 1;  // the second tells the third and the first component
    const MatrixXd gain = p * h.transpose() * (h * p * h.transpose() + r).inverse();
    Fused fused;
    REQUIRE(fusion::add_information(common, {{all_of(3), x, p}, {{2, 0}, z, r}}, fused));
    check_same(fused.mean, x + gain * (z - h * x));
    check_same(fused.covariance, p - gain * h * p);
}

TEST_CASE("rules of fusion: independent components are the same for both rules", "[fusion]") {
    const auto common = plain(3);
    const std::vector<Piece> pieces{{all_of(3), vector({1, 2, 3}), diagonal({4, 5, 6})},
                                    {{1, 2}, vector({2.5, 2.5}), diagonal({0.5, 8})}};
    Fused one, other;
    REQUIRE(fusion::weigh_components(common, pieces, one));
    REQUIRE(fusion::add_information(common, pieces, other));
    check_same(one.mean, other.mean);
    check_same(one.covariance, other.covariance);
}

TEST_CASE("rules of fusion: covariance intersection of parts of a space gives the published library's estimates",
          "[fusion]") {
    const auto entry = test_support::reference("models_and_filters.json").at("CI weights=[0.3, 0.7]");
    const auto common = plain(2);
    const auto piece = [&](const nlohmann::json& told) {
        return Piece{all_of(2), test_support::matrix(told.at("x")), test_support::matrix(told.at("P"))};
    };
    const std::vector<Piece> pieces{piece(entry.at("a")), piece(entry.at("b"))};
    fusion::Column reference(2, 1);
    std::vector<fusion::Information> told;
    REQUIRE(common.reference(pieces, reference));
    REQUIRE(fusion::information_of(common, pieces, reference, told));
    Fused fused;
    REQUIRE(fusion::estimate_of(common, told, {0.3, 0.7}, reference, fused));
    check_same(fused.mean, test_support::matrix(entry.at("x")));
    check_same(fused.covariance, test_support::matrix(entry.at("P")));
}

TEST_CASE("rules of fusion: two estimates are intersected as by the rule for two", "[fusion]") {
    const Criterion criterion = GENERATE(Criterion::determinant, Criterion::trace);
    const auto common = plain(4);
    for (int trial = 0; trial < 20; ++trial) {
        const fusion::Estimate<6> a{vector({1, 2, 3, 4}), full(4, trial)}, b{vector({2, 0, 5, 4}), full(4, trial + 50)};
        fusion::Estimate<6> expected;
        double weight = 0;
        REQUIRE(fusion::covariance_intersection(a, b, criterion, weight, expected));
        Fused fused;
        std::vector<double> weights;
        REQUIRE(fusion::intersect(common, {{all_of(4), a.mean, a.covariance}, {all_of(4), b.mean, b.covariance}},
                                  criterion, weights, fused));
        CHECK(weights[0] == Approx(weight).margin(1e-9));
        check_same(fused.covariance, expected.covariance, 1e-9);
        check_same(fused.mean, expected.mean, 1e-8);
    }
}

TEST_CASE("rules of fusion: no weights of three estimates are better than those found", "[fusion]") {
    const Criterion criterion = GENERATE(Criterion::determinant, Criterion::trace);
    const auto common = plain(3);
    const auto score = [&](const Fused& fused) {
        const MatrixXd p = fused.covariance;
        return criterion == Criterion::trace ? p.trace() : p.determinant();
    };
    for (int trial = 0; trial < 5; ++trial) {
        const std::vector<Piece> pieces{{all_of(3), vector({0, 0, 0}), full(3, trial)},
                                        {all_of(3), vector({0, 0, 0}), full(3, trial + 20)},
                                        {{0, 2}, vector({0, 0}), full(2, trial + 40)}};
        std::vector<double> weights;
        Fused best;
        REQUIRE(fusion::intersect(common, pieces, criterion, weights, best));
        CHECK(weights[0] + weights[1] + weights[2] == Approx(1).epsilon(1e-12));
        fusion::Column reference(3, 1);
        std::vector<fusion::Information> told;
        REQUIRE(common.reference(pieces, reference));
        REQUIRE(fusion::information_of(common, pieces, reference, told));
        for (int i = 0; i <= 40; ++i)
            for (int j = 0; i + j <= 40; ++j) {
                Fused other;
                if (fusion::estimate_of(common, told, {i / 40.0, j / 40.0, (40 - i - j) / 40.0}, reference, other))
                    REQUIRE(score(best) <= score(other) * (1 + 1e-9));
            }
    }
}

TEST_CASE("rules of fusion: units that differ are refused", "[fusion]") {
    fusion::CommonSpace common;
    common.add(pelorus::Space(std::vector<pelorus::Component>{{"range", "m"}}), "sensors");
    CHECK_THROWS_WITH(common.add(pelorus::Space(std::vector<pelorus::Component>{{"range", "km"}}), "sensors"),
                      "range is told in m and in km");
}

TEST_CASE("rules of fusion: with a known cross-covariance no gain is better, and the covariance is the true one",
          "[fusion]") {
    const auto common = plain(3);
    for (int trial = 0; trial < 10; ++trial) {
        const MatrixXd joint = full(6, trial), cross = joint.topRightCorner(3, 3);
        const Piece first{all_of(3), vector({1, 2, 3}), joint.topLeftCorner(3, 3)};
        Piece second{all_of(3), first.mean, joint.bottomRightCorner(3, 3)};
        MatrixXd gain(3, 3);
        Fused fused;
        for (int column = 0; column < 3; ++column) {
            second.mean = first.mean;
            second.mean(column, 0) += 1;
            REQUIRE(fusion::fuse_correlated(common, first, second, cross, fused));
            gain.col(column) = MatrixXd(fused.mean) - MatrixXd(first.mean);
        }
        const auto covariance_by = [&](const MatrixXd& k) {
            MatrixXd weights(3, 6);
            weights << MatrixXd::Identity(3, 3) - k, k;
            return MatrixXd(weights * joint * weights.transpose());
        };
        check_same(fused.covariance, covariance_by(gain), 1e-11);
        for (int other = 0; other < 20; ++other) {
            MatrixXd k = gain;
            k(other % 3, other / 3 % 3) += other % 2 == 0 ? 0.05 : -0.05;
            CHECK(covariance_by(k).trace() > fused.covariance.trace());
        }
    }
}

TEST_CASE("rules of fusion: what two estimates share counts once", "[fusion]") {
    // Two filters start from one prior and see one measurement each; one filter that sees both knows the same as both together.
    const auto common = plain(3);
    const Piece prior{all_of(3), vector({1, 2, 3}), full(3, 4)};
    const Piece one{{0, 2}, vector({1.5, 2}), full(2, 5)}, other{{1}, vector({4}), full(1, 6)};
    Piece first = prior, second = prior;
    Fused fused, central;
    REQUIRE(fusion::add_information(common, {prior, one}, fused));
    first.mean = fused.mean;
    first.covariance = fused.covariance;
    REQUIRE(fusion::add_information(common, {prior, other}, fused));
    second.mean = fused.mean;
    second.covariance = fused.covariance;
    REQUIRE(fusion::add_information(common, {prior, one, other}, central));
    REQUIRE(fusion::fuse_without(common, first, second, prior, fused));
    check_same(fused.mean, central.mean, 1e-10);
    check_same(fused.covariance, central.covariance, 1e-10);
    // Nothing is left where more is said to be shared than either knows.
    const Piece too_much{all_of(3), prior.mean, 0.1 * full(3, 4)};
    CHECK_FALSE(fusion::fuse_without(common, prior, prior, too_much, fused));
}
