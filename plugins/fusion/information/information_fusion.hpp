/// fusion.information: scans and tracks as sums of information. See README.md.
#pragma once

#include "../../common/fusion/rules.hpp"
#include "../../common/fusion/track_fusion.hpp"

namespace information {

enum class Common { none, told };

class InformationFusion : public fusion::TrackFusion<InformationFusion> {
public:
    static constexpr bool takes_common = true;

    static void describe(pelorus::Describe<InformationFusion>& plugin) {
        plugin.title("Information fusion")
            .purpose(
                "Makes one scan of those that several sensors have made at one time: their information adds up. Makes "
                "one list of tracks of those of two trackers, and takes away once what both know from the same source: "
                "a common start, or what they told each other before.")
            .equation(
                "scans: Y = sum H_i' R_i^-1 H_i, y = sum H_i' R_i^-1 z_i; tracks: Y = P_1^-1 + P_2^-1 - P_c^-1, y = "
                "P_1^-1 x_1 + P_2^-1 x_2 - P_c^-1 x_c; P = Y^-1, x = P y")
            .source(
                "C. Y. Chong, S. Mori, K. C. Chang, Distributed multitarget multisensor tracking, in: Y. Bar-Shalom "
                "(ed.), Multitarget-Multisensor Tracking: Advanced Applications, Artech House, 1990, chapter 8; S. "
                "Grime, H. F. Durrant-Whyte, Data fusion in decentralized sensor networks, Control Engineering "
                "Practice "
                "2(5), 849-863, 1994");
        describe_scans(plugin);
        plugin.parameter("common_information", &InformationFusion::common_)
            .initially("none")
            .choices({{"none", "tracks share none: they add up"},
                      {"told", "comes in at port `common` for each time, and is waited for as tracks are"}})
            .doc("of two tracks of one object");
        describe_tracks(plugin);
    }
    void setup(const pelorus::Setup& setup) {
        setup_scans(setup);
        setup_tracks();
    }

    bool wants_common() const noexcept { return common_ == Common::told; }
    bool fuse(const std::vector<fusion::Piece>& pieces, fusion::Fused& out) const {
        return fusion::add_information(common(), pieces, out);
    }
    bool fuse_tracks(const fusion::TrackPair& pair, fusion::Fused& out) const {
        if (!wants_common()) return fusion::add_information(pair.space, {pair.first, pair.second}, out);
        return pair.common && fusion::fuse_without(pair.space, pair.first, pair.second, *pair.common, out);
    }

private:
    Common common_ = Common::none;
};

}  // namespace information
