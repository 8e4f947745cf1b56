// registration.interpolate: the stream of one sensor at the times of another, between neighbouring samples. See README.md.
#include "interpolate_stage.hpp"

PELORUS_PLUGIN(interpolate::Interpolate, "registration.interpolate");
