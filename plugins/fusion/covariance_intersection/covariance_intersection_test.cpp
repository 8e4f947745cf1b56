#include "../../common/fusion/fusion_rig.hpp"
#include "covariance_intersection_fusion.hpp"

namespace {

using namespace fusion_rig;
using covariance_intersection::CovarianceIntersection;

struct IntersectionRig : Rig<CovarianceIntersection> {
    explicit IntersectionRig(const std::string& with) : Rig("fusion.covariance_intersection", with) {}
    IntersectionRig(const std::string& with, const std::vector<std::array<std::string, 3>>& sensors)
        : Rig("fusion.covariance_intersection", with, sensors) {}
};
constexpr std::uint32_t first = CovarianceIntersection::first_in, second_tracker = CovarianceIntersection::second_in;

}  // namespace

TEST_CASE("covariance intersection of tracks: the weight that makes the determinant least", "[fusion]") {
    IntersectionRig rig("{dimension: 2, derivatives: position}", {});
    rig.tracks(first, 1, {{1, vector({10, 0}), diagonal({1, 4})}});
    rig.tracks(second_tracker, 1, {{2, vector({12, 3}), diagonal({9, 1})}});
    // d/dw of -ln(w + (1-w)/9) - ln(w/4 + (1-w)) is 0 where 8 (4 - 3 w) = 3 (1 + 8 w).
    const double w = 29.0 / 48, x = 1 / (w + (1 - w) / 9), y = 1 / (w / 4 + 1 - w);
    const auto told = rig.fused();
    REQUIRE(told.size() == 1);
    CHECK(told[0].covariance(0, 0) == Approx(x));
    CHECK(told[0].covariance(1, 1) == Approx(y));
    CHECK(told[0].mean(0) == Approx(x * (w * 10 + (1 - w) / 9 * 12)));
    CHECK(told[0].mean(1) == Approx(y * (1 - w) * 3));
}

TEST_CASE("covariance intersection of tracks: the same track twice is no surer than once", "[fusion]") {
    const std::string criterion = GENERATE("determinant", "trace");
    IntersectionRig rig("{dimension: 2, derivatives: position, criterion: " + criterion + "}", {});
    const MatrixXd p = full(2, 3);
    rig.tracks(first, 1, {{1, vector({10, 0}), p}});
    rig.tracks(second_tracker, 1, {{2, vector({10, 0}), p}});
    CHECK((rig.fused()[0].covariance - p).norm() < 1e-12);
    CHECK((rig.fused()[0].mean - vector({10, 0})).norm() < 1e-12);
}

TEST_CASE("covariance intersection of scans: the range that one sensor tells pays for angles of both", "[fusion]") {
    IntersectionRig rig("{}");
    rig.scan("radar", 1, {{1, vector({1000, 0.1, 1.1}), diagonal({25, 9e-6, 9e-6})}});
    rig.scan("eo", 1, {{2, vector({0.102, 1.1}), diagonal({1e-10, 1e-10})}});
    const auto told = rig.told();
    REQUIRE(told.size() == 1);
    // ln det P = -ln w/25 - 2 ln(w a + (1-w) b): 1/w = 2 (b - a)/(b - w (b - a)), w = b/(3 (b - a)).
    const double a = 1 / 9e-6, b = 1e10, w = b / (3 * (b - a));
    CHECK(told[0].covariances[0](0, 0) == Approx(25 / w));
    CHECK(told[0].covariances[0](1, 1) == Approx(1 / (w * a + (1 - w) * b)));
    CHECK(told[0].means[0](0) == Approx(1000));
    CHECK(told[0].means[0](1) == Approx(0.102).epsilon(1e-5));
}

TEST_CASE("covariance intersection of scans: an alone sensor keeps its covariance", "[fusion]") {
    IntersectionRig rig("{}");
    const MatrixXd noise = full(3, 8);
    rig.scan("radar", 1, {{1, vector({1000, 0.1, 1.1}), noise}});
    rig.stage->finish();
    REQUIRE(rig.told().size() == 1);
    CHECK((rig.told()[0].covariances[0] - noise).norm() < 1e-12);
}
