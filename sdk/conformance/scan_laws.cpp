#include "scan_laws.hpp"

#include <cmath>
#include <set>
#include <string>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "machine/message_words.hpp"
#include "machine/stage_bench.hpp"

namespace pelorus::conformance {

namespace {

Eigen::MatrixXd matrix_of(const plr_const_view& view, std::int64_t item) {
    Eigen::MatrixXd matrix(view.rows, view.cols);
    for (std::int64_t c = 0; c < view.cols; ++c)
        for (std::int64_t r = 0; r < view.rows; ++r)
            matrix(r, c) = view.data[item * view.item_stride + c * view.col_stride + r * view.row_stride];
    return matrix;
}

/// What is wrong with a covariance, "" if nothing is.
std::string fault_of(const Eigen::MatrixXd& p) {
    // One rounding of each element is forgiven: a conversion of coordinates may leave it.
    for (Eigen::Index c = 0; c < p.cols(); ++c)
        for (Eigen::Index r = c + 1; r < p.rows(); ++r)
            if (!(std::abs(p(r, c) - p(c, r)) <= 1e-12 * std::sqrt(std::abs(p(r, r) * p(c, c)))))
                return fmt::format("element ({}, {}) of the covariance is {:.9g}, its mirror image {:.9g}", r, c,
                                   p(r, c), p(c, r));
    if (!(p.diagonal().minCoeff() > 0)) return fmt::format("a variance is {:.6g}", p.diagonal().minCoeff());
    const Eigen::VectorXd scale = p.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * (0.5 * (p + p.transpose())) * scale.asDiagonal();
    const double least =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues()(0);
    if (least > -1e-9) return {};
    return fmt::format("the covariance has a negative direction, least eigenvalue {:.6g} (scaled to a unit diagonal)",
                       least);
}

}  // namespace

void check_measurements_came_in(const Bench& bench) {
    const Script script = plain_script(bench);
    StagePlayer player(bench);
    std::set<std::uint64_t> came_in;
    std::size_t looked_at = 0;
    int told = 0;
    const auto look = [&] {
        for (; looked_at < player.published().size(); ++looked_at) {
            const plr_message& message = *player.published()[looked_at].message;
            if (message.kind != PLR_MESSAGE_SCAN) continue;
            const plr_scan& scan = *message.body.scan;
            for (std::int64_t i = 0; i < scan.measurements.count; ++i, ++told)
                if (came_in.count(scan.ids[i]) == 0)
                    FAIL("measurement " << i << " of a " << brief(message) << " has the id " << scan.ids[i]
                                        << "; no measurement of that id has come in");
        }
    };
    for (const Delivery& delivery : script.deliveries) {
        if (delivery.message->kind == PLR_MESSAGE_SCAN) {
            const plr_scan& scan = *delivery.message->body.scan;
            came_in.insert(scan.ids, scan.ids + scan.measurements.count);
        }
        player.deliver(delivery);
        look();
    }
    player.finish_well();
    look();
    if (told == 0) skip("publishes no measurement for plain messages");
}

void check_covariances_positive(const Bench& bench) {
    const Script script = plain_script(bench);
    StagePlayer player(bench);
    play(player, script);
    player.finish_well();
    int told = 0;
    for (const PublishedMessage& published : player.published()) {
        const plr_message& message = *published.message;
        plr_const_view all{};
        if (message.kind == PLR_MESSAGE_SCAN) {
            all = message.body.scan->covariances;
            all.count = message.body.scan->measurements.count;  // one may be common to all
        }
        if (message.kind == PLR_MESSAGE_TRACKS) all = message.body.tracks->covariance;
        for (std::int64_t i = 0; all.data != nullptr && i < all.count; ++i, ++told) {
            const std::string fault = fault_of(matrix_of(all, i));
            if (!fault.empty()) FAIL("entry " << i << " of a " << brief(message) << ": " << fault);
        }
    }
    if (told == 0) skip("publishes no covariance for plain messages");
}

}  // namespace pelorus::conformance
