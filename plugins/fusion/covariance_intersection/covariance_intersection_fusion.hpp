/// fusion.covariance_intersection: scans and tracks whose errors may be correlated in any way. See README.md.
#pragma once

#include "../../common/fusion/rules.hpp"
#include "../../common/fusion/track_fusion.hpp"

namespace covariance_intersection {

class CovarianceIntersection : public fusion::TrackFusion<CovarianceIntersection> {
public:
    static constexpr bool takes_common = false;

    static void describe(pelorus::Describe<CovarianceIntersection>& plugin) {
        plugin.title("Covariance intersection")
            .purpose(
                "Makes one scan of those that several sensors have made at one time, or one list of tracks of those of "
                "two trackers, whose errors may be correlated in ways that nobody knows. Whatever they are, the fused "
                "covariance is not too small.")
            .equation(
                "P^-1 = sum w_i H_i' R_i^-1 H_i, x = P sum w_i H_i' R_i^-1 z_i, w_i >= 0, sum w_i = 1, such that det P "
                "or tr P is least")
            .source(
                "S. J. Julier, J. K. Uhlmann, A Non-divergent Estimation Algorithm in the Presence of Unknown "
                "Correlations, Proceedings of the American Control Conference, 2369-2373, 1997");
        describe_scans(plugin);
        plugin.parameter("criterion", &CovarianceIntersection::criterion_)
            .initially("determinant")
            .choices({{"determinant", "of P; the same in whatever units"},
                      {"trace", "of P; components of different units count by their numbers in SI"}})
            .doc("what the weights make least");
        describe_tracks(plugin);
    }
    void setup(const pelorus::Setup& setup) {
        setup_scans(setup);
        setup_tracks();
    }

    bool wants_common() const noexcept { return false; }
    bool fuse(const std::vector<fusion::Piece>& pieces, fusion::Fused& out) const {
        return intersect(common(), pieces, out);
    }
    bool fuse_tracks(const fusion::TrackPair& pair, fusion::Fused& out) const {
        return intersect(pair.space, {pair.first, pair.second}, out);
    }

private:
    bool intersect(const fusion::CommonSpace& space, const std::vector<fusion::Piece>& pieces,
                   fusion::Fused& out) const {
        std::vector<double> weights;
        return fusion::intersect(space, pieces, criterion_, weights, out);
    }

    fusion::Criterion criterion_ = fusion::Criterion::determinant;
};

}  // namespace covariance_intersection
