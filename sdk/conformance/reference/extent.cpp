// A plain random matrix, for trackers that are tried without another extent.
#include "reference_parts.hpp"
#include "scatter_matrix.hpp"

namespace pelorus::conformance {

namespace {

struct Extent : ScatterMatrix<Extent> {
    static void describe(Describe<Extent>& plugin) {
        plugin.title("Plain random matrix, three axes");
        describe_memory(plugin);
    }
};

}  // namespace

const plr_plugin* reference_extent() {
    return pelorus::detail::plugin<Extent>("pelorus.conformance.extent", "pelorus.conformance.extent");
}

}  // namespace pelorus::conformance
