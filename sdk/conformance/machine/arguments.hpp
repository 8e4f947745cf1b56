/// Arguments of calls, filled with samples.
#pragma once

#include <cstring>
#include <string>

#include <Eigen/Core>

#include "hot_call.hpp"

namespace pelorus::conformance {

inline HotCall make_call(const std::string& function, std::int64_t count) {
    HotCall call;
    call.function = function;
    call.count = count;
    return call;
}

/// An input whose item i is written by `fill(out, i)`, packed.
template <class Fill>
Argument input(const std::string& name, std::int64_t rows, std::int64_t cols, std::int64_t count, Fill&& fill) {
    Argument argument;
    argument.name = name;
    argument.rows = rows;
    argument.cols = cols;
    argument.values.resize(static_cast<std::size_t>(rows * cols * count));
    for (std::int64_t i = 0; i < count; ++i) fill(argument.values.data() + i * rows * cols, i);
    return argument;
}

inline Argument absent(const std::string& name) {
    Argument argument;
    argument.name = name;
    argument.is_absent = true;
    return argument;
}

inline Argument output(const std::string& name, std::int64_t rows, std::int64_t cols,
                       Content content = Content::finite) {
    Argument argument;
    argument.name = name;
    argument.rows = rows;
    argument.cols = cols;
    argument.content = content;
    return argument;
}

inline Argument renamed(Argument argument, const std::string& name) {
    argument.name = name;
    return argument;
}

inline Argument states(const std::string& name, const plr_space& space, Sample& sample, std::int64_t count) {
    return input(name, space.size, 1, count, [&](double* out, std::int64_t) {
        Eigen::Map<Eigen::VectorXd>(out, space.size) = sample.state(space);
    });
}

inline Argument covariances(const std::string& name, const plr_space& space, Sample& sample, std::int64_t count) {
    Argument argument = input(name, space.size, space.size, count, [&](double* out, std::int64_t) {
        Eigen::Map<Eigen::MatrixXd>(out, space.size, space.size) = sample.covariance(space);
    });
    argument.content = Content::covariance;
    return argument;
}

/// An item of an argument, as a matrix.
inline Eigen::Map<const Eigen::MatrixXd> item(const Argument& argument, std::int64_t i) {
    const std::int64_t at = argument.is_common ? 0 : i * argument.rows * argument.cols;
    return {argument.values.data() + at, argument.rows, argument.cols};
}

/// How many position components a space has.
inline std::int64_t axes_of(const plr_space& space) {
    std::int64_t axes = 0;
    const auto* at = reinterpret_cast<const unsigned char*>(space.components);
    for (std::uint32_t i = 0; i < space.size; ++i) {
        const auto& component = *reinterpret_cast<const plr_component*>(at);
        axes += std::strncmp(component.name, "position.", 9) == 0;
        at += space.components->struct_size;
    }
    return axes;
}

}  // namespace pelorus::conformance
