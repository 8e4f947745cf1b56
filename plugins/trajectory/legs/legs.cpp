// trajectory.legs: straight lines and arcs, in closed form. See README.md.
#include "legs.hpp"

PELORUS_PLUGIN(legs::Legs, "trajectory.legs");
