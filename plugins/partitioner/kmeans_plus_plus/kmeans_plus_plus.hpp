/// partitioner.kmeans_plus_plus: cells about as many centres as wanted, or as many as a criterion finds best. See README.md.
#pragma once

#include "../../common/partition/covariances.hpp"
#include "../../common/partition/writer.hpp"
#include "criteria.hpp"

namespace kmeans_plus_plus {

enum class Criterion { bic, silhouette, all };

class KMeansPlusPlus : public pelorus::Partitioner<KMeansPlusPlus> {
public:
    static void describe(pelorus::Describe<KMeansPlusPlus>& plugin) {
        plugin.title("Cells about centres (k-means++)")
            .purpose(
                "Cells such that the squared distances of measurements to the mean of their cell are small, for a "
                "number of cells that is given or tried. What the tracker predicts is not looked at.")
            .equation(
                "least sum_i |z_i - c(i)|^2; seeds with probability |z - nearest seed|^2; K by BIC, silhouette, or all")
            .source(
                "D. Arthur, S. Vassilvitskii, k-means++: The Advantages of Careful Seeding, SODA 2007, 1027-1035; "
                "D. Pelleg, A. Moore, X-means, ICML 2000; P. Rousseeuw, Journal of Computational and Applied "
                "Mathematics 20, 53-65, 1987");
        plugin.parameter("least_cells", &KMeansPlusPlus::least_cells_)
            .initially("1")
            .min(1)
            .max(partition::most_clusters)
            .doc("smallest number of cells that is tried");
        plugin.parameter("most_cells", &KMeansPlusPlus::most_cells_)
            .initially("8")
            .min(1)
            .max(partition::most_clusters)
            .doc("largest number of cells that is tried; the same as least_cells: so many");
        plugin.parameter("criterion", &KMeansPlusPlus::criterion_)
            .initially("bic")
            .choices({{"bic", "the number with the best information criterion of round Gaussians"},
                      {"silhouette", "the number with the best mean silhouette"},
                      {"all", "an alternative for each number"}})
            .doc("which number of cells is taken");
        plugin.parameter("tries", &KMeansPlusPlus::tries_)
            .initially("4")
            .min(1)
            .max(1000)
            .doc("beginnings with other seeds, of which the best counts");
        plugin.parameter("passes", &KMeansPlusPlus::passes_)
            .initially("100")
            .min(1)
            .max(1e6)
            .doc("most passes over the points of each try");
        plugin.parameter("least_deviation", &KMeansPlusPlus::least_deviation_)
            .unit("m")
            .initially("1 mm")
            .min(1e-9)
            .max(1e15)
            .doc(
                "measurements scatter about their centre by this on each axis at least, and by their noise where it is "
                "known (criterion bic)");
    }

    void setup(const pelorus::Setup& setup) {
        if (most_cells_ < least_cells_) throw pelorus::ParameterError("most_cells", "is less than least_cells");
        random_ = &setup.service<plr_random>();
        info.dimension_min = 1;
        info.dimension_max = 3;
        info.flags = PLR_FLAG_USES_KEYS;
        partition::tell(need(), info);
    }

    plr_status split(const plr_call& call, const plr_partitioner_split& args) const {
        partition::expect_points(info, args);
        partition::Writer writer(*args.out);
        if (args.points.count > 0) {
            if (call.keys == nullptr) throw pelorus::ArgumentError("call.keys: is NULL, but seeds are drawn");
            partition::CallMemory memory(call, need(), args.points.count);
            partition::by_dimension(args.points.rows, [&](auto dimension) {
                write<decltype(dimension)::value>(memory, call.keys[0], args, writer);
            });
        }
        return writer.finish();
    }

private:
    static partition::Need need() noexcept {
        partition::Need points = partition::array<double>();
        points.per_point *= 3;
        return points + partition::KMeans<3>::need() + partition::array<std::uint32_t>(partition::most_clusters) +
               partition::array<double>(partition::most_clusters) + partition::Groups::need();
    }

    template <int D>
    void write(partition::Memory& memory, plr_key key, const plr_partitioner_split& args,
               partition::Writer& writer) const {
        const auto count = static_cast<std::uint32_t>(args.points.count);
        const double* const points = partition::relative_points<D>(memory, args.points);
        partition::KMeans<D> clustering(memory, points, count, *random_);
        auto* const size = memory.take<std::uint32_t>(partition::most_clusters);
        auto* const distance = memory.take<double>(partition::most_clusters);
        const auto write_cells = [&] {  // of the latest run
            partition::Memory own = memory;
            writer.cells(partition::Groups(own, count, [&](std::uint32_t i) { return clustering.cluster(i); }));
        };
        const double least_variance = least_variance_of<D>(args);
        std::uint32_t best = least_cells_;
        double most = -std::numeric_limits<double>::infinity();
        const double share = 1.0 / (most_cells_ - least_cells_ + 1);
        double rest = 1;
        for (std::uint32_t cells = least_cells_; cells <= most_cells_; ++cells) {
            const double sum = clustering.run(cells, tries_, passes_, key);
            // Where fewer points are different than cells wanted, all further numbers give what the last one gave.
            const bool is_exhausted = clustering.clusters() < cells;
            if (criterion_ == Criterion::all) {
                if (is_exhausted && cells > least_cells_) break;
                if (cells > least_cells_) writer.alternative(share), rest -= share;
                write_cells();
            } else {
                const double value = criterion_ == Criterion::bic
                                         ? information_criterion(clustering, count, sum, least_variance, size)
                                         : silhouette(clustering, points, count, distance, size);
                if (value > most) {
                    most = value;
                    best = cells;
                }
            }
            if (is_exhausted) break;
        }
        if (criterion_ != Criterion::all) {
            clustering.run(best, tries_, passes_, key);
            write_cells();
        }
        writer.alternative(rest);
    }

    template <int D> double least_variance_of(const plr_partitioner_split& args) const {
        double noise = 0;
        if (args.covariance.data != nullptr) {
            partition::expect_covariances<D>(args.covariance, args.points.count, "covariance of point");
            for (std::int64_t i = 0; i < args.points.count; ++i)
                noise += pelorus::load<D, D>(args.covariance, i).trace() / static_cast<double>(D * args.points.count);
        }
        return std::max(noise, least_deviation_ * least_deviation_);
    }

    std::uint32_t least_cells_ = 0, most_cells_ = 0;
    Criterion criterion_ = Criterion::bic;
    std::int64_t tries_ = 0, passes_ = 0;
    double least_deviation_ = 0;
    const plr_random* random_ = nullptr;
};

}  // namespace kmeans_plus_plus
