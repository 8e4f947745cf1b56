// What stages of registration promise of what they hand on.
#include "scan_laws.hpp"

namespace pelorus::conformance {

PELORUS_CHECK(
    registration, "registration-measurements-came-in", 3,
    "Every measurement of a scan that goes out has the id of one that has come in, itself or one of those that it "
    "was made of: truth and tracks are joined by ids, and an invented one is clutter to all who look.",
    {"stage-publishes-what-it-declares", "stage-keeps-no-message"}) {
    check_measurements_came_in(bench);
}

PELORUS_CHECK(registration, "registration-covariances-positive", 3,
              "Covariances of what goes out are symmetric and positive, if those of what came in were; gates and gains "
              "are made of them.",
              {"stage-publishes-what-it-declares", "stage-keeps-no-message"}) {
    check_covariances_positive(bench);
}

}  // namespace pelorus::conformance
