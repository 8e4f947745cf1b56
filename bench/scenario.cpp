#include "scenario.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

namespace pelorus::bench {

const plain::Mount& mount() {
    constexpr double degree = 3.14159265358979323846 / 180.0;
    const double cr = std::cos(2 * degree), sr = std::sin(2 * degree), cp = std::cos(-degree), sp = std::sin(-degree);
    const double cy = std::cos(30 * degree), sy = std::sin(30 * degree);
    static const plain::Mount made{{100.0, -50.0, 20.0},
                                   {cy * cp, sy * cp, -sp, cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr,
                                    cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr},
                                   {}};
    return made;
}

Scenario::Scenario() {
    std::mt19937_64 engine(5);  // its numbers are the same everywhere; those of the distributions need not be
    const auto within = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
    };
    const plain::Mount& stand = mount();
    for (std::size_t i = 0; i < tracks; ++i) {
        const double mean[9] = {within(2e3, 2e4),  within(-1e4, 1e4), within(500, 5e3),
                                within(-200, 200), within(-200, 200), within(-20, 20),
                                within(-5, 5),     within(-5, 5),     within(-1, 1)};
        std::copy_n(mean, 9, start[i].mean.begin());
        double factor[81];
        for (int e = 0; e < 81; ++e) factor[e] = within(-1, 1) * (e % 9 < 3 ? 20.0 : e % 9 < 6 ? 5.0 : 1.0);
        for (std::size_t c = 0; c < 9; ++c)
            for (std::size_t r = 0; r < 9; ++r) {
                double sum = 0.0;
                for (std::size_t k = 0; k < 9; ++k) sum += factor[k * 9 + r] * factor[k * 9 + c];
                start[i].covariance[c * 9 + r] = sum;
            }
    }
    if (!plain::predict(start.data(), predicted.data(), tracks, dt, density))
        throw std::logic_error("the scenario is not finite");
    for (std::size_t i = 0; i < tracks; ++i) {
        double along[3] = {};
        for (std::size_t r = 0; r < 3; ++r) {
            position[i].value[r] = predicted[i].mean[r] + within(-10, 10);
            position[i].noise[4 * r] = 100.0;
            for (std::size_t k = 0; k < 3; ++k)
                along[r] += stand.rotation[r * 3 + k] * (position[i].value[k] - stand.position[k]);
        }
        const double ground = std::sqrt(along[0] * along[0] + along[1] * along[1]);
        spherical[i].value = {std::sqrt(ground * ground + along[2] * along[2]), std::atan2(along[1], along[0]),
                              std::atan2(along[2], ground)};
        spherical[i].noise = {100.0, 0, 0, 0, 1e-6, 0, 0, 0, 1e-6};
    }
}

std::vector<double> Scenario::leading(int states) const {
    const auto n = static_cast<std::size_t>(states);
    std::vector<double> out;
    for (const plain::Track& track : start) {
        out.insert(out.end(), track.mean.begin(), track.mean.begin() + states);
        for (std::size_t c = 0; c < n; ++c)
            for (std::size_t r = 0; r < n; ++r) out.push_back(track.covariance[c * plain::states + r]);
    }
    return out;
}

const Scenario& scenario() {
    static const Scenario made;
    return made;
}

}  // namespace pelorus::bench
