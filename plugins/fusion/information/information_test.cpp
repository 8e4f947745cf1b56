#include <Eigen/Dense>

#include "../../common/fusion/fusion_rig.hpp"
#include "../../common/fusion/rules.hpp"
#include "information_fusion.hpp"

namespace {

using namespace fusion_rig;
using information::InformationFusion;

struct InformationRig : Rig<InformationFusion> {
    explicit InformationRig(const std::string& with) : Rig("fusion.information", with) {}
    InformationRig(const std::string& with, const std::vector<std::array<std::string, 3>>& sensors)
        : Rig("fusion.information", with, sensors) {}
};
constexpr std::uint32_t first = InformationFusion::first_in, other = InformationFusion::second_in,
                        shared = InformationFusion::common_in;

struct Estimate {
    VectorXd mean;
    MatrixXd covariance;
};
/// A Kalman update by a measurement of both coordinates.
Estimate updated(const Estimate& prior, const VectorXd& z, const MatrixXd& r) {
    const MatrixXd gain = prior.covariance * MatrixXd(prior.covariance + r).inverse();
    return {prior.mean + gain * (z - prior.mean), prior.covariance - gain * prior.covariance};
}

}  // namespace

TEST_CASE("information fusion: scans of independent sensors are fused as by their inverse variances", "[fusion]") {
    InformationRig rig("{}");
    const MatrixXd radar = full(3, 1), eo = full(2, 2);
    const VectorXd z = vector({1000, 0.1, 1.1}), angles = vector({0.3, 1.2});
    rig.scan("radar", 1, {{1, z, radar}});
    rig.scan("eo", 1, {{2, angles, eo}});
    const MatrixXd h = MatrixXd::Identity(3, 3).bottomRows(2);
    const MatrixXd gain = radar * h.transpose() * MatrixXd(h * radar * h.transpose() + eo).inverse();
    REQUIRE(rig.told().size() == 1);
    CHECK((rig.told()[0].means[0] - (z + gain * (angles - h * z))).norm() < 1e-9);
    CHECK((rig.told()[0].covariances[0] - (radar - gain * h * radar)).norm() < 1e-12);
}

TEST_CASE("information fusion: two filters without what they share know what one central filter does", "[fusion]") {
    const Estimate prior{vector({5, -3}), full(2, 1)};
    const VectorXd z1 = vector({6, -2}), z2 = vector({4, -5});
    const MatrixXd r1 = full(2, 2), r2 = full(2, 3);
    const Estimate one = updated(prior, z1, r1), two = updated(prior, z2, r2), central = updated(one, z2, r2);
    InformationRig rig("{dimension: 2, derivatives: position, common_information: told}", {}),
        naive("{dimension: 2, derivatives: position}", {});
    for (InformationRig* each : {&rig, &naive}) {
        each->tracks(first, 1, {{1, one.mean, one.covariance}});
        each->tracks(shared, 1, {{4, vector({1000, 0}), prior.covariance}, {3, prior.mean, prior.covariance}});
        each->tracks(other, 1, {{2, two.mean, two.covariance}});
        REQUIRE(each->fused().size() == 1);
    }
    CHECK((rig.fused()[0].mean - central.mean).norm() < 1e-10);
    CHECK((rig.fused()[0].covariance - central.covariance).norm() < 1e-10);
    CHECK(naive.fused()[0].covariance.trace() < central.covariance.trace());  // counts the prior twice
}

TEST_CASE("information fusion: without the shared information, where it is due, the first track stands", "[fusion]") {
    InformationRig rig("{dimension: 2, derivatives: position, common_information: told}", {});
    const MatrixXd p = full(2, 1);
    rig.tracks(first, 1, {{1, vector({1, 2}), p}});
    rig.tracks(other, 1, {{2, vector({3, 2}), p}});
    CHECK(rig.bench.published.empty());
    rig.stage->finish();
    CHECK(rig.fused()[0].covariance == p);
    CHECK(rig.fused()[0].mean == vector({1, 2}));
    CHECK(rig.bench.counters.at("tracks_not_fused") == 1);
}
