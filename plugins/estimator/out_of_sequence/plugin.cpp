#include "out_of_sequence.hpp"

PELORUS_PLUGIN(out_of_sequence::OutOfSequence, "estimator.out_of_sequence");
