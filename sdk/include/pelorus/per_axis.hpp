/// Parameters that are written as one value for all axes or as one an axis.
#pragma once

#include <string>
#include <vector>

#include <pelorus/failure.hpp>
#include <pelorus/matrix.hpp>

namespace pelorus {

/// The values of D axes. Throws ParameterError, naming `parameter`, unless there are 1 or D of them.
template <int D> Vector<D> per_axis(const std::string& parameter, const std::vector<double>& values) {
    if (values.size() == 1) return Vector<D>::Constant(values[0]);
    if (values.size() == static_cast<std::size_t>(D)) return Eigen::Map<const Vector<D>>(values.data());
    throw ParameterError(parameter, "has " + std::to_string(values.size()) + " values, expected 1 or " +
                                        std::to_string(D) + " (the dimension)");
}

}  // namespace pelorus
