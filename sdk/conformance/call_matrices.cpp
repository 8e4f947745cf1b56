#include "call_matrices.hpp"

#include <cmath>

#include <fmt/format.h>

#include "differences.hpp"

namespace pelorus::conformance {

namespace {

ExecuteOptions unguarded() {
    ExecuteOptions options;
    options.is_guarded = false;
    return options;
}

}  // namespace

Argument columns(const std::string& name, const Eigen::MatrixXd& matrix) {
    return input(name, matrix.rows(), 1, matrix.cols(),
                 [&](double* out, std::int64_t i) { Eigen::Map<Eigen::VectorXd>(out, matrix.rows()) = matrix.col(i); });
}

Eigen::MatrixXd answered(const Instance& instance, const HotCall& call) {
    const Execution done = execute_well(instance, call, unguarded());
    return Eigen::Map<const Eigen::MatrixXd>(done.out[0].data(), call.out[0].rows, call.out[0].cols * call.count);
}

std::vector<Eigen::MatrixXd> answered_matrices(const Instance& instance, const HotCall& call, std::size_t output) {
    const Execution done = execute_well(instance, call, unguarded());
    std::vector<Eigen::MatrixXd> matrices;
    const std::int64_t size = call.out[output].rows * call.out[output].cols;
    for (std::int64_t i = 0; i < call.count; ++i)
        matrices.emplace_back(Eigen::Map<const Eigen::MatrixXd>(done.out[output].data() + i * size,
                                                                call.out[output].rows, call.out[output].cols));
    return matrices;
}

std::string first_difference(const Eigen::MatrixXd& got, const Eigen::MatrixXd& expected,
                             const Eigen::MatrixXd& allowed, const Space& rows, const Space& cols) {
    double worst = 1;
    std::string text;
    for (Eigen::Index c = 0; c < got.cols(); ++c)
        for (Eigen::Index r = 0; r < got.rows(); ++r) {
            const double off = std::fabs(got(r, c) - expected(r, c));
            if (off <= worst * allowed(r, c)) continue;
            worst = allowed(r, c) > 0 ? off / allowed(r, c) : HUGE_VAL;
            text = fmt::format("element ({}, {}) is {:.12g}, expected {:.12g}", rows[static_cast<int>(r)].name,
                               cols[static_cast<int>(c)].name, got(r, c), expected(r, c));
        }
    return text;
}

std::string first_difference(const Eigen::VectorXd& got, const Eigen::VectorXd& expected,
                             const Eigen::VectorXd& allowed, const Space& rows) {
    double worst = 1;
    std::string text;
    const Eigen::VectorXd off = difference_in(rows, got, expected);
    for (Eigen::Index r = 0; r < got.size(); ++r) {
        if (std::fabs(off(r)) <= worst * allowed(r)) continue;
        worst = allowed(r) > 0 ? std::fabs(off(r)) / allowed(r) : HUGE_VAL;
        text = fmt::format("{} is {:.12g}, expected {:.12g}", rows[static_cast<int>(r)].name, got(r), expected(r));
    }
    return text;
}

Eigen::MatrixXd element_scales(const Eigen::MatrixXd& covariance) {
    const Eigen::VectorXd deviations = covariance.diagonal().cwiseAbs().cwiseSqrt();
    return deviations * deviations.transpose();
}

Eigen::MatrixXd item_matrix(const HotCall& call, const Execution& done, std::size_t output, std::int64_t i) {
    const Argument& argument = call.out[output];
    const auto values = HotCall::item_of(argument, done.out[output], i);
    return Eigen::Map<const Eigen::MatrixXd>(values.data(), argument.rows, argument.cols);
}

}  // namespace pelorus::conformance
