// What every call of every model promises, whatever it computes.
#include <cmath>
#include <cstring>

#include <Eigen/Eigenvalues>

#include "machine/bench.hpp"
#include "machine/guarded_memory.hpp"
#include "machine/hot_call.hpp"

namespace pelorus::conformance {

namespace {

constexpr std::int64_t batch = 7;

template <class Try> void for_calls(Bench& bench, Try&& attempt, std::int64_t count = batch) {
    const auto instance = bench.make();
    for (const HotCall& call : hot_calls(*instance, bench.sample(), count)) {
        INFO(call.function);
        attempt(*instance, call);
    }
}

/// The first element of an output that breaks its promise, in words; "" if none does.
std::string broken_promise(const Argument& argument, const std::vector<double>& item_values, std::int64_t item) {
    const std::int64_t size = argument.rows * argument.cols;
    for (std::size_t e = 0; e < item_values.size(); ++e) {
        const double value = item_values[e];
        const auto in_matrix = static_cast<std::int64_t>(e) % size;
        const std::string name = element_name(argument, item, in_matrix % argument.rows, in_matrix / argument.rows);
        if (GuardedMemory::is_pattern(value)) return name + " was not written";
        if (std::isnan(value)) return name + " is not a number";
        if (argument.content != Content::number && std::isinf(value)) return name + " is infinite";
    }
    return {};
}

}  // namespace

PELORUS_CHECK(model, "numbers-finite", 2,
              "Every element of every output is written and finite for plausible arguments; one NaN in one track "
              "spreads to all that it is compared with.",
              {}) {
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        const Execution done = execute_well(instance, call);
        for (std::size_t a = 0; a < call.out.size(); ++a)
            for (std::int64_t i = 0; i < call.count; ++i) {
                if (call.out[a].is_absent || call.out[a].content == Content::opaque || done.failed(i)) continue;
                const std::string broken =
                    broken_promise(call.out[a], HotCall::item_of(call.out[a], done.out[a], i), i);
                if (!broken.empty()) FAIL(call.function << ": " << broken);
            }
    });
}

PELORUS_CHECK(
    model, "covariances-symmetric-positive", 3,
    "A covariance is symmetric to the last bit and has no negative eigenvalue; a filter that is fed another one "
    "loses its own after some steps.",
    {"numbers-finite"}) {
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        const Execution done = execute_well(instance, call);
        for (std::size_t a = 0; a < call.out.size(); ++a) {
            const Argument& argument = call.out[a];
            if (argument.content != Content::covariance || argument.is_absent) continue;
            for (std::int64_t i = 0; i < call.count; ++i) {
                if (done.failed(i)) continue;
                const auto values = HotCall::item_of(argument, done.out[a], i);
                const Eigen::Map<const Eigen::MatrixXd> p(values.data(), argument.rows, argument.cols);
                for (Eigen::Index c = 0; c < p.cols(); ++c)
                    for (Eigen::Index r = c + 1; r < p.rows(); ++r)
                        if (p(r, c) != p(c, r))
                            FAIL(call.function << ": " << element_name(argument, i, r, c) << " is " << p(r, c)
                                               << " and its mirror image differs by " << p(c, r) - p(r, c));
                // Scaled to a unit diagonal: units must not hide a negative direction.
                const Eigen::VectorXd deviations =
                    p.diagonal().cwiseMax(0.0).cwiseSqrt().unaryExpr([](double d) { return d > 0 ? 1 / d : 0.0; });
                const Eigen::MatrixXd scaled = deviations.asDiagonal() * p * deviations.asDiagonal();
                const double least =
                    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues()(0);
                if (p.diagonal().minCoeff() < 0 || least < -1e-9)
                    FAIL(call.function << ": `" << argument.name << "` of item " << i
                                       << " has a negative variance: least eigenvalue " << least
                                       << " (scaled to a unit diagonal)");
            }
        }
    });
}

PELORUS_CHECK(
    model, "writes-only-its-outputs", 2,
    "A call writes the elements of its output views and nothing else: not its inputs, not between items, not past "
    "the end; it hands its scratch memory back. The next track lies there.",
    {}) {
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        for (const std::int64_t gap : {0, 3}) {
            ExecuteOptions options;
            options.gap = gap;
            const Execution done = execute_well(instance, call, options);
            for (const std::string& stray : done.stray) FAIL_CHECK(call.function << ": " << stray);
            if (done.scratch_left_used != 0)
                FAIL_CHECK(call.function << " keeps " << done.scratch_left_used << " bytes of scratch memory");
        }
    });
}

PELORUS_CHECK(model, "batch-equals-singles", 2,
              "A batch gives each item the very bits that it would get alone; otherwise results depend on who else is "
              "tracked, and on how work is split.",
              {"writes-only-its-outputs"}) {
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        if (!call.is_per_item) return;
        const Execution whole = execute_well(instance, call);
        for (std::int64_t i = 0; i < call.count; ++i) {
            const HotCall single = call.of_items({i});
            const Execution alone = execute_well(instance, single);
            std::string difference;
            if (!same_item(call, whole, i, single, alone, 0, difference))
                FAIL(call.function << ": in a batch of " << call.count << " and alone, " << difference);
        }
    });
}

}  // namespace pelorus::conformance
