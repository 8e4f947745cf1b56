// registration.block_mean: blocks of a fast stream, each told as one measurement. See README.md.
#include "block_mean_stage.hpp"

PELORUS_PLUGIN(block_mean::BlockMean, "registration.block_mean");
