// trajectory.acceleration_profile: an acceleration given over time, integrated exactly. See README.md.
#include "acceleration_profile.hpp"

PELORUS_PLUGIN(acceleration_profile::AccelerationProfile, "trajectory.acceleration_profile");
