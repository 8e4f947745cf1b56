/// Pelorus for plugin authors in C++: everything. One class, one line: see plugin.hpp.
#pragma once

#include <pelorus/batch_model.hpp>
#include <pelorus/caller.hpp>
#include <pelorus/motion.hpp>
#include <pelorus/sensor.hpp>
#include <pelorus/stage.hpp>
