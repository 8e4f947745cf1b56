#include "partitioner_calls.hpp"

#include <algorithm>

#include <catch2/catch.hpp>

#include "machine/library.hpp"

namespace pelorus::conformance {

static_assert(sizeof(std::int64_t) == sizeof(double), "buffers of whole numbers lie in arrays of doubles");

namespace {

enum Output : std::size_t {
    told_sizes,
    alternative_offsets,
    alternative_weights,
    cell_offsets,
    cell_predictions,
    member_points,
    member_weights
};

/// Many matrices of one item.
Argument ragged(const std::string& name, std::int64_t rows, std::int64_t cols, std::int64_t count) {
    Argument argument = input(name, rows, cols, count, [](double*, std::int64_t) {});
    argument.offsets = {0, count};
    return argument;
}
Argument matrices(const std::string& name, std::int64_t d, const std::vector<Eigen::MatrixXd>& all) {
    if (all.empty()) return absent(name);
    Argument argument = ragged(name, d, d, static_cast<std::int64_t>(all.size()));
    for (std::size_t k = 0; k < all.size(); ++k)
        std::copy_n(all[k].data(), d * d, argument.values.data() + static_cast<std::int64_t>(k) * d * d);
    return argument;
}
Argument columns(const std::string& name, const Eigen::MatrixXd& all) {
    Argument argument = ragged(name, all.rows(), 1, all.cols());
    std::copy_n(all.data(), all.size(), argument.values.data());
    return argument;
}
std::int64_t* whole(const plr_view& view) { return reinterpret_cast<std::int64_t*>(view.data); }
std::vector<std::int64_t> whole(const std::vector<double>& doubles, std::int64_t count) {
    std::vector<std::int64_t> numbers(static_cast<std::size_t>(count));
    std::memcpy(numbers.data(), doubles.data(), numbers.size() * sizeof(std::int64_t));
    return numbers;
}

}  // namespace

HotCall PartitionerCalls::split(const ScanToSplit& scan, const Capacities& room, const plr_parallel* parallel) const {
    const std::int64_t d = scan.points.rows();
    HotCall call = make_call("split", 1);
    call.is_per_item = false;
    call.takes_pointers = true;
    call.scratch_beyond = info.scratch_bytes_point *
                          static_cast<std::uint64_t>(scan.points.cols() + static_cast<std::int64_t>(scan.ids.size()));
    call.in = {columns("points", scan.points), matrices("covariance", d, scan.covariance),
               scan.ids.empty() ? absent("predictions.mean") : columns("predictions.mean", scan.mean),
               matrices("predictions.covariance", d, scan.mean_covariance),
               matrices("predictions.extent", d, scan.extent)};
    call.takes_pointers = true;
    call.out = {output("sizes", 3, 1),
                output("alternative_offsets", room.alternatives + 1, 1, Content::opaque),
                output("alternative_weights", room.alternatives, 1, Content::opaque),
                output("cell_offsets", room.cells + 1, 1, Content::opaque),
                output("cell_predictions", room.cells, 1, Content::opaque),
                output("member_points", room.members, 1, Content::opaque),
                output("member_weights", room.members, 1, Content::opaque)};
    call.invoke = [own = &table, self = instance.self(), room, ids = scan.ids, parallel](const plr_call& context,
                                                                                         const Views& v) {
        plr_partition out{};
        out.struct_size = sizeof out;
        out.alternative_capacity = room.alternatives;
        out.cell_capacity = room.cells;
        out.member_capacity = room.members;
        out.alternative_offsets = whole(v.out[alternative_offsets]);
        out.alternative_weights = v.out[alternative_weights].data;
        out.cell_offsets = whole(v.out[cell_offsets]);
        out.cell_predictions = whole(v.out[cell_predictions]);
        out.member_points = whole(v.out[member_points]);
        out.member_weights = v.out[member_weights].data;
        plr_partitioner_split args{};
        args.struct_size = sizeof args;
        args.points = v.in[0];
        args.covariance = v.in[1];
        args.predictions = {static_cast<std::int64_t>(ids.size()), ids.data(), v.in[2], v.in[3], v.in[4]};
        args.parallel = parallel;
        args.out = &out;
        const plr_status status = own->split(self, &context, &args);
        v.out[told_sizes].data[0] = static_cast<double>(out.alternatives);
        v.out[told_sizes].data[1] = static_cast<double>(out.cells);
        v.out[told_sizes].data[2] = static_cast<double>(out.members);
        return status;
    };
    return call;
}

Capacities PartitionerCalls::told(const Execution& done) {
    const std::vector<double>& sizes = done.out[told_sizes];
    return {static_cast<std::int64_t>(sizes[0]), static_cast<std::int64_t>(sizes[1]),
            static_cast<std::int64_t>(sizes[2])};
}

Capacities PartitionerCalls::needed(const ScanToSplit& scan) const {
    const Execution done = execute(instance, split(scan, {}));
    if (!done.left_by.empty()) FAIL("split was left by " << done.left_by);
    if (done.status != PLR_OK && done.status != PLR_E_CAPACITY)
        FAIL("split of " << scan.points.cols() << " points without room for an answer: answered " << done.told()
                         << ", expected PLR_E_CAPACITY and the sizes needed");
    const Capacities sizes = told(done);
    if (sizes.alternatives < 0 || sizes.cells < 0 || sizes.members < 0 || sizes.members > (std::int64_t{1} << 32))
        FAIL("split asks for " << sizes.alternatives << " alternatives, " << sizes.cells << " cells, " << sizes.members
                               << " members");
    return sizes;
}

Partition PartitionerCalls::partition(const ScanToSplit& scan, const plr_parallel* parallel) const {
    const Execution done = execute_leniently(instance, split(scan, needed(scan), parallel));
    const Capacities sizes = told(done);
    Partition partition;
    partition.alternative_offsets = whole(done.out[alternative_offsets], sizes.alternatives + 1);
    partition.cell_offsets = whole(done.out[cell_offsets], sizes.cells + 1);
    partition.cell_predictions = whole(done.out[cell_predictions], sizes.cells);
    partition.member_points = whole(done.out[member_points], sizes.members);
    partition.alternative_weights = done.out[alternative_weights];
    partition.member_weights = done.out[member_weights];
    return partition;
}

ScanToSplit sample_scan_to_split(int dimension, std::int64_t points, std::int64_t predictions, Sample& sample) {
    constexpr std::int64_t groups = 5;
    Eigen::MatrixXd centres(dimension, groups);
    for (Eigen::Index k = 0; k < centres.size(); ++k) centres.data()[k] = sample.uniform(-5e3, 5e3);
    ScanToSplit scan;
    scan.points.resize(dimension, points);
    const Eigen::VectorXd one = Eigen::VectorXd::Ones(dimension);
    for (std::int64_t k = 0; k < points; ++k) {
        const auto group = static_cast<Eigen::Index>(sample.below(groups + 1));
        for (int r = 0; r < dimension; ++r)
            scan.points(r, k) =
                group < groups ? centres(r, group) + sample.normal(0, 8.0) : sample.uniform(-5e3, 5e3);  // or alone
        scan.covariance.push_back(sample.covariance(one));
    }
    scan.mean.resize(dimension, predictions);
    for (std::int64_t k = 0; k < predictions; ++k) {
        scan.ids.push_back(100 + static_cast<std::uint64_t>(7 * k));
        for (int r = 0; r < dimension; ++r) scan.mean(r, k) = centres(r, k % groups) + sample.normal(0, 3.0);
        scan.mean_covariance.push_back(sample.covariance(2 * one));
        scan.extent.push_back(sample.covariance(10 * one));
    }
    return scan;
}

namespace {

std::vector<HotCall> all_calls(const Instance& instance, Sample sample, std::int64_t count) {
    const PartitionerCalls calls(instance);
    // One scan is one item: more items are a larger scan, up to a size whose pairs are soon counted.
    const std::int64_t points = std::min<std::int64_t>(5 * count, 60);
    std::vector<HotCall> all;
    for (int d = calls.info.dimension_min; d <= calls.info.dimension_max; ++d)
        for (const std::int64_t predictions : {0, 3}) {
            const ScanToSplit scan = sample_scan_to_split(d, points, predictions, sample);
            all.push_back(calls.split(scan, calls.needed(scan)));
            all.back().function = "split (" + std::to_string(d) + " dimensions" +
                                  (predictions == 0 ? ")" : ", " + std::to_string(predictions) + " predictions)");
        }
    return all;
}

const detail::KindRegistration registration(PLR_PARTITIONER, all_calls, [](const Instance& instance) {
    return instance.table<plr_partitioner>().info(instance.self())->scratch_bytes;
});

}  // namespace

}  // namespace pelorus::conformance
