// What the numbers of every model promise, whatever they mean.
#include <cmath>

#include <Eigen/Eigenvalues>

#include "machine/fault_handler.hpp"
#include "machine/guarded_memory.hpp"
#include "model_calls.hpp"

namespace pelorus::conformance {

namespace {

/// attempt(argument, item, values) for every output item that did not fail.
template <class Try> void for_outputs(Bench& bench, Try&& attempt) {
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        INFO(call.function);
        const Execution done = execute_well(instance, call);
        for (std::size_t a = 0; a < call.out.size(); ++a)
            for (std::int64_t i = 0; i < call.count; ++i)
                if (!call.out[a].is_absent && !done.failed(i))
                    attempt(call.out[a], i, HotCall::item_of(call.out[a], done.out[a], i));
    });
}

std::string element_of(const Argument& argument, std::int64_t item, std::size_t element) {
    const auto in_matrix = static_cast<std::int64_t>(element) % (argument.rows * argument.cols);
    return element_name(argument, item, in_matrix % argument.rows, in_matrix / argument.rows);
}

/// attempt(argument, item, matrix) for every covariance.
template <class Try> void for_covariances(Bench& bench, Try&& attempt) {
    for_outputs(bench, [&](const Argument& argument, std::int64_t item, const std::vector<double>& values) {
        if (argument.content != Content::covariance) return;
        const std::int64_t size = argument.rows * argument.cols;
        for (std::size_t first = 0; first < values.size(); first += static_cast<std::size_t>(size))
            attempt(argument, item,
                    Eigen::Map<const Eigen::MatrixXd>(values.data() + first, argument.rows, argument.cols));
    });
}

}  // namespace

PELORUS_CHECK(model, "calls-come-back", 2,
              "Every call comes back when its arguments are plausible: it neither crashes nor goes on for ever. All "
              "other checks that make calls rest on this one.",
              {}) {
    // Memory as an ordinary host lends it: what is written where it should not be is for later checks to tell.
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        set_call_of_fault(call.function.c_str());
        execute_leniently(instance, call);
        set_call_of_fault("");
    });
}

PELORUS_CHECK(model, "calls-succeed", 2,
              "Every call answers PLR_OK for plausible arguments, and needs no more scratch memory than info() says; "
              "a call that fails at random loses tracks.",
              {"same-bytes-again"}) {
    for_calls(bench, [&](const Instance& instance, const HotCall& call) { execute_well(instance, call); });
}

PELORUS_CHECK(model, "outputs-written", 2,
              "Every element of every output is written; what was in the caller's memory before is another track.",
              {"calls-succeed"}) {
    for_outputs(bench, [&](const Argument& argument, std::int64_t item, const std::vector<double>& values) {
        if (argument.content == Content::opaque) return;
        for (std::size_t e = 0; e < values.size(); ++e)
            if (GuardedMemory::is_pattern(values[e])) FAIL(element_of(argument, item, e) << " was not written");
    });
}

PELORUS_CHECK(model, "numbers-finite", 2,
              "Every element of every output is finite for plausible arguments; one NaN in one track spreads to all "
              "that it is compared with.",
              {"outputs-written"}) {
    for_outputs(bench, [&](const Argument& argument, std::int64_t item, const std::vector<double>& values) {
        if (argument.content == Content::opaque) return;
        for (std::size_t e = 0; e < values.size(); ++e)
            if (std::isnan(values[e]) || (argument.content != Content::number && std::isinf(values[e])))
                FAIL(element_of(argument, item, e) << " is " << values[e]);
    });
}

PELORUS_CHECK(model, "covariances-symmetric", 3,
              "A covariance is symmetric to the last bit; a filter that is fed another one loses its own after some "
              "steps.",
              {"numbers-finite"}) {
    for_covariances(bench, [&](const Argument& argument, std::int64_t item, const auto& p) {
        for (Eigen::Index c = 0; c < p.cols(); ++c)
            for (Eigen::Index r = c + 1; r < p.rows(); ++r)
                if (p(r, c) != p(c, r))
                    FAIL(element_name(argument, item, r, c)
                         << " is " << p(r, c) << ", and its mirror image " << element_name(argument, item, c, r)
                         << " differs by " << p(c, r) - p(r, c));
    });
}

PELORUS_CHECK(model, "covariances-positive", 3,
              "A covariance has no negative eigenvalue; one that has gives distances below zero, and no square root.",
              {"covariances-symmetric"}) {
    for_covariances(bench, [&](const Argument& argument, std::int64_t item, const auto& p) {
        if (p.size() == 0) return;
        // Scaled to a unit diagonal: units must not hide a negative direction. Rounding then stays below 1e-9 by far.
        const Eigen::VectorXd deviations =
            p.diagonal().cwiseMax(0.0).cwiseSqrt().unaryExpr([](double d) { return d > 0 ? 1 / d : 0.0; });
        const Eigen::MatrixXd scaled = deviations.asDiagonal() * p * deviations.asDiagonal();
        const double least =
            Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues()(0);
        if (p.diagonal().minCoeff() < 0 || least < -1e-9)
            FAIL("`" << argument.name << "` of item " << item << " has a negative variance: least eigenvalue " << least
                     << " (scaled to a unit diagonal)");
    });
}

}  // namespace pelorus::conformance
