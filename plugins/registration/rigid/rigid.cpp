// registration.rigid: moves scans and tracks into other axes. See README.md.
#include "rigid_registration.hpp"

PELORUS_PLUGIN(rigid::RigidRegistration, "registration.rigid");
