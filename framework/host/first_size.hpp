/// Structs of the ABI that tell their size and grow only at their end (space.h): how long each was when it came into the world, which
/// is all that the host may ask of a plugin. Whoever reads a member that came later looks at struct_size first.
#pragma once

#include <cstdint>

#include <pelorus/abi/abi.h>

namespace pelorus::host {

/// Not defined for a struct that is not listed.
template <class Struct> struct FirstSize;
template <class Struct> inline constexpr std::uint32_t first_size = FirstSize<Struct>::value;

// clang-format off
#define PELORUS_FIRST_SIZE(type, size) template <> struct FirstSize<type> { static constexpr std::uint32_t value = size; }
// clang-format on
PELORUS_FIRST_SIZE(plr_manifest, 256);
PELORUS_FIRST_SIZE(plr_description, 136);
PELORUS_FIRST_SIZE(plr_parameter, 112);
PELORUS_FIRST_SIZE(plr_input, 40);
PELORUS_FIRST_SIZE(plr_slot, 48);
PELORUS_FIRST_SIZE(plr_port, 32);
PELORUS_FIRST_SIZE(plr_space, 16);
PELORUS_FIRST_SIZE(plr_component, 40);
PELORUS_FIRST_SIZE(plr_stream, 32);
PELORUS_FIRST_SIZE(plr_external, 8);
PELORUS_FIRST_SIZE(plr_call, 88);
PELORUS_FIRST_SIZE(plr_frame_pose, 104);
PELORUS_FIRST_SIZE(plr_motion_info, 48);
PELORUS_FIRST_SIZE(plr_sensor_info, 48);
PELORUS_FIRST_SIZE(plr_estimator_info, 56);
PELORUS_FIRST_SIZE(plr_extent_info, 40);
PELORUS_FIRST_SIZE(plr_partitioner_info, 32);
PELORUS_FIRST_SIZE(plr_partition, 104);
PELORUS_FIRST_SIZE(plr_waveform_info, 40);
PELORUS_FIRST_SIZE(plr_trajectory_info, 48);
PELORUS_FIRST_SIZE(plr_message, 56);
PELORUS_FIRST_SIZE(plr_scan, 280);
PELORUS_FIRST_SIZE(plr_tracks, 352);
PELORUS_FIRST_SIZE(plr_truth, 192);
PELORUS_FIRST_SIZE(plr_values, 16);
PELORUS_FIRST_SIZE(plr_table, 96);
PELORUS_FIRST_SIZE(plr_quantity, 112);
PELORUS_FIRST_SIZE(plr_column, 48);
PELORUS_FIRST_SIZE(plr_scalar, 56);
#undef PELORUS_FIRST_SIZE

}  // namespace pelorus::host
