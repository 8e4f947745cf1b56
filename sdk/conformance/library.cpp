// What every library promises before a plugin of it is made.
#include "machine/bench.hpp"

namespace pelorus::conformance {

PELORUS_CHECK(
    library, "library-loads", 1,
    "The library loads with RTLD_NOW | RTLD_LOCAL and its entry point is of this ABI; a host does nothing else "
    "with a library that does not.",
    {}) {
    bench.library();
}

}  // namespace pelorus::conformance
