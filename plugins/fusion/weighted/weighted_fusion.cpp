#include "weighted_fusion.hpp"

namespace weighted {

void WeightedFusion::describe(pelorus::Describe<WeightedFusion>& plugin) {
    plugin.title("Weighted fusion")
        .purpose(
            "Makes one scan of those that several sensors have made at one time, whose errors are taken to be "
            "independent; a component that only one of them measures is that one's. Makes one list of tracks of those "
            "of two trackers, whose errors may have a covariance that is known.")
        .equation(
            "scalar: x = sum(z_i / s_i^2) / sum(1 / s_i^2), s^2 = 1 / sum(1 / s_i^2), each component by itself; "
            "matrix: "
            "P^-1 = sum H_i' R_i^-1 H_i, x = P sum H_i' R_i^-1 z_i; tracks: x = x_1 + K (x_2 - x_1), P = P_1 - K (P_1 "
            "- "
            "C)', K = (P_1 - C) (P_1 + P_2 - C - C')^-1")
        .source(
            "X. Xiang et al., Computer Measurement & Control 31(5), 2023, section 4 (scalar); Y. Bar-Shalom, P. K. "
            "Willett, X. Tian, Tracking and Data Fusion, YBS, 2011, section 8.3 (matrix); Y. Bar-Shalom, L. Campo, The "
            "effect of the common process noise on the two-sensor fused-track covariance, IEEE Transactions on "
            "Aerospace and Electronic Systems 22(6), 803-805, 1986 (tracks)");
    describe_scans(plugin);
    plugin.parameter("rule", &WeightedFusion::rule_)
        .initially("matrix")
        .choices({{"scalar", "each component by its variance; covariances between components are left out"},
                  {"matrix", "with whole covariances"}})
        .doc("how measurements are weighted");
    plugin.parameter("correlation", &WeightedFusion::correlation_)
        .initially("0")
        .min(0)
        .below(1)
        .doc("of the errors of two tracks of one object: C = rho P_1^1/2 P_2^1/2, where no `cross` tells C itself");
    describe_tracks(plugin);
    plugin.in_port("cross", PLR_MESSAGE_VALUES, "`cross_covariance`: C itself, in SI, while it is valid",
                   PLR_PORT_OPTIONAL);
}

void WeightedFusion::on_values(const pelorus::Event&, const plr_values& values) {
    const char* at = reinterpret_cast<const char*>(values.quantities);
    for (std::uint32_t i = 0; i < values.count; ++i) {
        const auto& quantity = *reinterpret_cast<const plr_quantity*>(at);
        at += quantity.struct_size;
        if (std::string(quantity.name) != "cross_covariance") continue;
        const auto n = static_cast<std::int64_t>(track_space().size());
        if (quantity.numbers.rows != n || quantity.numbers.cols != n || quantity.numbers.count != 1)
            throw pelorus::DataError("cross_covariance is " + std::to_string(quantity.numbers.rows) + " x " +
                                     std::to_string(quantity.numbers.cols) + ", tracks have " + std::to_string(n) +
                                     " components");
        cross_ = Cross{pelorus::item(quantity.numbers, 0), quantity.valid_from, quantity.valid_to};
    }
}

bool WeightedFusion::fuse_tracks(const fusion::TrackPair& pair, fusion::Fused& out) const {
    fusion::Square cross;
    if (cross_ && pair.time >= cross_->valid_from && pair.time <= cross_->valid_to)
        cross = cross_->matrix;
    else if (!fusion::cross_covariance(pair.first, pair.second, correlation_, cross))
        return false;
    return fusion::fuse_correlated(pair.space, pair.first, pair.second, cross, out);
}

}  // namespace weighted
