// partitioner.expectation_maximisation: cells by a mixture of Gaussians, from predictions or from seeds. See README.md.
#include "expectation_maximisation.hpp"

PELORUS_PLUGIN(expectation_maximisation::ExpectationMaximisation, "partitioner.expectation_maximisation");
