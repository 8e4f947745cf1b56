// registration.least_squares: the stream of one sensor at the times of another, by a polynomial. See README.md.
#include "least_squares_stage.hpp"

PELORUS_PLUGIN(least_squares::LeastSquares, "registration.least_squares");
