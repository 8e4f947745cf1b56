#include "starts.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "association.hpp"

namespace group {

namespace {

double seconds(std::int64_t from, std::int64_t to) { return static_cast<double>(to - from) * 1e-9; }

/// Indices of centres by their first coordinate: what is too far along it need not be looked at.
std::vector<std::size_t> by_first_axis(const std::vector<Centre>& centres) {
    std::vector<std::size_t> order(centres.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return centres[a].position(0) < centres[b].position(0); });
    return order;
}

/// Calls `use` for the centres within `reach` of `at` on the first axis.
template <class Use>
void for_near(const std::vector<Centre>& centres, const std::vector<std::size_t>& order, double at, double reach,
              Use use) {
    auto next = std::lower_bound(order.begin(), order.end(), at - reach,
                                 [&](std::size_t k, double least) { return centres[k].position(0) < least; });
    for (; next != order.end() && centres[*next].position(0) <= at + reach; ++next)
        if (!centres[*next].is_used) use(*next);
}

}  // namespace

Centre centre_of(Points points, std::size_t cell) {
    Centre centre;
    centre.position = points.centroid();
    centre.noise = points.mean_noise();
    centre.points = std::move(points);
    centre.cell = cell;
    return centre;
}

/// Prediction z2 + r (z2 - z1) with r = T23/T12, S = R3 + (1 + r)^2 R2 + r^2 R1: 2 z2 - z1 and R3 + 4 R2 + R1 for equal steps.
std::vector<Starts::Triple> Starts::triples(const Centres& third) const {
    const Centres &first = before_[0], &second = before_[1];
    const double step = seconds(first.time, second.time), ratio = seconds(second.time, third.time) / step;
    const double reach = gate_.maximum_speed * step;
    const std::vector<std::size_t> seconds_order = by_first_axis(second.centres),
                                   thirds_order = by_first_axis(third.centres);
    double most = 0;  // largest variance of a third centre along the first axis
    for (const Centre& centre : third.centres) most = std::max(most, centre.noise(0, 0));
    std::vector<Triple> found;
    for (std::size_t i = 0; i < first.centres.size(); ++i) {
        const Centre& a = first.centres[i];
        if (a.is_used) continue;
        for_near(second.centres, seconds_order, a.position(0), reach, [&](std::size_t j) {
            const Centre& b = second.centres[j];
            if ((b.position - a.position).squaredNorm() > reach * reach) return;
            const Eigen::VectorXd expected = b.position + ratio * (b.position - a.position);
            const Eigen::MatrixXd spread = (1 + ratio) * (1 + ratio) * b.noise + ratio * ratio * a.noise;
            const double window = std::sqrt(gate_.squared_distance * (spread(0, 0) + most));
            for_near(third.centres, thirds_order, expected(0), window, [&](std::size_t l) {
                const Centre& c = third.centres[l];
                const double squared = squared_distance(c.position - expected, c.noise + spread);
                if (squared < gate_.squared_distance) found.push_back({i, j, l, squared});
            });
        });
    }
    std::sort(found.begin(), found.end(), [](const Triple& x, const Triple& y) {
        return std::tie(x.squared_distance, x.first, x.second, x.third) <
               std::tie(y.squared_distance, y.first, y.second, y.third);
    });
    return found;
}

std::vector<Start> Starts::take(Centres&& newest) {
    std::vector<Start> starts;
    if (before_.size() == 2) {
        for (const Triple& triple : triples(newest)) {
            Centre &a = before_[0].centres[triple.first], &b = before_[1].centres[triple.second],
                   &c = newest.centres[triple.third];
            if (a.is_used || b.is_used || c.is_used) continue;
            a.is_used = b.is_used = c.is_used = true;
            const double whole = seconds(before_[0].time, newest.time);
            starts.push_back({a, b, c, (c.position - a.position) / whole, whole / 2});
        }
        before_.pop_front();
    }
    before_.push_back(std::move(newest));
    return starts;
}

bool Starts::is_of(int dimension, std::size_t sensors) const {
    if (before_.size() > 2) return false;
    for (const Centres& scan : before_)
        for (const Centre& centre : scan.centres)
            if (centre.position.size() != dimension || centre.noise.rows() != dimension ||
                centre.noise.cols() != dimension || !centre.points.is_of(dimension, sensors))
                return false;
    return true;
}

}  // namespace group
