/// Everything that an instance answers to the same questions, as lines of text: to compare two instances, also across processes.
#pragma once

#include <string>

#include "instance.hpp"
#include "sample.hpp"

namespace pelorus::conformance {

/// The calls of a model with arguments of that sample, every digit of them; the port types of a stage.
std::string answers_of(const Instance& instance, const Sample& sample);
/// The first line in which they differ, in words; "" if they do not.
std::string first_difference(const std::string& one, const std::string& other);

}  // namespace pelorus::conformance
