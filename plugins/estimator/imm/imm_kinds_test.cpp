// Models that are filters of other kinds, and of other sizes.
#include "../../../tests/support/estimator_under_test.hpp"

#include <catch2/catch.hpp>
#include <memory>

#include <Eigen/Core>

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

struct Model {
    std::string estimator;
    Values estimator_values;
    std::string motion;
    Values motion_values;
};

/// Filters by themselves and side by side, with one position sensor.
struct Bank {
    Bank(const std::vector<Model>& list, const std::string& dimension)
        : sensor("sensor", "position", {{"dimension", dimension}}) {
        std::vector<Instance::Filled> parts;
        for (Model one : list) {
            one.motion_values["dimension"] = dimension;
            motions.push_back(std::make_unique<Instance>("motion", one.motion, one.motion_values));
            filters.push_back(std::make_unique<Instance>(
                "estimator", one.estimator, one.estimator_values,
                std::vector<Instance::Filled>{{"motion", "", motions.back().get()}, {"sensors", "radar", &sensor}}));
            single.emplace_back(*filters.back());
            parts.push_back({"estimators", "model_" + std::to_string(single.size()), filters.back().get()});
        }
        instance = std::make_unique<Instance>("estimator", "imm", Values{{"stay", "0.8"}}, parts);
        imm = std::make_unique<EstimatorUnderTest>(*instance);
    }
    /// A record started from these Cartesian components, all uncertain.
    Batch started(const EstimatorUnderTest& filter, const VectorXd& mean, const MatrixXd& covariance) const {
        Call call;
        const auto k = static_cast<std::int32_t>(mean.size());
        std::vector<std::int32_t> components;
        for (std::int32_t c = 0; c < k; ++c) components.push_back(c);
        Batch x(k, 1), p(k, k), record(filter.record_size(), 1);
        x[0] = mean;
        p[0] = covariance;
        finish(call, filter.init(call, components, x, p, record));
        return record;
    }
    Batch predicted(const EstimatorUnderTest& filter, const Batch& record, double dt) const {
        Call call;
        Batch out(filter.record_size(), 1);
        finish(call, filter.predict(call, pelorus::const_view(&dt, 1, 1, 1), record, out));
        return out;
    }
    Batch updated(const EstimatorUnderTest& filter, const Batch& record, const VectorXd& z, const MatrixXd& noise,
                  EstimatorUnderTest::Told& told) const {
        Call call;
        Batch measured(z.size(), 1), out(filter.record_size(), 1);
        measured[0] = z;
        finish(call, filter.update(call, 0, record, measured, pelorus::const_view(noise.data(), z.size(), z.size(), 1),
                                   out, told));
        return out;
    }
    std::pair<VectorXd, MatrixXd> moments(const EstimatorUnderTest& filter, const Batch& record) const {
        Call call;
        Batch mean(filter.n(), 1), covariance(filter.n(), filter.n());
        finish(call, filter.moments(call, record, mean, covariance));
        return {mean[0], covariance[0]};
    }
    VectorXd probabilities(const Batch& record) const {
        const auto& modes = *imm->part().extension<plr_estimator_modes>(PLR_ESTIMATOR_MODES);
        Call call;
        Batch out(modes.mode_count, 1);
        const plr_const_view from = record.in();
        const plr_view to = out.out();
        finish(call, modes.probabilities(imm->part().self(), &static_cast<const plr_call&>(call), &from, &to));
        return out[0];
    }
    static void finish(const Call& call, plr_status status) {
        if (status != PLR_OK) throw std::runtime_error(call.message());
    }

    Instance sensor;
    std::vector<std::unique_ptr<Instance>> motions, filters;
    std::vector<EstimatorUnderTest> single;
    std::unique_ptr<Instance> instance;
    std::unique_ptr<EstimatorUnderTest> imm;
};

const Values quiet{{"noise", "0.01"}}, lively{{"noise", "5"}};

double difference(const MatrixXd& a, const MatrixXd& b) {
    return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

}  // namespace

TEST_CASE("imm: filters of every kind take part, and where all is linear they are Kalman filters", "[imm]") {
    const Bank kalman({{"kalman", {}, "constant_velocity", quiet}, {"kalman", {}, "constant_velocity", lively}}, "2");
    const Model others[] = {{"cubature", {}, "constant_velocity", quiet},
                            {"cubature", {{"form", "covariance"}}, "constant_velocity", quiet},
                            {"unscented", {}, "constant_velocity", quiet},
                            {"gauss_hermite", {}, "constant_velocity", quiet},
                            {"kalman", {{"form", "square_root"}}, "constant_velocity", quiet}};
    for (const Model& other : others) {
        CAPTURE(other.estimator);
        const Bank bank({other, {"kalman", {}, "constant_velocity", lively}}, "2");
        const VectorXd start = (VectorXd(4) << 100.0, 200.0, 10.0, -5.0).finished();
        const MatrixXd spread = Eigen::Vector4d(25.0, 25.0, 4.0, 4.0).asDiagonal(), noise = MatrixXd::Identity(2, 2);
        Batch expected = kalman.started(*kalman.imm, start, spread), got = bank.started(*bank.imm, start, spread);
        for (int k = 1; k <= 10; ++k) {
            const Eigen::Vector2d z(100.0 + 10.0 * k + 0.2 * k * k, 200.0 - 5.0 * k);
            EstimatorUnderTest::Told told(2, 1), wanted(2, 1);
            expected = kalman.updated(*kalman.imm, kalman.predicted(*kalman.imm, expected, 1.0), z, noise, wanted);
            got = bank.updated(*bank.imm, bank.predicted(*bank.imm, got, 1.0), z, noise, told);
            CHECK((bank.probabilities(got) - kalman.probabilities(expected)).norm() < 1e-9);
            CHECK(told.log_likelihood[0](0) == Approx(wanted.log_likelihood[0](0)).epsilon(1e-9));
            const auto [x, p] = bank.moments(*bank.imm, got);
            const auto [y, q] = kalman.moments(*kalman.imm, expected);
            CHECK(difference(x, y) < 1e-9);
            CHECK(difference(p, q) < 1e-9);
        }
    }
}

TEST_CASE("imm: models of 4 and 6, of 6 and 9 components, and one with a turn rate work together", "[imm]") {
    struct Case {
        std::vector<Model> models;
        const char* dimension;
        std::int64_t n;
    };
    const Case cases[] = {
        {{{"cubature", {}, "constant_velocity", quiet}, {"kalman", {}, "constant_acceleration", {}}}, "2", 6},
        {{{"kalman", {{"form", "square_root"}}, "constant_velocity", quiet},
          {"unscented", {}, "constant_acceleration", {}}},
         "3",
         9},
        {{{"kalman", {}, "constant_velocity", quiet}, {"cubature", {}, "coordinated_turn", {}}}, "3", 7},
        {{{"cubature", {}, "constant_velocity", quiet},
          {"cubature", {}, "constant_acceleration", {}},
          {"unscented", {}, "coordinated_turn", {}}},
         "2",
         7}};
    for (const Case& one : cases) {
        CAPTURE(one.dimension, one.n, one.models.size());
        const Bank bank(one.models, one.dimension);
        REQUIRE(bank.imm->n() == one.n);
        const std::int64_t axes = one.dimension == std::string("2") ? 2 : 3;
        VectorXd start(2 * axes);
        start << VectorXd::Constant(axes, 1000.0), VectorXd::Constant(axes, 20.0);
        MatrixXd spread = 25.0 * MatrixXd::Identity(2 * axes, 2 * axes);
        Batch record = bank.started(*bank.imm, start, spread);
        const MatrixXd noise = MatrixXd::Identity(axes, axes);
        for (int k = 1; k <= 20; ++k) {
            EstimatorUnderTest::Told told(axes, 1);
            record = bank.updated(*bank.imm, bank.predicted(*bank.imm, record, 1.0),
                                  VectorXd::Constant(axes, 1000.0 + 20.0 * k), noise, told);
        }
        const auto [x, p] = bank.moments(*bank.imm, record);
        CHECK(bank.probabilities(record).sum() == Approx(1.0));
        CHECK((x.head(axes) - VectorXd::Constant(axes, 1400.0)).norm() < 1.0);
        CHECK((x.segment(axes, axes) - VectorXd::Constant(axes, 20.0)).norm() < 1.0);
        CHECK(p.diagonal().minCoeff() > 0.0);
        CHECK(p(0, 0) < 1.0);
    }
}

TEST_CASE("imm: a turn rate that a model has not enters the mixture with its prior mean and deviation", "[imm]") {
    const Bank bank(
        {{"kalman", {}, "constant_velocity", quiet}, {"kalman", {}, "coordinated_turn", {{"prior_turn_rate", "0.2"}}}},
        "2");
    REQUIRE(bank.imm->n() == 5);
    const VectorXd start = (VectorXd(4) << 100.0, 200.0, 10.0, -5.0).finished();
    const MatrixXd spread = Eigen::Vector4d(25.0, 25.0, 4.0, 4.0).asDiagonal();
    Batch record = bank.started(*bank.imm, start, spread);
    // The turn model has learned a rate of 0.1, to 0.05, with the velocity's x; the record is [2 probabilities, 4 + 16, 5 + 25].
    const auto turn = 2 + bank.single[0].record_size();
    record[0](0) = 0.7;
    record[0](1) = 0.3;
    Eigen::Map<MatrixXd> covariance(record[0].data() + turn + 5, 5, 5);
    record[0](turn + 4) = 0.1;
    covariance(4, 4) = 0.0025;
    covariance(4, 2) = covariance(2, 4) = 0.03;

    const auto [x, p] = bank.moments(*bank.imm, record);
    CHECK(x(4) == Approx(0.3 * 0.1));
    CHECK(p(4, 4) == Approx(0.7 * 0.04 + 0.3 * 0.0025 + 0.7 * 0.3 * 0.1 * 0.1));
    CHECK(p(2, 4) == Approx(0.3 * 0.03));

    // The step: the turn model starts from the mixture with the weights of those that come to it.
    const double come = 0.2 * 0.7, stay = 0.8 * 0.3, whole = come + stay, w = come / whole;
    Batch mean(5, 1), mixed(5, 5), own(bank.single[1].record_size(), 1);
    mean[0] << start, (1.0 - w) * 0.1;
    mixed[0].setZero();
    mixed[0].topLeftCorner(4, 4) = spread;
    mixed[0](4, 4) = w * 0.04 + (1.0 - w) * 0.0025 + w * (1.0 - w) * 0.01;
    mixed[0](2, 4) = mixed[0](4, 2) = (1.0 - w) * 0.03;
    own[0] = record[0].bottomRows(own.rows);
    Call call;
    REQUIRE(bank.single[1].assign(call, own, mean, mixed, own) == PLR_OK);
    own = bank.predicted(bank.single[1], own, 1.0);
    Batch after = bank.predicted(*bank.imm, record, 1.0);
    CHECK(bank.probabilities(after)(1) == Approx(whole));
    CHECK(difference(after[0].bottomRows(own.rows), own[0]) < 1e-13);
}
