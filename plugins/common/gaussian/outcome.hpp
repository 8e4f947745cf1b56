/// Why an item of a Gaussian filter's batch could not be worked out.
#pragma once

#include <pelorus/failure.hpp>

namespace gaussian {

enum class Outcome {
    done,
    covariance_indefinite,
    motion_noise_indefinite,
    prediction_indefinite,
    noise_indefinite,
    regression_indefinite,
    innovation_singular,
    not_finite
};

inline const char* text(Outcome outcome) noexcept {
    switch (outcome) {
        case Outcome::done:
            return "done";
        case Outcome::covariance_indefinite:
            return "the state's covariance is not positive semidefinite";
        case Outcome::motion_noise_indefinite:
            return "the motion's noise covariance is not positive semidefinite";
        case Outcome::prediction_indefinite:
            return "the predicted covariance is indefinite: a point of negative weight takes more away than there is";
        case Outcome::noise_indefinite:
            return "the measurement noise covariance is not positive semidefinite";
        case Outcome::regression_indefinite:
            return "the updated covariance is indefinite: a point of negative weight takes more away than there is";
        case Outcome::innovation_singular:
            return "the innovation covariance H P H' + R is not positive definite";
        case Outcome::not_finite:
            return "the result is not finite";
    }
    return "";
}

/// Throws NumericError unless it is done.
inline void require(Outcome outcome) {
    if (outcome != Outcome::done) throw pelorus::NumericError(text(outcome));
}

}  // namespace gaussian
