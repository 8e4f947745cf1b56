/// fusion.weighted: one scan of several sensors', one list of tracks of two trackers', weighted by the reciprocals of their
/// (co)variances. See README.md.
#pragma once

#include "../../common/fusion/rules.hpp"
#include "../../common/fusion/track_fusion.hpp"

namespace weighted {

enum class Rule { scalar, matrix };

class WeightedFusion : public fusion::TrackFusion<WeightedFusion> {
public:
    static constexpr bool takes_common = false;
    static constexpr std::uint32_t cross_in = 3;  ///< in port, after those of every fusion

    static void describe(pelorus::Describe<WeightedFusion>& plugin);
    void setup(const pelorus::Setup& setup) {
        setup_scans(setup);
        setup_tracks();
    }
    void on_values(const pelorus::Event& event, const plr_values& values);

    bool wants_common() const noexcept { return false; }
    bool fuse(const std::vector<fusion::Piece>& pieces, fusion::Fused& out) const {
        return rule_ == Rule::scalar ? fusion::weigh_components(common(), pieces, out)
                                     : fusion::add_information(common(), pieces, out);
    }
    bool fuse_tracks(const fusion::TrackPair& pair, fusion::Fused& out) const;

    template <class Archive> void state(Archive& archive) {
        TrackFusion::state(archive);
        archive(cross_);
    }

private:
    /// The covariance of the errors of the first tracker's tracks with those of the second's.
    struct Cross {
        Eigen::MatrixXd matrix;
        std::int64_t valid_from = 0, valid_to = 0;  ///< ns
        template <class Archive> void state(Archive& archive) { archive(matrix, valid_from, valid_to); }
    };

    Rule rule_ = Rule::matrix;
    double correlation_ = 0;
    std::optional<Cross> cross_;  ///< state
};

}  // namespace weighted
