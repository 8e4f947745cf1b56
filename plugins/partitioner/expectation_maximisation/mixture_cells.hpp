/// Cells of a scan by mixtures of Gaussians.
#pragma once

#include "../../common/partition/covariances.hpp"
#include "../../common/partition/k_means.hpp"
#include "../../common/partition/writer.hpp"
#include "mixture.hpp"

namespace expectation_maximisation {

struct Settings {
    std::uint32_t most_cells = 0;
    std::int64_t passes = 0, tries = 0;
    double scale = 0, least_deviation = 0;  ///< least_deviation: m
    const plr_random* random = nullptr;

    static partition::Need need() noexcept {
        using partition::array;
        partition::Need points = array<double>();
        points.per_point *= 3;
        const partition::Need components{partition::most_clusters * Mixture<3>::bytes_per_component,
                                         Mixture<3>::bytes_per_component};
        return points + components + array<std::uint32_t>() + array<std::uint32_t>() + array<double>() +
               partition::KMeans<3>::need() + points + partition::Groups::need();
    }
};

/// Splits one scan. [worker, exclusive] on its memory.
template <int D> class MixtureCells {
public:
    using Covariance = pelorus::Matrix<D>;
    using Point = pelorus::Vector<D>;

    MixtureCells(partition::Memory& memory, const Settings& settings, plr_key key, const plr_partitioner_split& args)
        : settings_(settings),
          key_(key),
          args_(args),
          points_(partition::relative_points<D>(memory, args.points)),
          count_(static_cast<std::uint32_t>(args.points.count)),
          noise_(mean_noise()),
          least_variance_(std::max(settings.least_deviation * settings.least_deviation, noise_.trace() / D)),
          mixture_(memory, std::max(partition::most_clusters, static_cast<std::uint32_t>(args.predictions.count)),
                   least_variance_),
          chosen_(memory.take<std::uint32_t>(count_)),
          origin_(memory.take<std::uint32_t>(count_)),
          share_(memory.take<double>(count_)),
          memory_(memory) {
        for (std::uint32_t i = 0; i < count_; ++i) chosen_[i] = i;
    }

    void write(partition::Writer& writer) {
        std::uint32_t left = count_;
        if (args_.predictions.count > 0) {
            fit_predictions();
            left = write_predicted_cells(writer);
        }
        if (left == 0) return;
        fit_seeds(left);
        write_other_cells(writer, left);
    }

private:
    Points<D> chosen(std::uint32_t count) const noexcept { return {points_, chosen_, count}; }

    Covariance mean_noise() const {
        Covariance sum = Covariance::Zero();
        if (args_.covariance.data == nullptr) return sum;
        partition::expect_covariances<D>(args_.covariance, args_.points.count, "covariance of point");
        for (std::int64_t i = 0; i < args_.points.count; ++i) sum += pelorus::load<D, D>(args_.covariance, i);
        return sum / static_cast<double>(args_.points.count);
    }

    /// One component for each prediction, where its measurements are expected, and a background of constant density over the
    /// box of the scan for those that are of none.
    void fit_predictions() {
        const plr_predictions& predictions = args_.predictions;
        pelorus::expect(predictions.mean, D, 1, predictions.count, "predictions.mean");
        partition::expect_finite(predictions.mean, "mean of prediction");
        if (predictions.extent.data != nullptr)
            partition::expect_covariances<D>(predictions.extent, predictions.count, "extent of prediction");
        Point low = Point::Constant(std::numeric_limits<double>::infinity());
        for (std::int64_t i = 0; i < count_; ++i) low = low.cwiseMin(pelorus::load<D, 1>(args_.points, i));
        double volume = 1;
        for (int axis = 0; axis < D; ++axis) {
            double high = 0;
            for (std::uint32_t i = 0; i < count_; ++i)
                high = std::max(high, points_[D * std::size_t{i} + static_cast<std::size_t>(axis)]);
            volume *= std::max(high, std::sqrt(least_variance_));
        }
        const double share = 1.0 / static_cast<double>(predictions.count + 1);
        mixture_.clear();
        for (std::int64_t j = 0; j < predictions.count; ++j)
            mixture_.add(share, pelorus::load<D, 1>(predictions.mean, j) - low,
                         settings_.scale * partition::known_or_zero<D>(predictions.extent, j) + noise_);
        mixture_.add_background(share, 1 / volume);
        mixture_.fit(chosen(count_), settings_.passes);
    }

    /// Answers how many points are left, which chosen_ then tells.
    std::uint32_t write_predicted_cells(partition::Writer& writer) {
        const auto predictions = static_cast<std::uint32_t>(args_.predictions.count);
        for (std::uint32_t i = 0; i < count_; ++i) {
            const auto origin = mixture_.origin(chosen(count_)[i]);
            origin_[i] =
                origin.component == Mixture<D>::background ? predictions : static_cast<std::uint32_t>(origin.component);
            share_[i] = origin.share;
        }
        for (std::uint32_t j = 0; j < predictions; ++j) {
            double sum = 0;
            for (std::uint32_t i = 0; i < count_; ++i)
                if (origin_[i] == j) sum += share_[i];
            if (sum == 0) continue;
            for (std::uint32_t i = 0; i < count_; ++i)
                if (origin_[i] == j) writer.member(i, share_[i] / sum);
            writer.cell(j);
        }
        std::uint32_t left = 0;
        for (std::uint32_t i = 0; i < count_; ++i)
            if (origin_[i] == predictions) chosen_[left++] = i;
        return left;
    }

    /// As many components as the information criterion wants, up to most_cells, from the clusters of k-means++.
    void fit_seeds(std::uint32_t left) {
        partition::Memory own = memory_;
        auto* const numbers = own.take<double>(D * std::size_t{left});
        for (std::uint32_t k = 0; k < left; ++k)
            std::copy_n(points_ + D * std::size_t{chosen_[k]}, D, numbers + D * std::size_t{k});
        partition::KMeans<D> clusters(own, numbers, left, *settings_.random);
        double most = -std::numeric_limits<double>::infinity();
        std::uint32_t best = 1;
        for (std::uint32_t k = 1; k <= settings_.most_cells; ++k) {
            clusters.run(k, settings_.tries, settings_.passes, key_);
            if (clusters.clusters() < k) break;  // fewer points are different
            constexpr double each = 1 + D + D * (D + 1) / 2;
            const double criterion =
                fit_clusters(clusters, left) - (k * each - 1) / 2 * std::log(static_cast<double>(left));
            if (criterion > most) {
                most = criterion;
                best = k;
            }
        }
        clusters.run(best, settings_.tries, settings_.passes, key_);
        fit_clusters(clusters, left);
        for (std::uint32_t k = 0; k < left; ++k) {
            const auto origin = mixture_.origin(chosen(left)[k]);
            origin_[k] = static_cast<std::uint32_t>(std::max(origin.component, 0));
            share_[k] = origin.share;
        }
    }

    double fit_clusters(const partition::KMeans<D>& clusters, std::uint32_t left) {
        mixture_.clear();
        for (std::uint32_t c = 0; c < clusters.clusters(); ++c) {
            const Point centre = Eigen::Map<const Point>(clusters.centre(c));
            Covariance scatter = Covariance::Zero();
            double members = 0;
            for (std::uint32_t k = 0; k < left; ++k) {
                if (clusters.cluster(k) != c) continue;
                const Point error = chosen(left)[k] - centre;
                scatter += error * error.transpose();
                ++members;
            }
            mixture_.add(members / left, centre, scatter / std::max(members, 1.0));
        }
        return mixture_.fit(chosen(left), settings_.passes);
    }

    void write_other_cells(partition::Writer& writer, std::uint32_t left) {
        partition::Memory own = memory_;
        const partition::Groups groups(own, left, [this](std::uint32_t k) { return origin_[k]; });
        for (std::uint32_t group = 0; group < groups.count(); ++group) {
            double sum = 0;
            for (std::uint32_t k = 0; k < groups.size(group); ++k) sum += share_[groups.begin(group)[k]];
            for (std::uint32_t k = 0; k < groups.size(group); ++k) {
                const std::uint32_t member = groups.begin(group)[k];
                writer.member(chosen_[member], share_[member] / sum);
            }
            writer.cell(-1);
        }
    }

    const Settings& settings_;
    plr_key key_;
    const plr_partitioner_split& args_;
    const double* points_;
    std::uint32_t count_;
    Covariance noise_;
    double least_variance_;
    Mixture<D> mixture_;
    std::uint32_t *chosen_, *origin_;
    double* share_;
    partition::Memory memory_;
};

}  // namespace expectation_maximisation
