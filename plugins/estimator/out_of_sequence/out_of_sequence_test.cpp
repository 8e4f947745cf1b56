#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include <Eigen/Dense>

#include "../../../tests/support/estimator_under_test.hpp"

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// A filter with two sensors, by itself and inside estimator.out_of_sequence.
struct Filters {
    explicit Filters(bool has_two_models, const Values& with = {})
        : plots("sensor", "position"), radar("sensor", "spherical") {
        motions.push_back(std::make_unique<Instance>("motion", "constant_velocity", Values{{"noise", "0.5"}}));
        motions.push_back(std::make_unique<Instance>("motion", "singer", Values{{"acceleration", "2"}}));
        std::vector<Instance::Filled> models;
        for (std::size_t k = 0; k < 2; ++k) {
            kalman.push_back(std::make_unique<Instance>(
                "estimator", "kalman", Values{},
                std::vector<Instance::Filled>{
                    {"motion", "", motions[k].get()}, {"sensors", "plots", &plots}, {"sensors", "radar", &radar}}));
            models.push_back({"estimators", "model_" + std::to_string(k), kalman.back().get()});
        }
        imm = std::make_unique<Instance>("estimator", "imm", Values{}, models);
        const Instance& inner = has_two_models ? *imm : *kalman[0];
        wrapped = std::make_unique<Instance>("estimator", "out_of_sequence", with,
                                             std::vector<Instance::Filled>{{"estimator", "", &inner}});
        plain = std::make_unique<EstimatorUnderTest>(inner);
        late = std::make_unique<EstimatorUnderTest>(*wrapped);
    }
    Instance plots, radar;
    std::vector<std::unique_ptr<Instance>> motions, kalman;
    std::unique_ptr<Instance> imm, wrapped;
    std::unique_ptr<EstimatorUnderTest> plain, late;
};

struct Measurement {
    double time;
    std::int32_t sensor;
    VectorXd value;
    MatrixXd noise;
};

/// Of an object that flies past at 100 m/s, at uneven times, by both sensors in turn.
std::vector<Measurement> flight(int count) {
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    std::vector<Measurement> all;
    double time = 0;
    for (int k = 0; k < count; ++k) {
        time += 0.5 + 0.25 * (k % 5);
        Eigen::Vector3d place(2e3 + 80 * time, 5e3 - 60 * time + 0.5 * time * time, 800 + 5 * time);
        for (int a = 0; a < 3; ++a) place(a) += 5 * normal(random);
        if (k % 2 == 0) {
            all.push_back({time, 0, place, 25 * MatrixXd::Identity(3, 3)});
        } else {
            const double ground = place.head(2).norm();
            const Eigen::Vector3d seen(place.norm(), std::atan2(place(1), place(0)), std::atan2(place(2), ground));
            all.push_back({time, 1, seen, Eigen::Vector3d(25, 1e-6, 1e-6).asDiagonal()});
        }
    }
    return all;
}

Batch started(const EstimatorUnderTest& filter) {
    Call call;
    Batch x(3, 1), p(3, 3), record(filter.record_size(), 1);
    x[0] = Eigen::Vector3d(2e3, 5e3, 800);
    p[0] = 1e4 * MatrixXd::Identity(3, 3);
    REQUIRE(filter.init(call, {0, 1, 2}, x, p, record) == PLR_OK);
    return record;
}
plr_status try_predict(const EstimatorUnderTest& filter, Batch& record, double dt, std::string* message = nullptr) {
    Call call;
    Batch out = record;
    const plr_status status = filter.predict(call, pelorus::const_view(&dt, 1, 1, 1), record, out);
    if (message != nullptr) *message = call.message();
    if (status == PLR_OK) record = out;
    return status;
}
void predict(const EstimatorUnderTest& filter, Batch& record, double dt) {
    REQUIRE(try_predict(filter, record, dt) == PLR_OK);
}
double update(const EstimatorUnderTest& filter, Batch& record, const Measurement& one) {
    Call call;
    Batch z(3, 1), out(filter.record_size(), 1);
    z[0] = one.value;
    EstimatorUnderTest::Told told(3, 1);
    REQUIRE(filter.update(call, one.sensor, record, z, pelorus::const_view(one.noise.data(), 3, 3, 1), out, told) ==
            PLR_OK);
    record = out;
    return told.log_likelihood[0](0);
}
/// A measurement whenever it comes: back to its time, and forward again.
void take(const EstimatorUnderTest& filter, Batch& record, double& newest, const Measurement& one) {
    predict(filter, record, one.time - newest);
    update(filter, record, one);
    if (one.time < newest) predict(filter, record, newest - one.time);
    newest = std::max(newest, one.time);
}
Batch in_sequence(const EstimatorUnderTest& filter, const std::vector<Measurement>& all, double until) {
    Batch record = started(filter);
    double time = 0;
    for (const Measurement& one : all) {
        if (one.time > until) break;
        take(filter, record, time, one);
    }
    if (time < until) predict(filter, record, until - time);
    return record;
}
struct Moments {
    VectorXd mean;
    MatrixXd covariance;
};
Moments moments(const EstimatorUnderTest& filter, const Batch& record) {
    Call call;
    Batch mean(filter.n(), 1), covariance(filter.n(), filter.n());
    REQUIRE(filter.moments(call, record, mean, covariance) == PLR_OK);
    return {mean[0], covariance[0]};
}
double difference(const Moments& a, const Moments& b) {
    const VectorXd scale = b.covariance.diagonal().cwiseSqrt().cwiseInverse();
    return scale.cwiseProduct(a.mean - b.mean).norm() +
           (scale.asDiagonal() * (a.covariance - b.covariance) * scale.asDiagonal()).norm();
}
/// Each at most `reach` places away from where it belongs.
std::vector<Measurement> shuffled(std::vector<Measurement> all, std::size_t reach) {
    std::mt19937_64 random(8);
    for (std::size_t first = 0; first < all.size(); first += reach)
        std::shuffle(all.begin() + static_cast<std::ptrdiff_t>(first),
                     all.begin() + static_cast<std::ptrdiff_t>(std::min(first + reach, all.size())), random);
    return all;
}

}  // namespace

TEST_CASE("out_of_sequence: shuffled measurements give the track that sorted ones give", "[out_of_sequence]") {
    for (const bool has_two_models : {false, true}) {
        CAPTURE(has_two_models);
        const Filters filters(has_two_models);
        const auto sorted = flight(60);
        const auto mixed_up = shuffled(sorted, 6);
        Batch record = started(*filters.late);
        double newest = 0;
        int late = 0;
        for (const Measurement& one : mixed_up) {
            late += one.time < newest ? 1 : 0;
            take(*filters.late, record, newest, one);
        }
        CHECK(late > 25);
        const Batch expected = in_sequence(*filters.plain, sorted, sorted.back().time);
        CHECK(difference(moments(*filters.late, record), moments(*filters.plain, expected)) < 1e-9);
        // What is left unsorted is another track, by far more than that.
        Batch naive = started(*filters.plain);
        newest = 0;
        for (const Measurement& one : mixed_up) take(*filters.plain, naive, newest, one);
        CHECK(difference(moments(*filters.plain, naive), moments(*filters.plain, expected)) > 0.1);
    }
}

TEST_CASE("out_of_sequence: in sequence it is its filter, bit for bit", "[out_of_sequence]") {
    const Filters filters(true);
    const auto all = flight(40);
    Batch own = started(*filters.late), inner = started(*filters.plain);
    double time = 0;
    for (const Measurement& one : all) {
        predict(*filters.late, own, one.time - time);
        predict(*filters.plain, inner, one.time - time);
        CHECK(update(*filters.late, own, one) == update(*filters.plain, inner, one));
        time = one.time;
    }
    CHECK(moments(*filters.late, own).mean == moments(*filters.plain, inner).mean);
    CHECK(moments(*filters.late, own).covariance == moments(*filters.plain, inner).covariance);
    const auto& modes = *filters.late->part().extension<plr_estimator_modes>(PLR_ESTIMATOR_MODES);
    const auto& of_inner = *filters.plain->part().extension<plr_estimator_modes>(PLR_ESTIMATOR_MODES);
    Call call;
    Batch told(2, 1), expected(2, 1);
    const plr_const_view from = own.in(), from_inner = inner.in();
    const plr_view to = told.out(), to_expected = expected.out();
    const plr_call& context = call;
    REQUIRE(modes.probabilities(filters.late->part().self(), &context, &from, &to) == PLR_OK);
    REQUIRE(of_inner.probabilities(filters.plain->part().self(), &context, &from_inner, &to_expected) == PLR_OK);
    CHECK(told[0] == expected[0]);
    CHECK(told[0].sum() == Approx(1));
}

TEST_CASE("out_of_sequence: gone back to a time it tells the state of that time, unsmoothed", "[out_of_sequence]") {
    const Filters filters(false);
    const auto all = flight(12);
    Batch record = in_sequence(*filters.late, all, all.back().time);
    const Moments newest = moments(*filters.late, record);
    double at = all.back().time;
    for (const double time : {all[8].time, all[6].time + 0.1, all[9].time - 0.1, all[10].time}) {
        predict(*filters.late, record, time - at);
        at = time;
        CHECK(difference(moments(*filters.late, record),
                         moments(*filters.plain, in_sequence(*filters.plain, all, time))) < 1e-9);
    }
    predict(*filters.late, record, all.back().time - at);
    CHECK(difference(moments(*filters.late, record), newest) < 1e-12);
    predict(*filters.late, record, -2.0);
    predict(*filters.late, record, 5.0);  // beyond the newest time at once
    CHECK(difference(moments(*filters.late, record),
                     moments(*filters.plain, in_sequence(*filters.plain, all, all.back().time + 3))) < 1e-9);
}

TEST_CASE("out_of_sequence: what is later than its bounds fails, for its item alone", "[out_of_sequence]") {
    const auto all = flight(12);
    std::string message;
    {
        const Filters filters(false, {{"maximum_lag", "2.5"}});
        Batch record = in_sequence(*filters.late, all, all.back().time);
        CHECK(try_predict(*filters.late, record, -2.6, &message) == PLR_ITEMS_FAILED);
        CHECK(message == "2.600000 s before the newest time of the track, expected at most 2.500000 s (maximum_lag)");
        CHECK(try_predict(*filters.late, record, -2.4) == PLR_OK);
        CHECK(try_predict(*filters.late, record, -0.2) == PLR_ITEMS_FAILED);  // counted from the newest time
    }
    const Filters filters(false, {{"depth", "3"}});
    Batch record = in_sequence(*filters.late, all, all.back().time);
    const double newest = all.back().time, oldest = all[8].time;  // that the fourth measurement from the end led to
    CHECK(try_predict(*filters.late, record, oldest - newest - 0.01, &message) == PLR_ITEMS_FAILED);
    CHECK_THAT(message, Catch::Contains("what was earlier is forgotten (depth)"));
    CHECK(try_predict(*filters.late, record, oldest - newest + 0.01) == PLR_OK);

    Batch three(filters.late->record_size(), 1, 3), out(filters.late->record_size(), 1, 3);
    for (int i = 0; i < 3; ++i) three[i] = in_sequence(*filters.late, all, all.back().time)[0];
    const double steps[] = {1.0, -1e3, -0.1};
    Call call(3);
    REQUIRE(filters.late->predict(call, pelorus::const_view(steps, 1, 1, 3), three, out) == PLR_ITEMS_FAILED);
    CHECK(call.status(0) == PLR_OK);
    CHECK(call.status(1) == PLR_E_NUMERIC);
    CHECK(call.status(2) == PLR_OK);
}

TEST_CASE("out_of_sequence: a late measurement is exact although older ones are forgotten", "[out_of_sequence]") {
    const Filters filters(false, {{"depth", "4"}});
    const auto sorted = flight(50);
    auto swapped = sorted;
    for (std::size_t k = 1; k + 2 < swapped.size(); k += 3) std::swap(swapped[k], swapped[k + 2]);
    Batch record = started(*filters.late);
    double newest = 0;
    for (const Measurement& one : swapped) take(*filters.late, record, newest, one);
    const Batch expected = in_sequence(*filters.plain, sorted, sorted.back().time);
    CHECK(difference(moments(*filters.late, record), moments(*filters.plain, expected)) < 1e-9);
}
