/// k-means++: clusters about as many centres as wanted.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include <pelorus/abi/random.h>

#include "memory.hpp"
#include "scan.hpp"

namespace partition {

constexpr std::uint32_t most_clusters = 256;

/// The points of a scan as an array of their own, relative to the lowest corner of their box: sums of coordinates keep their digits
/// wherever the scan is.
template <int D> const double* relative_points(Memory& memory, const plr_const_view& points) {
    const auto count = static_cast<std::size_t>(points.count);
    auto* const out = memory.take<double>(D * count);
    for (int axis = 0; axis < D; ++axis) {
        double low = std::numeric_limits<double>::infinity();
        for (std::int64_t i = 0; i < points.count; ++i) low = std::min(low, coordinate(points, i, axis));
        for (std::int64_t i = 0; i < points.count; ++i)
            out[D * static_cast<std::size_t>(i) + static_cast<std::size_t>(axis)] = coordinate(points, i, axis) - low;
    }
    return out;
}

/// Seeds are drawn one after the other, each with a probability proportional to its squared distance from those before; then
/// points go to their nearest centre (the first of equals) and centres to the mean of their points until nothing changes. A
/// cluster that has lost all points begins anew at the point farthest from its centre. Of several tries the one with the least
/// sum of squares is kept. O(points clusters) a pass. Random numbers are those of the key alone.
///
/// Source: D. Arthur, S. Vassilvitskii, k-means++: The Advantages of Careful Seeding, SODA 2007, 1027-1035 (the seeds);
/// S. Lloyd, Least Squares Quantization in PCM, IEEE Transactions on Information Theory 28(2), 129-137, 1982.
template <int D> class KMeans {
public:
    static Need need() noexcept {
        return array<std::uint32_t>() + array<std::uint32_t>() + array<double>() + Need{2 * centres_bytes, 0} +
               Need{sizeof(std::uint32_t) * most_clusters + Memory::step, 0};
    }

    /// `points`: D numbers each.
    KMeans(Memory& memory, const double* points, std::uint32_t count, const plr_random& random)
        : points_(points),
          count_(count),
          random_(random),
          cluster_(memory.take<std::uint32_t>(count)),
          best_cluster_(memory.take<std::uint32_t>(count)),
          nearest_(memory.take<double>(count)),
          centres_(memory.take<double>(D * most_clusters)),
          best_centres_(memory.take<double>(D * most_clusters)),
          size_(memory.take<std::uint32_t>(most_clusters)) {}

    /// Answers the sum of squares. `clusters` is at most most_clusters; there are fewer where fewer points are different.
    double run(std::uint32_t clusters, std::int64_t tries, std::int64_t passes, plr_key key) {
        double least = std::numeric_limits<double>::infinity();
        for (std::int64_t attempt = 0; attempt < tries; ++attempt) {
            draw_seeds(std::min(clusters, count_),
                       random_.derive(key, stream, clusters, static_cast<std::uint64_t>(attempt)));
            double sum = assign_points().sum;
            for (std::int64_t pass = 0; pass < passes; ++pass) {
                move_centres();
                const Assigned assigned = assign_points();
                sum = assigned.sum;
                if (!assigned.changed) break;
            }
            if (attempt > 0 && !(sum < least)) continue;  // sums of points too far apart are infinite
            least = sum;
            best_clusters_ = clusters_;
            std::copy_n(cluster_, count_, best_cluster_);
            std::copy_n(centres_, D * std::size_t{clusters_}, best_centres_);
        }
        return least;
    }

    std::uint32_t clusters() const noexcept { return best_clusters_; }
    std::uint32_t cluster(std::uint32_t point) const noexcept { return best_cluster_[point]; }
    const double* centre(std::uint32_t cluster) const noexcept { return best_centres_ + D * std::size_t{cluster}; }

private:
    static constexpr std::uint64_t stream = 1000;
    static constexpr std::size_t centres_bytes = sizeof(double) * D * most_clusters + Memory::step;

    const double* point(std::uint32_t i) const noexcept { return points_ + D * std::size_t{i}; }
    double* own_centre(std::uint32_t k) noexcept { return centres_ + D * std::size_t{k}; }
    static double squared(const double* a, const double* b) noexcept {
        double sum = 0;
        for (int axis = 0; axis < D; ++axis) sum += (a[axis] - b[axis]) * (a[axis] - b[axis]);
        return sum;
    }

    void draw_seeds(std::uint32_t clusters, plr_key key) {
        for (std::uint32_t i = 0; i < count_; ++i) nearest_[i] = 1;
        for (clusters_ = 0; clusters_ < clusters; ++clusters_) {
            double total = 0, drawn = 0;
            for (std::uint32_t i = 0; i < count_; ++i) total += nearest_[i];
            if (!(total > 0)) break;  // every point has a seed in its place
            random_.uniform(key, clusters_, 1, &drawn);
            std::uint32_t seed = count_;
            double sum = 0;
            for (std::uint32_t i = 0; i < count_ && !(sum > drawn * total); ++i) {
                if (!(nearest_[i] > 0)) continue;
                seed = i;
                sum += nearest_[i];
            }
            std::copy_n(point(seed), D, own_centre(clusters_));
            for (std::uint32_t i = 0; i < count_; ++i) {
                const double square = squared(point(i), own_centre(clusters_));
                nearest_[i] = clusters_ == 0 ? square : std::min(nearest_[i], square);
            }
        }
        for (std::uint32_t i = 0; i < count_; ++i) cluster_[i] = 0;
    }

    struct Assigned {
        double sum;
        bool changed;
    };
    Assigned assign_points() {
        Assigned out{0, false};
        for (std::uint32_t i = 0; i < count_; ++i) {
            std::uint32_t best = 0;
            nearest_[i] = std::numeric_limits<double>::infinity();
            for (std::uint32_t k = 0; k < clusters_; ++k) {
                const double square = squared(point(i), own_centre(k));
                if (!(square < nearest_[i])) continue;
                nearest_[i] = square;
                best = k;
            }
            out.changed = out.changed || cluster_[i] != best;
            cluster_[i] = best;
            out.sum += nearest_[i];
        }
        return out;
    }

    void move_centres() {
        std::fill_n(size_, clusters_, 0u);
        for (std::uint32_t i = 0; i < count_; ++i) ++size_[cluster_[i]];
        for (std::uint32_t k = 0; k < clusters_; ++k) {
            if (size_[k] > 0) continue;
            const auto farthest = static_cast<std::uint32_t>(std::max_element(nearest_, nearest_ + count_) - nearest_);
            --size_[cluster_[farthest]];
            cluster_[farthest] = k;
            size_[k] = 1;
            nearest_[farthest] = 0;
        }
        std::fill_n(centres_, D * std::size_t{clusters_}, 0.0);
        for (std::uint32_t i = 0; i < count_; ++i)
            for (int axis = 0; axis < D; ++axis) own_centre(cluster_[i])[axis] += point(i)[axis];
        for (std::uint32_t k = 0; k < clusters_; ++k)
            for (int axis = 0; axis < D; ++axis) own_centre(k)[axis] /= std::max(size_[k], 1u);
    }

    const double* points_;
    std::uint32_t count_, clusters_ = 0, best_clusters_ = 0;
    const plr_random& random_;
    std::uint32_t *cluster_, *best_cluster_;
    double *nearest_, *centres_, *best_centres_;
    std::uint32_t* size_;
};

}  // namespace partition
