// The airship's known answers (tests/reference/airship_giw_trace.json): six scans through the tracker with each update rule.
#include "../support/airship_parts.hpp"
#include "../support/reference.hpp"

#include <catch2/catch.hpp>

namespace {

using namespace test_support;

/// State and extent that the tracker told last for the scan at that time.
struct Told {
    Eigen::VectorXd state;
    Eigen::MatrixXd extent;
};

std::map<std::int64_t, Told> track(const std::string& extent, const nlohmann::json& trace) {
    Bench bench;
    StageUnderTest tracker(bench, plugin("tracker", "extended_target"), "{}", airship_tracker_parts(bench, extent));
    const Eigen::MatrixXd noise = std::pow(trace.at("R_sigma").get<double>(), 2) * Eigen::MatrixXd::Identity(3, 3);
    std::int64_t time = 0;
    for (const auto& points : trace.at("Z")) {
        auto scan = radar_scan(matrix(points).transpose(), noise);
        tracker.receive(0, scan.message(time));
        time += second;
    }
    std::map<std::int64_t, Told> told;
    for (const auto& published : bench.published) {
        if (published.port != 0) continue;  // innovations
        for (std::int64_t i = 0; i < published.tracks().count; ++i)
            told[published.tracks().times[i] / second] = {pelorus::item(published.tracks().mean, i),
                                                          pelorus::item(published.tracks().extent, i)};
    }
    return told;
}

double difference(const Eigen::MatrixXd& a, const nlohmann::json& b) { return (a - matrix(b)).cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("the airship tracker repeats the trace of every update rule", "[airship]") {
    const nlohmann::json trace = reference("airship_giw_trace.json");
    const auto [rule, extent] = GENERATE(table<std::string, std::string>({
        {"paper_traceKoch", "{update: published}"},
        {"paper_traceKoch", "{update: published, innovation_spread: trace}"},
        {"paper_literalN_sym", "{update: published, innovation_spread: symmetrised}"},
        {"paper_ffkN", "{update: published, innovation_spread: feldmann}"},
        {"feldmann2011", "{update: feldmann}"},
        {"koch2008", "{update: koch}"},
        {"lanli2012", "{update: lan_li}"},
    }));
    INFO(rule << " by " << extent);
    const auto told = track(extent, trace);
    const nlohmann::json& known = trace.at("out").at(rule);
    REQUIRE(told.size() == 6);
    CHECK(difference(told.at(2).state, known.at("x_k2")) < 1e-6);
    CHECK(difference(told.at(2).extent, known.at("X_k2")) < 1e-6);
    CHECK(difference(told.at(5).state, known.at("x_last")) < 1e-6);
    CHECK(difference(told.at(5).extent, known.at("X_last")) < 1e-6);
}
