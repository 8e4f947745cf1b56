/// What holds of the scans and tracks of every stage that hands on, in whatever other form, what came in.
#pragma once

#include "machine/bench.hpp"
#include "machine/check.hpp"

namespace pelorus::conformance {

/// Fails the check unless the id of every measurement that goes out is one that has come in.
void check_measurements_came_in(const Bench& bench);

/// Fails the check unless covariances that go out are symmetric and have no negative direction.
void check_covariances_positive(const Bench& bench);

}  // namespace pelorus::conformance
