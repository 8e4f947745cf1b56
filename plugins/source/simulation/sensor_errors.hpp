/// What is wrong with a sensor beyond its noise: told to its model through the inputs that the model declares for it.
#pragma once

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <pelorus/caller.hpp>
#include <pelorus/messages.hpp>
#include <pelorus/parts.hpp>

namespace simulation {

/// Gives the part's input `name` these values, from now on and for ever. Throws PartError where its model has no such input, or one of
/// another size.
inline void tell_error(pelorus::Caller& caller, const pelorus::SensorPart& part, const char* name,
                       const std::vector<double>& values) {
    const plr_description& description = *part.raw().description;
    const plr_input* input = nullptr;
    const char* at = reinterpret_cast<const char*>(description.inputs);
    for (std::uint32_t i = 0; i < description.input_count; ++i) {
        const auto& declared = *reinterpret_cast<const plr_input*>(at);
        if (std::strcmp(declared.name, name) == 0) input = &declared;
        at += declared.struct_size;
    }
    const std::string about = "sensor " + part.name() + " has a value for `" + name + "`, ";
    if (input == nullptr)
        throw pelorus::PartError("sensors", about + "but " + part.id() + " has no input of that name");
    if (input->size != values.size())
        throw pelorus::PartError("sensors", about + "which of " + part.id() + " has " + std::to_string(input->size) +
                                                " numbers, not " + std::to_string(values.size()));
    pelorus::ValuesBuilder told;
    told.add(part.name().empty() ? "sensors" : "sensors." + part.name(), name, input->unit,
             Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
    if (caller.take(*told.message(0).body.values) == 0)
        throw pelorus::UnsupportedError("this host gives no place to the inputs of sensor " + part.name());
}

}  // namespace simulation
