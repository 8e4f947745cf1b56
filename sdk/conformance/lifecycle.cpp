// Creation and destruction of instances of any kind.
#include "machine/bench.hpp"

namespace pelorus::conformance {

PELORUS_CHECK(
    every, "instance-is-made", 1,
    "create answers an instance for the defaults (and for each setting that is tried); without one nothing else "
    "can be tried.",
    {}) {
    const auto instance = bench.make();
    REQUIRE(instance->self() != nullptr);
}

}  // namespace pelorus::conformance
