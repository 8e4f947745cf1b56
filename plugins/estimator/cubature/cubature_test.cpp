// The cubature filter against the step of an established library. What holds for all point filters is tested beside their engine.
#include "../../../tests/support/reference_step.hpp"

TEST_CASE("the cubature filter's step agrees with the reference library", "[cubature]") {
    test_support::check_reference_step("cubature", {}, "filter CKF");
}
