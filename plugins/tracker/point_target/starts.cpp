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

namespace {

/// The components that two points tell, in ascending order: which one, and of which axis it is the position or the velocity.
struct Moments {
    std::vector<int> components;
    std::vector<std::size_t> axis;
    std::vector<bool> is_velocity;

    explicit Moments(const Models& models) {
        std::vector<std::pair<int, int>> known;  // component; axis, or axes + axis for a velocity
        for (int a = 0; a < models.axes(); ++a) {
            known.emplace_back(a, a);  // positions are the first components
            known.emplace_back(models.velocity(a), models.axes() + a);
        }
        std::sort(known.begin(), known.end());
        for (const auto& [component, what] : known) {
            components.push_back(component);
            axis.push_back(static_cast<std::size_t>(what % models.axes()));
            is_velocity.push_back(what >= models.axes());
        }
    }
    std::size_t size() const noexcept { return components.size(); }
};

struct PointPair {
    Point first{}, second{};
    double elapsed = 0;  ///< s
    Point velocity() const {
        Point v{};
        for (std::size_t a = 0; a < v.size(); ++a) v[a] = (second[a] - first[a]) / elapsed;
        return v;
    }
};

void put_means(const Moments& moments, const Point& place, const Point& velocity, double* mean) {
    for (std::size_t r = 0; r < moments.size(); ++r)
        mean[r] = (moments.is_velocity[r] ? velocity : place)[moments.axis[r]];
}

/// Velocities at the second points, as the motion leads there from the first ones.
std::vector<Point> arrival_velocities(Models& models, const Moments& moments, const std::vector<PointPair>& pairs,
                                      const std::vector<std::uint64_t>& ids, const std::vector<double>& covariances) {
    std::vector<Point> velocities;
    for (const PointPair& pair : pairs) velocities.push_back(pair.velocity());
    if (models.draws()) return velocities;
    const std::size_t n = pairs.size(), size = moments.size(), c = static_cast<std::size_t>(models.cartesian().size());
    std::vector<double> departures(n * size), steps, records(n * models.record_size(), 0.0), means(n * c),
        spreads(n * c * c);
    for (std::size_t i = 0; i < n; ++i) {
        put_means(moments, pairs[i].first, velocities[i], departures.data() + i * size);
        steps.push_back(pairs[i].elapsed);
    }
    Failures unbegun, unmoved, untold;
    models.init(moments.components, n, ids.data(), departures.data(), covariances.data(), records.data(), unbegun);
    models.predict(n, ids.data(), steps.data(), records.data(), unmoved);
    models.summary(n, ids.data(), records.data(), means.data(), spreads.data(), untold);
    for (std::size_t i = 0; i < n; ++i) {
        if (unbegun[i] != 0 || unmoved[i] != 0 || untold[i] != 0) continue;  // the velocity between both, then
        const double* arrived = means.data() + i * c;
        for (std::size_t a = 0; a < static_cast<std::size_t>(models.axes()); ++a)
            velocities[i][a] =
                arrived[models.velocity(static_cast<int>(a))] + (pairs[i].second[a] - arrived[a]) / pairs[i].elapsed;
    }
    return velocities;
}

}  // namespace

void start_from_two(Models& models, const Detections& detections, const std::vector<TwoPoints>& pairs,
                    std::vector<double>& records, Failures& failed) {
    const auto axes = static_cast<std::size_t>(models.axes());
    const Moments moments(models);
    const std::size_t size = moments.size(), n = pairs.size();
    std::vector<PointPair> points;
    std::vector<double> means(n * size), covariances(n * size * size);
    std::vector<std::uint64_t> ids;
    for (std::size_t i = 0; i < n; ++i) {
        const Track& first = *pairs[i].first;
        ids.push_back(first.id);
        const std::array<double, 9> second = place_covariance(detections, pairs[i].second);
        const double elapsed = static_cast<double>(detections.times[pairs[i].second] - first.seen) * 1e-9;
        points.push_back({first.place, detections.places[pairs[i].second], elapsed});
        for (std::size_t r = 0; r < size; ++r)
            for (std::size_t c = 0; c < size; ++c) {
                const std::size_t at = moments.axis[c] * axes + moments.axis[r];
                const int velocities = (moments.is_velocity[r] ? 1 : 0) + (moments.is_velocity[c] ? 1 : 0);
                double value = second[at];
                if (velocities == 1) value /= elapsed;
                if (velocities == 2) value = (value + first.covariance[at]) / (elapsed * elapsed);
                covariances[(i * size + c) * size + r] = value;
            }
    }
    const std::vector<Point> velocities = arrival_velocities(models, moments, points, ids, covariances);
    for (std::size_t i = 0; i < n; ++i) put_means(moments, points[i].second, velocities[i], means.data() + i * size);
    records.assign(n * models.record_size(), 0.0);
    models.init(moments.components, n, ids.data(), means.data(), covariances.data(), records.data(), failed);
}

}  // namespace point_target
