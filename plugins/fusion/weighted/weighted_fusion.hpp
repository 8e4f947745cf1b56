/// fusion.weighted: one scan of several sensors', weighted by the reciprocals of their variances. See README.md.
#pragma once

#include "../../common/fusion/rules.hpp"
#include "../../common/fusion/scan_fusion.hpp"

namespace weighted {

enum class Rule { scalar, matrix };

class WeightedFusion : public fusion::ScanFusion<WeightedFusion> {
public:
    static void describe(pelorus::Describe<WeightedFusion>& plugin) {
        plugin.title("Weighted fusion")
            .purpose(
                "Makes one scan of those that several sensors have made at one time. Errors of different sensors are "
                "taken "
                "to be independent; a component that only one of them measures is that one's.")
            .equation(
                "scalar: x = sum(z_i / s_i^2) / sum(1 / s_i^2), s^2 = 1 / sum(1 / s_i^2), each component by itself; "
                "matrix: P^-1 = sum H_i' R_i^-1 H_i, x = P sum H_i' R_i^-1 z_i")
            .source(
                "X. Xiang et al., Computer Measurement & Control 31(5), 2023, section 4 (scalar); Y. Bar-Shalom, P. K. "
                "Willett, X. Tian, Tracking and Data Fusion, YBS, 2011, section 8.3 (matrix)");
        describe_scans(plugin);
        plugin.parameter("rule", &WeightedFusion::rule_)
            .initially("matrix")
            .choices({{"scalar", "each component by its variance; covariances between components are left out"},
                      {"matrix", "with whole covariances"}})
            .doc("how measurements are weighted");
    }
    void setup(const pelorus::Setup& setup) { setup_scans(setup); }

    bool fuse(const std::vector<fusion::Piece>& pieces, fusion::Fused& out) const {
        return rule_ == Rule::scalar ? fusion::weigh_components(common(), pieces, out)
                                     : fusion::add_information(common(), pieces, out);
    }

private:
    Rule rule_ = Rule::matrix;
};

}  // namespace weighted
