#include "starts.hpp"

#include <algorithm>

#include "gating.hpp"

namespace point_target {

void start_from_one(Models& models, const Detections& detections, const std::vector<std::size_t>& which,
                    const std::vector<std::uint64_t>& ids, std::vector<double>& records, Failures& failed) {
    const std::size_t k = detections.k(), n = which.size();
    std::vector<double> means, covariances;
    for (const std::size_t i : which) {
        means.insert(means.end(), detections.known_of(i), detections.known_of(i) + k);
        covariances.insert(covariances.end(), detections.covariance_of(i), detections.covariance_of(i) + k * k);
    }
    records.assign(n * models.record_size(), 0.0);
    models.init(detections.sensor->components, n, ids.data(), means.data(), covariances.data(), records.data(), failed);
}

void start_from_two(Models& models, const Detections& detections, const std::vector<TwoPoints>& pairs,
                    std::vector<double>& records, Failures& failed) {
    const auto axes = static_cast<std::size_t>(models.axes());
    // Components in ascending order: positions are the first ones, velocities stand where the estimator has them.
    std::vector<std::pair<int, std::size_t>> known;  // component; axis, or axes + axis for a velocity
    for (std::size_t a = 0; a < axes; ++a) {
        known.emplace_back(static_cast<int>(a), a);
        known.emplace_back(models.velocity(static_cast<int>(a)), axes + a);
    }
    std::sort(known.begin(), known.end());
    std::vector<int> components;
    for (const auto& [component, what] : known) components.push_back(component);

    const std::size_t size = 2 * axes;
    std::vector<double> means(pairs.size() * size), covariances(pairs.size() * size * size);
    std::vector<std::uint64_t> ids;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const Track& first = *pairs[i].first;
        ids.push_back(first.id);
        const Point& place = detections.places[pairs[i].second];
        const std::array<double, 9> second = place_covariance(detections, pairs[i].second);
        const double elapsed = static_cast<double>(detections.times[pairs[i].second] - first.seen) * 1e-9;
        for (std::size_t r = 0; r < size; ++r) {
            const std::size_t row = known[r].second, a = row % axes;
            means[i * size + r] = row < axes ? place[a] : (place[a] - first.place[a]) / elapsed;
            for (std::size_t c = 0; c < size; ++c) {
                const std::size_t column = known[c].second, at = (column % axes) * axes + a;
                const int velocities = (row < axes ? 0 : 1) + (column < axes ? 0 : 1);
                double value = second[at];
                if (velocities == 1) value /= elapsed;
                if (velocities == 2) value = (value + first.covariance[at]) / (elapsed * elapsed);
                covariances[(i * size + c) * size + r] = value;
            }
        }
    }
    records.assign(pairs.size() * models.record_size(), 0.0);
    models.init(components, pairs.size(), ids.data(), means.data(), covariances.data(), records.data(), failed);
}

}  // namespace point_target
