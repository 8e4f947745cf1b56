/// partitioner.statistical: measurements that a chain of statistically short links joins are one cell. See README.md.
#pragma once

#include "../../common/partition/writer.hpp"
#include "statistical_linkage.hpp"

namespace statistical {

class Statistical : public pelorus::Partitioner<Statistical> {
public:
    static void describe(pelorus::Describe<Statistical>& plugin) {
        plugin.title("Cells by statistical distance")
            .purpose(
                "Two measurements are in one cell if a chain of measurements joins them in which each differs from "
                "the next by no more than their noise explains. What the tracker predicts is not looked at.")
            .equation("connected components of the graph (z_i - z_j)' (R_i + R_j)^-1 (z_i - z_j) < chi-square(p, d)")
            .source(
                "K. Granstrom, C. Lundquist, U. Orguner, Extended Target Tracking using a Gaussian-Mixture PHD "
                "Filter, IEEE Transactions on Aerospace and Electronic Systems 48(4), 3268-3286, 2012, III "
                "(Mahalanobis distance)");
        plugin.parameter("probability", &Statistical::probability_)
            .initially("0.999")
            .above(0)
            .below(1)
            .doc("p: the share of pairs of measurements of one point that are linked");
    }

    void setup(const pelorus::Setup&) {
        info.dimension_min = 1;
        info.dimension_max = 3;
        gate_.set(probability_);
        partition::tell(need(), info);
    }

    plr_status split(const plr_call& call, const plr_partitioner_split& args) const {
        partition::expect_points(info, args);
        partition::Writer writer(*args.out);
        if (args.points.count > 0) {
            partition::CallMemory memory(call, need(), args.points.count);
            partition::by_dimension(args.points.rows, [&](auto dimension) {
                write_cells<decltype(dimension)::value>(memory, args, writer);
            });
            writer.alternative(1);
        }
        return writer.finish();
    }

private:
    static constexpr partition::Need need() noexcept {
        return UncertainPoints<3>::need() + partition::Components::need() + array<std::uint32_t>() +
               partition::Groups::need();
    }

    template <int D>
    void write_cells(partition::Memory& memory, const plr_partitioner_split& args, partition::Writer& writer) const {
        if (args.covariance.data == nullptr)
            throw pelorus::ArgumentError(
                "covariance: statistical distances take the noise of the points, none is given");
        pelorus::expect(args.covariance, D, D, args.points.count, "covariance");
        UncertainPoints<D> points(memory, args.points, args.covariance);
        partition::Components components(memory, points.size());
        StatisticalLinkage<D>(points, gate_(D), components).link();
        auto* const label = memory.take<std::uint32_t>(points.size());
        for (std::uint32_t k = 0; k < points.size(); ++k) label[points.point(k).point] = components.root(k);
        writer.cells(partition::Groups(memory, points.size(), [label](std::uint32_t i) { return label[i]; }));
    }

    double probability_ = 0;
    partition::Gate gate_;
};

}  // namespace statistical
