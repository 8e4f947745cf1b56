// The waveform paper's known answers (tests/reference/waveform_traces.json): 150 noise-free steps with each algorithm.
#include "../support/waveform_trace.hpp"
#include "../support/estimator_under_test.hpp"

#include <catch2/catch.hpp>
#include <deque>
#include <Eigen/LU>

namespace {

using namespace test_support;

/// A filter and what it is made of.
struct Filter {
    std::deque<Instance> parts;
    const Instance* estimator = nullptr;
    const Instance* waveform = nullptr;

    Filter() { parts.emplace_back("sensor", "polar_rate", Values{{"noise", "[100 m, 10 m/s, 0.1 mrad]"}}); }
    /// The reference has its components as [x, vx, ax, y, vy, ay] and draws its points along a factor of P in that order; another
    /// order leaves the points elsewhere on the same ellipsoid, and what a rule of third degree leaves out differs by 1e-6 to 1e-5.
    const Instance& cubature(const std::string& motion, Values values, const std::string& form) {
        values["dimension"] = "2";
        const Instance& sensor = parts.front();
        const Instance& model = parts.emplace_back("motion", motion, values);
        estimator =
            &parts.emplace_back("estimator", "cubature", Values{{"form", form}, {"component_order", "axes"}},
                                std::vector<Instance::Filled>{{"motion", "", &model}, {"sensors", "radar", &sensor}});
        return *estimator;
    }
    void rotate(const std::string& rule) {
        waveform = &parts.emplace_back("waveform", "ellipse_rotation", Values{{"rule", rule}});
    }
};

/// The measurement noise that the waveform model chooses for a predicted record.
Eigen::Matrix3d chosen_noise(const Instance& waveform, const EstimatorUnderTest& filter, const Batch& record,
                             const Eigen::Matrix3d& base) {
    Call call;
    Batch mean(6, 1), covariance(6, 6), measurement(3, 1), projected(3, 3), cross(6, 3), native(6, 3), base_noise(3, 3),
        noise(3, 3);
    const auto part = waveform.as<pelorus::WaveformPart>();
    Batch parameters(part.info().waveform->size, 1);
    REQUIRE(filter.summary(call, record, mean, covariance) == PLR_OK);
    REQUIRE(filter.project(call, 0, record, measurement, projected, native, &cross) == PLR_OK);
    base_noise[0] = base;
    const double second = 1;
    auto args = pelorus::arguments<plr_waveform_choose>();
    args.mean = mean.in();
    args.covariance = covariance.in();
    args.projected = projected.in();
    args.cross = cross.in();
    args.base_noise = base_noise.in();
    args.waveform = parameters.out();
    args.noise = noise.out();
    args.criterion = pelorus::absent_output();
    args.dt = pelorus::const_view(&second, 1, 1, 1);
    args.cartesian = filter.info().cartesian;
    REQUIRE(part.call(&plr_waveform::choose, call, args) == PLR_OK);
    return noise[0];
}

/// Relative, of errors to their standard deviation.
constexpr double tolerance = 1e-6;

/// Runs the filter without noise; `visit(k, filter, record, R)` after each update.
template <class Visit> void run(const Filter& made, Visit visit) {
    const EstimatorUnderTest filter(*made.estimator);
    const std::vector<Eigen::VectorXd> truth = waveform_truth();
    Eigen::VectorXd offset(6), deviations(6);
    offset << 100, -100, 10, -10, 1, -1;
    deviations << 100, 100, 10, 10, 1, 1;
    Call call;
    Batch mean(6, 1), covariance(6, 6), record(filter.record_size(), 1), measurement(3, 1), noise(3, 3);
    mean[0] = truth[0] + offset;
    covariance[0] = deviations.cwiseAbs2().asDiagonal();
    REQUIRE(filter.init(call, {0, 1, 2, 3, 4, 5}, mean, covariance, record) == PLR_OK);
    const Eigen::Matrix3d base = Eigen::Vector3d(1e4, 1e2, 1e-8).asDiagonal();
    const double second = 1;
    for (int k = 1; k <= 150; ++k) {
        const Eigen::VectorXd& state = truth[static_cast<std::size_t>(k)];
        REQUIRE(filter.predict(call, pelorus::const_view(&second, 1, 1, 1), record, record) == PLR_OK);
        noise[0] = made.waveform == nullptr ? base : chosen_noise(*made.waveform, filter, record, base);
        measurement[0] = waveform_measurement(state);
        EstimatorUnderTest::Told told(3, 1);
        REQUIRE(filter.update(call, 0, record, measurement, noise.in(), record, told) == PLR_OK);
        REQUIRE(filter.summary(call, record, mean, covariance) == PLR_OK);
        visit(k, Eigen::VectorXd(mean[0] - state), Eigen::MatrixXd(covariance[0]), record, Eigen::Matrix3d(noise[0]));
    }
}

void check_trace(const Filter& filter, const std::string& name) {
    const nlohmann::json trace = reference("waveform_traces.json").at(name);
    int compared = 0;
    run(filter, [&](int k, const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance, const Batch&,
                    const Eigen::Matrix3d& noise) {
        const std::string step = std::to_string(k);
        if (!trace.contains(step)) return;
        const nlohmann::json& known = trace.at(step);
        CAPTURE(name, k);
        for (int i = 0; i < 6; ++i) {
            const int here = i % 3 * 2 + i / 3;
            CAPTURE(i);
            const double deviation = std::sqrt(covariance(here, here));
            CHECK(error(here) == Approx(known.at("err").at(i).get<double>()).margin(tolerance * deviation).epsilon(0));
            if (known.contains("sd")) CHECK(deviation == Approx(known.at("sd").at(i).get<double>()).epsilon(tolerance));
        }
        if (known.contains("R")) {
            CHECK(noise(0, 0) == Approx(known.at("R").at(0).get<double>()).epsilon(tolerance));
            CHECK(noise(0, 1) == Approx(known.at("R").at(1).get<double>()).epsilon(tolerance).margin(1));
            CHECK(noise(1, 1) == Approx(known.at("R").at(2).get<double>()).epsilon(tolerance));
            CHECK(noise.topLeftCorner(2, 2).determinant() == Approx(1e6).epsilon(1e-12));
        }
        ++compared;
    });
    CHECK(compared == static_cast<int>(trace.size()));
}

}  // namespace

TEST_CASE("the waveform paper's motion models repeat their traces", "[waveform]") {
    const auto form = GENERATE(as<std::string>(), "square_root", "covariance");
    CAPTURE(form);
    {
        Filter filter;
        filter.cubature("adaptive_constant_acceleration", {}, form);
        check_trace(filter, "ACA");
    }
    {
        Filter filter;
        filter.cubature("adaptive_constant_acceleration", {{"noise_form", "white_jerk"}}, form);
        check_trace(filter, "ACA_cont");
    }
    {
        Filter filter;
        filter.cubature("constant_acceleration", {{"form", "discrete"}, {"acceleration", "1"}}, form);
        check_trace(filter, "CA1");
    }
    {
        Filter filter;
        filter.cubature("current_statistical",
                        {{"maneuver_rate", "0.6"}, {"maximum_acceleration", "100"}, {"minimum_acceleration", "-120"}},
                        form);
        check_trace(filter, "CS");
    }
}

TEST_CASE("the rotated ellipse repeats its traces", "[waveform]") {
    for (const auto& [rule, name] : {std::pair("published", "ACA_W22"), std::pair("exact", "ACA_Wx")}) {
        Filter filter;
        filter.cubature("adaptive_constant_acceleration", {}, "square_root");
        filter.rotate(rule);
        check_trace(filter, name);
    }
}

TEST_CASE("the waveform paper's three models repeat their trace and probabilities", "[waveform]") {
    Filter filter;
    const Instance* const cv = &filter.cubature(
        "constant_velocity", {{"form", "discrete"}, {"acceleration", "0.1"}, {"acceleration_deviation", "1e-3"}},
        "square_root");
    const Instance* const quiet =
        &filter.cubature("constant_acceleration", {{"form", "discrete"}, {"acceleration", "1"}}, "square_root");
    const Instance* const swift =
        &filter.cubature("constant_acceleration", {{"form", "discrete"}, {"acceleration", "100"}}, "square_root");
    filter.estimator = &filter.parts.emplace_back(
        "estimator", "imm", Values{{"stay", "0.9"}},
        std::vector<Instance::Filled>{
            {"estimators", "cv", cv}, {"estimators", "quiet", quiet}, {"estimators", "swift", swift}});
    check_trace(filter, "IMM");

    const EstimatorUnderTest imm(*filter.estimator);
    const auto* const modes = imm.part().extension<plr_estimator_modes>(PLR_ESTIMATOR_MODES);
    REQUIRE(modes != nullptr);
    const nlohmann::json trace = reference("waveform_traces.json").at("IMM");
    run(filter,
        [&](int k, const Eigen::VectorXd&, const Eigen::MatrixXd&, const Batch& record, const Eigen::Matrix3d&) {
            if (!trace.contains(std::to_string(k))) return;
            Call call;
            Batch probabilities(3, 1);
            const plr_const_view from = record.in();
            const plr_view to = probabilities.out();
            REQUIRE(modes->probabilities(imm.part().self(), &static_cast<const plr_call&>(call), &from, &to) == PLR_OK);
            for (int j = 0; j < 3; ++j)
                CHECK(probabilities[0](j) ==
                      Approx(trace.at(std::to_string(k)).at("mu").at(j).get<double>()).margin(tolerance).epsilon(0));
        });
}
