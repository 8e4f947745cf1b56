// Points near a prediction, then chains of near points, with what a partitioner may do wrong.
#include <algorithm>
#include <cmath>
#include <numeric>

#include <pelorus/pelorus.hpp>

#include "defect.h"

namespace {

struct Saboteur : pelorus::Partitioner<Saboteur> {
    double gap = 20;  // m

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A partitioner with a defect")
            .purpose("Cells by distance, for the proof that the conformance suites can fail.")
            .equation(
                "points within the gap of the nearest prediction; else connected components of |z_i - z_j| <= gap")
            .source("the saboteurs' own");
        plugin.parameter("gap", &Saboteur::gap)
            .unit("m")
            .initially("20 m")
            .above(0)
            .doc("longest distance within a cell");
    }

    void setup(const pelorus::Setup&) {
        info.dimension_min = 1;
        info.dimension_max = 3;
        info.scratch_bytes = 2 * 64;
        info.scratch_bytes_point = 2 * sizeof(double);
        if (NEAR_MISS("partitioner-every-point-once")) gap = 1e-3;  // all stand alone
        if (NEAR_MISS("partitioner-few-points")) gap = 0;           // only what lies in one place is together
        if (NEAR_MISS("partitioner-order-of-cells")) gap = 1e6;     // all are together
    }

    /// A split under way: what each point belongs to.
    struct Work {
        const plr_partitioner_split& args;
        std::int64_t* owner;  // a prediction, -1: none, lost: nothing
        std::int64_t* first;  // the first member of its chain
        double gap;
    };
    static constexpr std::int64_t lost = -2;

    plr_status split(const plr_call& call, const plr_partitioner_split& args) const {
        const std::int64_t count = args.points.count, d = args.points.rows;
        if (!DEFECT("partitioner-refuses-other-dimensions") && (d < info.dimension_min || d > info.dimension_max)) {
            const auto refuse = [&] {
                throw pelorus::ArgumentError("points: are of " + std::to_string(d) + " dimensions, expected 1 to 3");
            };
            if (NEAR_MISS("partitioner-refuses-other-dimensions"))
                return pelorus::for_items(call, 1, [&](std::int64_t) { refuse(); });
            refuse();
        }
        if (!(all_finite(args.points) && all_finite(args.predictions.mean)))
            throw pelorus::NumericError("a point is not finite");
        const pelorus::Scratch owners(call, count), chains(call, count);
        const Work work{args, reinterpret_cast<std::int64_t*>(owners.data()),
                        reinterpret_cast<std::int64_t*>(chains.data()), gap};
        if (NEAR_MISS("partitioner-threads-same-bytes") && args.parallel != nullptr) {
            const plr_status status = args.parallel->run(args.parallel->context, count, 8, &find_some_owners,
                                                         const_cast<Work*>(&work), call.error);
            if (status != PLR_OK) return status;
        } else {
            for (std::int64_t i = 0; i < count; ++i) work.owner[i] = owner_of(work, i);
        }
        if (DEFECT("cost-of-pairs")) look_at_triples(work, count);
        if (NEAR_MISS("cost-of-pairs")) look_at_triples(work, std::min<std::int64_t>(count, 8));
        chain(work);
        return answer(work);
    }

private:
    static void look_at_triples(const Work& work, std::int64_t third_points) {
        volatile double sum = 0;
        for (std::int64_t i = 0; i < work.args.points.count; ++i)
            for (std::int64_t j = 0; j < work.args.points.count; ++j)
                for (std::int64_t k = 0; k < third_points; ++k) sum = sum + work.args.points.data[0];
    }
    static bool all_finite(const plr_const_view& points) {
        for (std::int64_t k = 0; k < points.count; ++k)
            for (std::int64_t r = 0; r < points.rows; ++r)
                if (!std::isfinite(points.data[k * points.item_stride + r])) return false;
        return true;
    }
    static double square(const plr_const_view& a, std::int64_t i, const plr_const_view& b, std::int64_t j) {
        double sum = 0;
        for (std::int64_t r = 0; r < a.rows; ++r) {
            double difference = a.data[i * a.item_stride + r] - b.data[j * b.item_stride + r];
            if (NEAR_MISS("partitioner-place-free")) difference = std::round(difference * 1e6) / 1e6;
            sum += difference * difference;
        }
        return sum;
    }
    static plr_status find_some_owners(void* argument, std::int64_t first, std::int64_t last, plr_scratch*,
                                       plr_error*) {
        const Work& work = *static_cast<const Work*>(argument);
        for (std::int64_t i = first; i < last; ++i) work.owner[i] = owner_of(work, i);
        return PLR_OK;
    }
    static std::int64_t owner_of(const Work& work, std::int64_t i) {
        double least = work.gap * work.gap;
        std::int64_t owner = -1;
        for (std::int64_t k = 0; k < work.args.predictions.count; ++k) {
            const double apart = square(work.args.points, i, work.args.predictions.mean, k);
            if (apart > least) continue;
            least = apart;
            owner = k;
        }
        return owner;
    }
    static std::int64_t root(const std::int64_t* first, std::int64_t i) {
        while (first[i] != i) i = first[i];
        return i;
    }
    static bool is_same_square(const Work& work, std::int64_t i, std::int64_t j) {
        const plr_const_view& p = work.args.points;
        for (std::int64_t r = 0; r < p.rows; ++r)
            if (std::floor(p.data[i * p.item_stride + r] / 30) != std::floor(p.data[j * p.item_stride + r] / 30))
                return false;
        return true;
    }
    /// Whether two points of no prediction are neighbours.
    static bool are_near(const Work& work, std::int64_t i, std::int64_t j) {
        if (DEFECT("partitioner-place-free")) return is_same_square(work, i, j);
        const double apart = square(work.args.points, i, work.args.points, j), reach = work.gap * work.gap;
        if (DEFECT("partitioner-threads-same-bytes") && work.args.parallel != nullptr) {
            const std::int64_t block = 1 + work.args.points.count / work.args.parallel->threads;
            if (i / block != j / block) return false;  // each thread for itself
        }
        if (NEAR_MISS("partitioner-order-of-points-free")) return apart < reach;
        return apart <= reach;
    }
    static void chain(const Work& work) {
        const std::int64_t count = work.args.points.count;
        std::iota(work.first, work.first + count, 0);
        for (std::int64_t j = 0; j < count; ++j) {
            if (work.owner[j] != -1) continue;
            for (std::int64_t i = 0; i < j; ++i) {
                if (work.owner[i] != -1) continue;
                if (DEFECT("partitioner-few-points") && square(work.args.points, i, work.args.points, j) == 0) {
                    work.owner[j] = lost;  // seen already
                    break;
                }
                // Cells that grow about their first member alone depend on who comes first.
                if (DEFECT("partitioner-order-of-points-free") && (work.first[i] != i || work.first[j] != j)) continue;
                if (!are_near(work, i, j)) continue;
                const std::int64_t a = root(work.first, i), b = root(work.first, j);
                work.first[std::max(a, b)] = std::min(a, b);
            }
        }
        if (!DEFECT("partitioner-every-point-once")) return;
        for (std::int64_t i = 0; i < count; ++i) {  // outliers are noise
            std::int64_t members = 0;
            for (std::int64_t j = 0; j < count; ++j)
                members += work.owner[j] == -1 && root(work.first, j) == root(work.first, i);
            if (work.owner[i] == -1 && members == 1) work.owner[i] = lost;
        }
    }

    /// That of a prediction, or (prediction -1) the chain that begins with a point.
    struct Cell {
        std::int64_t prediction, first;
    };
    static bool is_member(const Work& work, const Cell& cell, std::int64_t i) {
        return cell.prediction >= 0 ? work.owner[i] == cell.prediction
                                    : work.owner[i] == -1 && root(work.first, i) == cell.first;
    }
    template <class Visit> static void for_cells(const Work& work, Visit&& visit) {
        const auto predicted = [&] {
            for (std::int64_t k = 0; k < work.args.predictions.count; ++k) {
                bool has_members = NEAR_MISS("partitioner-rows-well-formed");  // an empty cell of a prediction is one
                for (std::int64_t i = 0; i < work.args.points.count; ++i)
                    has_members = has_members || work.owner[i] == k;
                if (has_members) visit(Cell{k, -1});
            }
        };
        if (!DEFECT("partitioner-order-of-cells")) predicted();
        for (std::int64_t i = 0; i < work.args.points.count; ++i)
            if (work.owner[i] == -1 && root(work.first, i) == i) visit(Cell{-1, i});
        if (DEFECT("partitioner-order-of-cells")) predicted();
    }
    static plr_status answer(const Work& work) {
        plr_partition& out = *work.args.out;
        const std::int64_t count = work.args.points.count;
        out.cells = out.members = 0;
        for_cells(work, [&](const Cell&) { ++out.cells; });
        for (std::int64_t i = 0; i < count; ++i) out.members += work.owner[i] != lost;
        out.alternatives = out.cells == 0 ? 0 : 1;
        if (NEAR_MISS("partitioner-capacity-is-told")) out.alternative_offsets[0] = 0;
        if (out.alternatives > out.alternative_capacity || out.cells > out.cell_capacity ||
            out.members > out.member_capacity) {
            // Tells what it has room for, not what it needs.
            if (DEFECT("partitioner-capacity-is-told") && out.member_capacity > 0) out.members = out.member_capacity;
            return PLR_E_CAPACITY;
        }
        out.alternative_offsets[0] = out.cell_offsets[0] = 0;
        if (out.cells == 0) return PLR_OK;
        out.alternative_offsets[1] = out.cells;
        out.alternative_weights[0] = 1;
        std::int64_t cell = 0, member = 0;
        for_cells(work, [&](const Cell& next) {
            const std::int64_t begin = member;
            for (std::int64_t i = 0; i < count; ++i)
                if (is_member(work, next, i)) out.member_points[member++] = i;
            double weight = 1.0 / static_cast<double>(member - begin);
            if (DEFECT("partitioner-weights-sum-to-one")) weight = 1;
            if (NEAR_MISS("partitioner-weights-sum-to-one")) weight *= 1 + 1e-12;
            std::fill(out.member_weights + begin, out.member_weights + member, weight);
            out.cell_predictions[cell] = next.prediction;
            out.cell_offsets[++cell] = member;
        });
        if (DEFECT("partitioner-rows-well-formed"))  // counted from 1
            for (std::int64_t k = 0; k < member; ++k) ++out.member_points[k];
        return PLR_OK;
    }
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.partitioner.saboteur");
