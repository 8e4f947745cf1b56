// The laws of partitioners.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "machine/bench.hpp"
#include "machine/check.hpp"
#include "machine/library.hpp"
#include "partitioner_calls.hpp"

namespace pelorus::conformance {

namespace {

bool overlaps(const Bench& bench) { return (bench.description().flags & PLR_DESCRIPTION_OVERLAP) != 0; }

/// Tries something on scans of each dimension, with and without predictions.
template <class Try> void for_scans(Bench& bench, Try&& attempt) {
    const auto instance = bench.make();
    const PartitionerCalls calls(*instance);
    for (int d = calls.info.dimension_min; d <= calls.info.dimension_max; ++d)
        for (const std::int64_t predictions : {0, 3}) {
            Sample sample = bench.sample(static_cast<std::uint64_t>(10 * d + predictions));
            const ScanToSplit scan = sample_scan_to_split(d, 40, predictions, sample);
            INFO("a scan of 40 points in " << d << " dimensions, " << predictions << " predictions");
            attempt(calls, scan, sample);
        }
}

std::size_t at(std::int64_t index) { return static_cast<std::size_t>(index); }

/// Fails unless the offsets begin with 0, do not descend, and end with `end`.
void examine_offsets(const char* name, const std::vector<std::int64_t>& offsets, std::int64_t end) {
    if (offsets.front() != 0) FAIL(name << "[0] is " << offsets.front() << ", expected 0");
    for (std::size_t k = 1; k < offsets.size(); ++k)
        if (offsets[k] < offsets[k - 1])
            FAIL(name << "[" << k << "] is " << offsets[k] << " after " << offsets[k - 1] << ": offsets ascend");
    if (offsets.back() != end) FAIL(name << " ends with " << offsets.back() << ", there are " << end << " elements");
}

/// The cells of an alternative as sets of points, by `name_of` point, with the prediction that each is of.
using Cells = std::set<std::pair<std::int64_t, std::set<std::int64_t>>>;
std::multiset<Cells> cells_of(const Partition& partition, const std::vector<std::int64_t>& name_of) {
    std::multiset<Cells> alternatives;
    for (std::size_t a = 0; a + 1 < partition.alternative_offsets.size(); ++a) {
        Cells cells;
        for (std::int64_t k = partition.alternative_offsets[a]; k < partition.alternative_offsets[a + 1]; ++k) {
            std::set<std::int64_t> members;
            for (std::int64_t e = partition.cell_offsets[at(k)]; e < partition.cell_offsets[at(k + 1)]; ++e)
                members.insert(name_of[at(partition.member_points[at(e)])]);
            cells.insert({partition.cell_predictions[at(k)], members});
        }
        alternatives.insert(cells);
    }
    return alternatives;
}
std::vector<std::int64_t> own_names(std::int64_t count) {
    std::vector<std::int64_t> names;
    for (std::int64_t k = 0; k < count; ++k) names.push_back(k);
    return names;
}

}  // namespace

PELORUS_CHECK(partitioner, "partitioner-rows-well-formed", 2,
              "The answer is nested rows: offsets begin with 0, ascend and end with the number of elements; members "
              "are points of the scan, predictions are of those given. Trackers follow them without looking.",
              {"numbers-finite"}) {
    for_scans(bench, [&](const PartitionerCalls& calls, const ScanToSplit& scan, Sample&) {
        const Partition p = calls.partition(scan);
        const auto cells = static_cast<std::int64_t>(p.cell_predictions.size()),
                   members = static_cast<std::int64_t>(p.member_points.size());
        examine_offsets("alternative_offsets", p.alternative_offsets, cells);
        examine_offsets("cell_offsets", p.cell_offsets, members);
        if (p.alternative_offsets.size() < 2) FAIL("there is no alternative for a scan of 40 points");
        for (std::size_t e = 0; e < p.member_points.size(); ++e)
            if (p.member_points[e] < 0 || p.member_points[e] >= scan.points.cols())
                FAIL("member_points[" << e << "] is " << p.member_points[e] << ", the scan has " << scan.points.cols()
                                      << " points");
        for (std::size_t k = 0; k < p.cell_predictions.size(); ++k)
            if (p.cell_predictions[k] < -1 || p.cell_predictions[k] >= static_cast<std::int64_t>(scan.ids.size()))
                FAIL("cell_predictions[" << k << "] is " << p.cell_predictions[k] << ", expected -1 to "
                                         << static_cast<std::int64_t>(scan.ids.size()) - 1);
    });
}

PELORUS_CHECK(partitioner, "partitioner-every-point-once", 2,
              "Within an alternative every point is in exactly one cell, or in one at least where the description says "
              "PLR_DESCRIPTION_OVERLAP; a point that is lost is a target that is lost.",
              {"partitioner-rows-well-formed"}) {
    for_scans(bench, [&](const PartitionerCalls& calls, const ScanToSplit& scan, Sample&) {
        const Partition p = calls.partition(scan);
        for (std::size_t a = 0; a + 1 < p.alternative_offsets.size(); ++a) {
            std::vector<int> times(at(scan.points.cols()), 0);
            const std::int64_t first = p.cell_offsets[at(p.alternative_offsets[a])],
                               end = p.cell_offsets[at(p.alternative_offsets[a + 1])];
            for (std::int64_t e = first; e < end; ++e) ++times[at(p.member_points[at(e)])];
            for (std::size_t k = 0; k < times.size(); ++k)
                if (times[k] == 0 || (times[k] > 1 && !overlaps(bench)))
                    FAIL("alternative " << a << ": point " << k << " is in " << times[k] << " cells, expected "
                                        << (overlaps(bench) ? "one at least" : "one"));
        }
    });
}

PELORUS_CHECK(partitioner, "partitioner-order-of-cells", 2,
              "Members of a cell ascend; first come the cells of predictions, one each, in their order, then the "
              "others in the order of their first members: the same split has the same bytes.",
              {"partitioner-rows-well-formed"}) {
    for_scans(bench, [&](const PartitionerCalls& calls, const ScanToSplit& scan, Sample&) {
        const Partition p = calls.partition(scan);
        for (std::size_t a = 0; a + 1 < p.alternative_offsets.size(); ++a) {
            std::pair<std::int64_t, std::int64_t> last{-1, -1};  // (prediction, or those given; first member)
            for (std::int64_t k = p.alternative_offsets[a]; k < p.alternative_offsets[a + 1]; ++k) {
                const std::int64_t first = p.cell_offsets[at(k)], end = p.cell_offsets[at(k + 1)];
                for (std::int64_t e = first + 1; e < end; ++e)
                    if (p.member_points[at(e)] <= p.member_points[at(e - 1)])
                        FAIL("cell " << k << ": member " << p.member_points[at(e)] << " after "
                                     << p.member_points[at(e - 1)] << ": members ascend");
                if (p.cell_predictions[at(k)] < 0 && first == end) FAIL("cell " << k << " of no prediction is empty");
                const bool is_predicted = p.cell_predictions[at(k)] >= 0;
                const std::pair<std::int64_t, std::int64_t> now =
                    is_predicted
                        ? std::make_pair(p.cell_predictions[at(k)], std::int64_t{-1})
                        : std::make_pair(static_cast<std::int64_t>(scan.ids.size()), p.member_points[at(first)]);
                // Cells that overlap may begin with the same member.
                if (now < last || (now == last && (is_predicted || !overlaps(bench))))
                    FAIL("cell " << k << " (of prediction " << p.cell_predictions[at(k)] << ", first member "
                                 << (first == end ? -1 : p.member_points[at(first)])
                                 << ") stands behind one that it should come before");
                last = now;
            }
        }
    });
}

PELORUS_CHECK(
    partitioner, "partitioner-weights-sum-to-one", 2,
    "The members' weights are at least 0 and sum to 1 in a cell; an extent takes them for such. The weights of "
    "alternatives are finite and not negative.",
    {"partitioner-rows-well-formed"}) {
    for_scans(bench, [&](const PartitionerCalls& calls, const ScanToSplit& scan, Sample&) {
        const Partition p = calls.partition(scan);
        for (std::size_t k = 0; k + 1 < p.cell_offsets.size(); ++k) {
            if (p.cell_offsets[k] == p.cell_offsets[k + 1]) continue;
            double sum = 0;
            for (std::int64_t e = p.cell_offsets[k]; e < p.cell_offsets[k + 1]; ++e) {
                if (!(p.member_weights[at(e)] >= 0)) FAIL("member_weights[" << e << "] is " << p.member_weights[at(e)]);
                sum += p.member_weights[at(e)];
            }
            if (!(std::abs(sum - 1) <= 1e-9)) FAIL("the weights of cell " << k << " sum to " << sum << ", expected 1");
        }
        for (std::size_t a = 0; a < p.alternative_weights.size(); ++a)
            if (!(p.alternative_weights[a] >= 0) || std::isinf(p.alternative_weights[a]))
                FAIL("alternative_weights[" << a << "] is " << p.alternative_weights[a]);
    });
}

PELORUS_CHECK(partitioner, "partitioner-capacity-is-told", 2,
              "With one buffer too small by one the answer is PLR_E_CAPACITY and the sizes needed, and nothing is "
              "written past an end; the caller comes back with just that.",
              {"partitioner-rows-well-formed"}) {
    for_scans(bench, [&](const PartitionerCalls& calls, const ScanToSplit& scan, Sample&) {
        const Capacities needed = calls.needed(scan);
        for (int which = 0; which < 3; ++which) {
            Capacities room = needed;
            std::int64_t& one = which == 0 ? room.alternatives : which == 1 ? room.cells : room.members;
            one -= 1;
            const Execution done = execute(calls.instance, calls.split(scan, room));
            const Capacities told = PartitionerCalls::told(done);
            if (done.status != PLR_E_CAPACITY || told.alternatives != needed.alternatives ||
                told.cells != needed.cells || told.members != needed.members)
                FAIL("split with room for " << room.alternatives << " alternatives, " << room.cells << " cells, "
                                            << room.members << " members answered " << status_name(done.status) << ", "
                                            << told.alternatives << ", " << told.cells << ", " << told.members
                                            << "; expected PLR_E_CAPACITY, " << needed.alternatives << ", "
                                            << needed.cells << ", " << needed.members);
        }
    });
}

PELORUS_CHECK(
    partitioner, "partitioner-few-points", 2,
    "No points give no members, one point one cell, and points in one place are points like others; scans are "
    "like that.",
    {"partitioner-every-point-once"}) {
    const auto instance = bench.make();
    const PartitionerCalls calls(*instance);
    for (int d = calls.info.dimension_min; d <= calls.info.dimension_max; ++d) {
        Sample sample = bench.sample();
        for (const std::int64_t points : {0, 1, 9}) {
            ScanToSplit scan = sample_scan_to_split(d, points, 0, sample);
            for (Eigen::Index k = 1; k < scan.points.cols(); ++k) scan.points.col(k) = scan.points.col(0);
            INFO("a scan of " << points << " points in one place, " << d << " dimensions");
            const Partition p = calls.partition(scan);
            for (std::size_t a = 0; a + 1 < p.alternative_offsets.size(); ++a) {
                std::set<std::int64_t> seen;
                for (std::int64_t e = p.cell_offsets[at(p.alternative_offsets[a])];
                     e < p.cell_offsets[at(p.alternative_offsets[a + 1])]; ++e)
                    seen.insert(p.member_points[at(e)]);
                if (static_cast<std::int64_t>(seen.size()) != points)
                    FAIL("alternative " << a << " has " << seen.size() << " of them");
            }
            if (points > 0 && p.alternative_offsets.size() < 2) FAIL("there is no alternative");
        }
    }
}

PELORUS_CHECK(partitioner, "partitioner-order-of-points-free", 3,
              "The cells are the same sets in whatever order the points come; a sensor's order is chance.",
              {"partitioner-every-point-once"}) {
    for_scans(bench, [&](const PartitionerCalls& calls, const ScanToSplit& scan, Sample& sample) {
        if ((calls.info.flags & PLR_FLAG_USES_KEYS) != 0) skip("draws random numbers");
        const std::vector<std::int64_t> order = sample.permutation(scan.points.cols());
        ScanToSplit other = scan;
        for (std::size_t k = 0; k < order.size(); ++k) {
            other.points.col(static_cast<Eigen::Index>(k)) = scan.points.col(order[k]);
            other.covariance[k] = scan.covariance[at(order[k])];
        }
        if (cells_of(calls.partition(scan), own_names(scan.points.cols())) != cells_of(calls.partition(other), order))
            FAIL("split of the same points in another order gives other cells");
    });
}

PELORUS_CHECK(partitioner, "partitioner-place-free", 3,
              "Points and predictions that are shifted together are split alike; the origin is nowhere special.",
              {"partitioner-every-point-once"}) {
    for_scans(bench, [&](const PartitionerCalls& calls, const ScanToSplit& scan, Sample&) {
        // By a power of two, and to coordinates of the same size: differences keep their values to some 1e-12 m.
        ScanToSplit other = scan;
        other.points.array() += 4096.0;
        if (other.mean.size() > 0) other.mean.array() += 4096.0;
        const auto names = own_names(scan.points.cols());
        if (cells_of(calls.partition(scan), names) != cells_of(calls.partition(other), names))
            FAIL("split of points that are shifted by 4096 m on each axis gives other cells");
    });
}

PELORUS_CHECK(partitioner, "partitioner-threads-same-bytes", 3,
              "The answer has the same bytes with plr_parallel of 1, 2 and 4 threads, and without; results do not "
              "depend on the machine.",
              {"partitioner-rows-well-formed"}) {
    for_scans(bench, [&](const PartitionerCalls& calls, const ScanToSplit& scan, Sample&) {
        const Capacities room = calls.needed(scan);
        const HotCall plain = calls.split(scan, room);
        const Execution alone = execute_well(calls.instance, plain);
        for (const unsigned count : {1u, 2u, 4u}) {
            const auto threads = bench.host().threads(count);
            const HotCall call = calls.split(scan, room, &threads->service());
            const Execution together = execute_well(calls.instance, call);
            std::string difference;
            if (!same_item(plain, alone, 0, call, together, 0, difference))
                FAIL("split without plr_parallel and with " << count << " threads: " << difference);
        }
    });
}

PELORUS_CHECK(
    partitioner, "partitioner-refuses-other-dimensions", 2,
    "A scan of a dimension that info does not tell is refused; the third coordinate would be ignored, or read "
    "where there is none.",
    {"numbers-finite"}) {
    const auto instance = bench.make();
    const PartitionerCalls calls(*instance);
    if (calls.info.dimension_min < 1 || calls.info.dimension_max > 3 ||
        calls.info.dimension_min > calls.info.dimension_max)
        FAIL("info tells dimensions " << calls.info.dimension_min << " to " << calls.info.dimension_max
                                      << ", expected some of 1 to 3");
    Sample sample = bench.sample();
    for (const int d : {calls.info.dimension_min - 1, calls.info.dimension_max + 1}) {
        if (d < 1) continue;
        const Execution done = execute(*instance, calls.split(sample_scan_to_split(d, 12, 0, sample), {64, 64, 64}));
        if (done.status == PLR_OK || done.status == PLR_E_CAPACITY)
            FAIL("split of points of " << d << " dimensions answered " << status_name(done.status)
                                       << ", expected PLR_E_ARGUMENT: info tells " << calls.info.dimension_min << " to "
                                       << calls.info.dimension_max);
    }
}

}  // namespace pelorus::conformance
