/// Plugins whose sizes follow from a parameter: reading that parameter before there is an instance.
#pragma once

#include <cstring>
#include <string>

#include <pelorus/plugin.hpp>

namespace sensing {

/// The parsed value of a parameter of the plugin that `Described` describes. Throws ParameterError where it declares none.
template <class Described> const plr_value& parameter_value(const pelorus::Setup& setup, const char* name) {
    const plr_description& description = *pelorus::Describe<Described>::of().c();
    const auto* at = reinterpret_cast<const char*>(setup.raw().values);
    for (std::uint32_t i = 0; i < description.parameter_count; ++i, at += setup.raw().values->struct_size)
        if (std::strcmp(description.parameters[i].name, name) == 0) return *reinterpret_cast<const plr_value*>(at);
    throw pelorus::ParameterError(name, "is not described by this plugin");
}

}  // namespace sensing
