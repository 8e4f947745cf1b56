#include "model_calls.hpp"

#include <cmath>

#include <fmt/format.h>

namespace pelorus::conformance {

namespace {

std::size_t at(std::int64_t index) noexcept { return static_cast<std::size_t>(index); }

/// Where an item's matrices begin in the values of an argument, and how many doubles they are; 0 where nothing is the item's own.
std::pair<std::int64_t, std::int64_t> place_of_item(const Argument& argument, std::int64_t item) {
    if (argument.is_absent || argument.is_common) return {0, 0};
    const std::int64_t size = argument.rows * argument.cols;
    if (argument.offsets.empty()) return {item * size, size};
    const std::int64_t first = argument.offsets[at(item)];
    return {first * size, (argument.offsets[at(item + 1)] - first) * size};
}

/// change(values of the item, their number) answers what it did in words, or "" for nothing.
template <class Change> std::vector<Fault> faults_of(const HotCall& call, Sample& sample, Change&& change) {
    std::vector<Fault> faults;
    for (std::size_t a = 0; a < call.in.size(); ++a) {
        const std::int64_t item = static_cast<std::int64_t>(sample.below(static_cast<std::uint64_t>(call.count)));
        const auto [first, size] = place_of_item(call.in[a], item);
        if (size == 0) continue;
        Fault fault{call, a, item, {}};
        fault.words = change(fault.call.in[a], fault.call.in[a].values.data() + first, size, item);
        if (!fault.words.empty()) faults.push_back(std::move(fault));
    }
    return faults;
}

}  // namespace

std::vector<std::uint64_t> ids_of(const std::vector<std::int64_t>& items) { return {items.begin(), items.end()}; }

std::vector<Fault> faults_of_element(const HotCall& call, Sample& sample, double value) {
    constexpr int elements_tried = 2;
    std::vector<Fault> all;
    for (int n = 0; n < elements_tried; ++n) {
        const auto change = [&](const Argument& argument, double* values, std::int64_t size, std::int64_t item) {
            const auto element = static_cast<std::int64_t>(sample.below(static_cast<std::uint64_t>(size)));
            values[element] = value;
            const std::int64_t in_matrix = element % (argument.rows * argument.cols);
            return fmt::format("with {} in {}", value,
                               element_name(argument, item, in_matrix % argument.rows, in_matrix / argument.rows));
        };
        for (Fault& fault : faults_of(call, sample, change)) all.push_back(std::move(fault));
    }
    return all;
}

std::vector<Fault> faults_of_item(const HotCall& call, Sample& sample, double value) {
    return faults_of(call, sample, [&](const Argument& argument, double* values, std::int64_t size, std::int64_t item) {
        std::fill(values, values + size, value);
        return fmt::format("with {} in all of {} of item {}", value, argument.name, item);
    });
}

std::vector<Fault> faults_of_rank(const HotCall& call, Sample& sample) {
    std::vector<Fault> all;
    for (const bool is_zero : {true, false}) {
        const auto change = [&](const Argument& argument, double* values, std::int64_t size, std::int64_t item) {
            const std::int64_t n = argument.rows;
            if (argument.content != Content::covariance || n != argument.cols) return std::string();
            for (std::int64_t first = 0; first < size; first += n * n) {
                Eigen::Map<Eigen::MatrixXd> p(values + first, n, n);
                const Eigen::VectorXd deviations = p.diagonal().cwiseSqrt();
                p = is_zero ? Eigen::MatrixXd::Zero(n, n) : Eigen::MatrixXd(deviations * deviations.transpose());
            }
            return fmt::format("with a {} {} of item {}", is_zero ? "zero" : "rank-one", argument.name, item);
        };
        for (Fault& fault : faults_of(call, sample, change)) all.push_back(std::move(fault));
    }
    return all;
}

void check_others_unchanged(const Fault& fault, const Execution& good, const Execution& done) {
    if (!fault.call.is_per_item) return;
    if (done.status < 0)
        FAIL(fault.call.function << " " << fault.words << " fails for all items: " << done.told()
                                 << "; expected PLR_ITEMS_FAILED and a status for that item");
    std::string difference;
    for (std::int64_t i = 0; i < fault.call.count; ++i)
        if (i != fault.item && !same_item(fault.call, good, i, fault.call, done, i, difference))
            FAIL(fault.call.function << " " << fault.words
                                     << " answers another item differently (without it against with it): "
                                     << difference);
}

std::string not_finite(const HotCall& call, const Execution& done, std::int64_t item) {
    for (std::size_t a = 0; a < call.out.size(); ++a) {
        const Argument& argument = call.out[a];
        if (argument.is_absent || argument.content == Content::opaque) continue;
        const std::vector<double> values = HotCall::item_of(argument, done.out[a], item);
        for (std::size_t e = 0; e < values.size(); ++e) {
            if (std::isfinite(values[e]) || (argument.content == Content::number && std::isinf(values[e]))) continue;
            const std::int64_t in_matrix = static_cast<std::int64_t>(e) % (argument.rows * argument.cols);
            return fmt::format("{} is {}",
                               element_name(argument, item, in_matrix % argument.rows, in_matrix / argument.rows),
                               values[e]);
        }
    }
    return {};
}

}  // namespace pelorus::conformance
