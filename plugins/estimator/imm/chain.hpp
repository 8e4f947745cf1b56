/// How the target changes from model to model: a chain in continuous time, and a start in which it does not change.
#pragma once

#include <cmath>
#include <optional>

#include "mixture.hpp"

namespace imm {

/// The probabilities p_ij(T) of a step.
struct Transitions {
    double from_to[max_models][max_models] = {};
};

class Chain {
public:
    Chain() = default;
    /// `stay`: probability to keep to a model for a second; `warm_up`: s from the start that the first model has for itself.
    Chain(double stay, std::optional<double> warm_up, int count) : stay_(stay), warm_up_(warm_up), count_(count) {}

    /// How likely the models are at the start.
    void begin(double* probabilities) const noexcept {
        for (int j = 0; j < count_; ++j) probabilities[j] = warm_up_ ? (j == 0 ? 1.0 : 0.0) : 1.0 / count_;
    }
    /// Of a step of dt (s, of any sign) that begins `age` s after the start. With a warm-up the first model, once left, is never
    /// returned to; the step after the warm-up leaves it for any of the others.
    Transitions step(double dt, double age, bool is_first_in_force) const noexcept {
        Transitions out;
        if (warm_up_ && is_first_in_force) {
            const bool is_over = count_ > 1 && age >= *warm_up_;
            for (int j = 0; j < count_; ++j) out.from_to[0][j] = is_over ? (j > 0 ? 1.0 / (count_ - 1) : 0.0) : j == 0;
            return out;
        }
        const int first = warm_up_ ? 1 : 0;
        double keep = 1, go = 0;
        stay_or_go(dt, count_ - first, keep, go);
        for (int i = first; i < count_; ++i)
            for (int j = first; j < count_; ++j) out.from_to[i][j] = i == j ? keep : go;
        return out;
    }

private:
    /// All of r models are left at one rate, for any of the others: exact for any dt.
    void stay_or_go(double dt, int models, double& keep, double& go) const noexcept {
        const double r = models;
        if (models == 1) return;
        const double kept = std::pow((stay_ - 1 / r) / (1 - 1 / r), std::fabs(dt));
        keep = 1 / r + (1 - 1 / r) * kept;
        go = (1 - kept) / r;
    }

    double stay_ = 1;
    std::optional<double> warm_up_;
    int count_ = 1;
};

}  // namespace imm
