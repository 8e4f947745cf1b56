#include "host/first_size.hpp"

#include <catch2/catch.hpp>
#include <map>
#include <regex>

#include "host_fixtures.hpp"

using namespace pelorus::host;

namespace {

/// Sizes that the headers of ABI 1.1 assert, by struct.
std::map<std::string, std::uint32_t> sizes_of_first_release() {
    const std::string text = test::bytes_of(PELORUS_SOURCE_DIR "/tests/abi/headers-1.1/pelorus/abi/layout.h");
    const std::regex assertion(R"(PLR_SIZE\((plr_\w+), (\d+)\))");
    std::map<std::string, std::uint32_t> sizes;
    for (std::sregex_iterator at(text.begin(), text.end(), assertion), end; at != end; ++at)
        sizes[(*at)[1]] = static_cast<std::uint32_t>(std::stoul((*at)[2]));
    return sizes;
}

template <class... Structs> void expect_first_sizes(const std::vector<std::string>& names) {
    const std::vector<std::uint32_t> first = {first_size<Structs>...}, now = {sizeof(Structs)...};
    const std::map<std::string, std::uint32_t> released = sizes_of_first_release();
    REQUIRE(names.size() == first.size());
    for (std::size_t i = 0; i < names.size(); ++i) {
        CAPTURE(names[i]);
        REQUIRE(released.count(names[i]) == 1);
        CHECK(first[i] == released.at(names[i]));
        CHECK(first[i] <= now[i]);
    }
}

}  // namespace

TEST_CASE("The host asks plugins for no more than the structs of the first release had", "[host]") {
    expect_first_sizes<plr_manifest, plr_description, plr_parameter, plr_input, plr_slot, plr_port, plr_space,
                       plr_component, plr_stream, plr_external, plr_call, plr_frame_pose>(
        {"plr_manifest", "plr_description", "plr_parameter", "plr_input", "plr_slot", "plr_port", "plr_space",
         "plr_component", "plr_stream", "plr_external", "plr_call", "plr_frame_pose"});
    expect_first_sizes<plr_motion_info, plr_sensor_info, plr_estimator_info, plr_extent_info, plr_partitioner_info,
                       plr_partition, plr_waveform_info, plr_trajectory_info>(
        {"plr_motion_info", "plr_sensor_info", "plr_estimator_info", "plr_extent_info", "plr_partitioner_info",
         "plr_partition", "plr_waveform_info", "plr_trajectory_info"});
    expect_first_sizes<plr_message, plr_scan, plr_tracks, plr_truth, plr_values, plr_table, plr_quantity, plr_column,
                       plr_scalar>({"plr_message", "plr_scan", "plr_tracks", "plr_truth", "plr_values", "plr_table",
                                    "plr_quantity", "plr_column", "plr_scalar"});
}
