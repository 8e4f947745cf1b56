/// Between the interposed functions and the watch.
#pragma once

#include "watch.hpp"

namespace pelorus::conformance::watch {

/// An interposed function has been called by the calling thread.
void observe(Concern concern, const char* function) noexcept;

}  // namespace pelorus::conformance::watch
