#include "../../../tests/support/estimator_under_test.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include <Eigen/Dense>

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

struct Motion {
    std::string name;
    Values values;
};
Motion singer(const std::string& acceleration) {
    return {"singer", {{"maneuver_rate", "0.1"}, {"acceleration", acceleration}, {"prior_acceleration", "0.5"}}};
}
const Motion straight{"constant_velocity", {{"noise", "0.01"}}};

/// Kalman filters, one a motion, by themselves and side by side.
struct Models {
    explicit Models(const std::vector<Motion>& list, const std::string& stay = "0.9", const std::string& warm_up = "")
        : sensor("sensor", "position") {
        std::vector<Instance::Filled> parts;
        for (const Motion& one : list) {
            motions.push_back(std::make_unique<Instance>("motion", one.name, one.values));
            kalman.push_back(std::make_unique<Instance>(
                "estimator", "kalman", Values{},
                std::vector<Instance::Filled>{{"motion", "", motions.back().get()}, {"sensors", "radar", &sensor}}));
            single.emplace_back(*kalman.back());
            parts.push_back({"estimators", "model_" + std::to_string(single.size()), kalman.back().get()});
        }
        Values values{{"stay", stay}};
        if (!warm_up.empty()) values["warm_up"] = warm_up;
        instance = std::make_unique<Instance>("estimator", "imm", values, parts);
        imm = std::make_unique<EstimatorUnderTest>(*instance);
    }
    VectorXd probabilities(const Batch& record) const {
        const auto& modes = *imm->part().extension<plr_estimator_modes>(PLR_ESTIMATOR_MODES);
        Call call;
        Batch out(modes.mode_count, 1);
        const plr_const_view from = record.in();
        const plr_view to = out.out();
        REQUIRE(modes.probabilities(imm->part().self(), &static_cast<const plr_call&>(call), &from, &to) == PLR_OK);
        return out[0];
    }

    Instance sensor;
    std::vector<std::unique_ptr<Instance>> motions, kalman;
    std::vector<EstimatorUnderTest> single;
    std::unique_ptr<Instance> instance;
    std::unique_ptr<EstimatorUnderTest> imm;
};

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
Batch predicted(const EstimatorUnderTest& filter, const Batch& record, double dt) {
    Call call;
    Batch out(filter.record_size(), 1);
    REQUIRE(filter.predict(call, pelorus::const_view(&dt, 1, 1, 1), record, out) == PLR_OK);
    CHECK(call.scratch_used() == 0);
    return out;
}
Batch updated(const EstimatorUnderTest& filter, const Batch& record, const VectorXd& z, const MatrixXd& noise,
              EstimatorUnderTest::Told& told) {
    Call call;
    Batch measured(3, 1), out(filter.record_size(), 1);
    measured[0] = z;
    REQUIRE(filter.update(call, 0, record, measured, pelorus::const_view(noise.data(), 3, 3, 1), out, told) == PLR_OK);
    return out;
}
Moments mixed(const std::vector<Moments>& parts, const VectorXd& weights) {
    Moments out{0 * parts[0].mean, 0 * parts[0].covariance};
    for (std::size_t j = 0; j < parts.size(); ++j) out.mean += weights(static_cast<Eigen::Index>(j)) * parts[j].mean;
    for (std::size_t j = 0; j < parts.size(); ++j) {
        const VectorXd apart = parts[j].mean - out.mean;
        out.covariance += weights(static_cast<Eigen::Index>(j)) * (parts[j].covariance + apart * apart.transpose());
    }
    return out;
}
double difference(const Moments& a, const Moments& b) {
    return (a.mean - b.mean).norm() / b.mean.norm() + (a.covariance - b.covariance).norm() / b.covariance.norm();
}
/// A record started from all components.
Batch started(const EstimatorUnderTest& filter, const VectorXd& mean, const MatrixXd& covariance) {
    Call call;
    const std::int64_t c = filter.c();
    Batch x(c, 1), p(c, c), record(filter.record_size(), 1);
    x[0] = mean.head(c);
    p[0] = covariance.topLeftCorner(c, c);
    std::vector<std::int32_t> all;
    for (std::int32_t k = 0; k < c; ++k) all.push_back(k);
    REQUIRE(filter.init(call, all, x, p, record) == PLR_OK);
    return record;
}
const MatrixXd spread = VectorXd(Eigen::VectorXd::LinSpaced(9, 9, 1)).asDiagonal();
VectorXd place() {
    VectorXd x(9);
    x << 100, 200, 300, 20, -5, 1, 0.1, 0.2, -0.1;
    return x;
}

}  // namespace

TEST_CASE("imm: its step is Blom and Bar-Shalom's, computed from the single filters", "[imm]") {
    const Models m({singer("0.01"), singer("1"), singer("5")}, "0.9");
    std::vector<Batch> single;
    for (const auto& filter : m.single) single.push_back(started(filter, place(), spread));
    Batch record = started(*m.imm, place(), spread);
    VectorXd mu = VectorXd::Constant(3, 1.0 / 3);
    MatrixXd transition = MatrixXd::Constant(3, 3, 0.05);
    transition.diagonal().setConstant(0.9);
    const MatrixXd noise = 4 * MatrixXd::Identity(3, 3);
    std::mt19937_64 engine(1);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 8; ++k) {
        std::vector<Moments> before;
        for (std::size_t j = 0; j < 3; ++j) before.push_back(moments(m.single[j], single[j]));
        const VectorXd c = transition.transpose() * mu;
        VectorXd likelihood(3);
        const VectorXd z = place().head(3) + 20.0 * (k + 1) * VectorXd::Unit(3, 0) +
                           VectorXd(VectorXd::NullaryExpr(3, [&] { return 8 * normal(engine); }));
        std::vector<Moments> seen, after;
        for (Eigen::Index j = 0; j < 3; ++j) {
            const auto at = static_cast<std::size_t>(j);
            const VectorXd weights = transition.col(j).cwiseProduct(mu) / c(j);
            const Moments start = mixed(before, weights);
            Call call;
            Batch x(9, 1), p(9, 9);
            x[0] = start.mean;
            p[0] = start.covariance;
            REQUIRE(m.single[at].assign(call, single[at], x, p, single[at]) == PLR_OK);
            single[at] = predicted(m.single[at], single[at], 1);
            EstimatorUnderTest::Told told(3, 1);
            const Moments now = moments(m.single[at], single[at]);
            seen.push_back({now.mean.head(3), now.covariance.topLeftCorner(3, 3)});
            single[at] = updated(m.single[at], single[at], z, noise, told);
            likelihood(j) = std::exp(told.log_likelihood[0](0));
            after.push_back(moments(m.single[at], single[at]));
        }
        record = predicted(*m.imm, record, 1);
        CHECK((m.probabilities(record) - c).norm() < 1e-12);
        const Moments look = mixed(seen, c);
        EstimatorUnderTest::Told told(3, 1);
        record = updated(*m.imm, record, z, noise, told);
        CHECK((told.innovation[0] - (z - look.mean)).norm() < 1e-9);
        CHECK((told.covariance[0] - (look.covariance + noise)).norm() < 1e-9 * look.covariance.norm());
        CHECK(told.log_likelihood[0](0) == Approx(std::log(c.dot(likelihood))).epsilon(1e-10));
        mu = c.cwiseProduct(likelihood) / c.dot(likelihood);
        CHECK((m.probabilities(record) - mu).norm() < 1e-10);
        CHECK(difference(moments(*m.imm, record), mixed(after, mu)) < 1e-10);
    }
}

TEST_CASE("imm: cross-covariances are those of the mixture", "[imm]") {
    const Models m({singer("0.01"), singer("5")});
    Batch record = predicted(*m.imm, started(*m.imm, place(), spread), 1);
    EstimatorUnderTest::Told told(3, 1);
    record = updated(*m.imm, record, place().head(3) + VectorXd::Constant(3, 9), MatrixXd::Identity(3, 3), told);
    record = predicted(*m.imm, record, 2);
    Call call;
    Batch z(3, 1), s(3, 3), cross(9, 3), cartesian(9, 3);
    REQUIRE(m.imm->project(call, 0, record, z, s, cross, &cartesian) == PLR_OK);
    const Moments now = moments(*m.imm, record);
    CHECK((z[0] - now.mean.head(3)).norm() < 1e-9);
    CHECK((s[0] - now.covariance.topLeftCorner(3, 3)).norm() < 1e-9 * s[0].norm());
    CHECK((cross[0] - now.covariance.leftCols(3)).norm() < 1e-9 * cross[0].norm());
    CHECK(cartesian[0] == cross[0]);
}

TEST_CASE("imm: the probabilities of the models do not depend on how a time is cut into steps", "[imm]") {
    const Models m({singer("0.01"), singer("1")}, "0.95");
    Batch record = started(*m.imm, place(), spread);
    record[0](0) = 0.99;
    record[0](1) = 0.01;
    const VectorXd whole = m.probabilities(predicted(*m.imm, record, 3));
    Batch cut = record;
    for (const double dt : {0.25, 1.5, 0.5, 0.75}) cut = predicted(*m.imm, cut, dt);
    CHECK((m.probabilities(cut) - whole).norm() < 1e-12);
    CHECK((m.probabilities(predicted(*m.imm, record, 1)) - Eigen::Vector2d(0.941, 0.059)).norm() < 1e-12);
    CHECK(m.probabilities(predicted(*m.imm, record, 0)) == m.probabilities(record));
}

TEST_CASE("imm: a warm-up is the first filter alone, which the others then start from, without it", "[imm]") {
    const Models m({singer("5"), singer("0.01"), singer("1")}, "0.9", "2.5 s");
    const EstimatorUnderTest& first = m.single[0];
    Batch record = started(*m.imm, place(), spread), alone = started(first, place(), spread);
    const MatrixXd noise = 4 * MatrixXd::Identity(3, 3);
    const auto step = [&](const EstimatorUnderTest& filter, const Batch& from, int k) {
        EstimatorUnderTest::Told told(3, 1);
        return updated(filter, predicted(filter, from, 1), place().head(3) + 20.0 * k * VectorXd::Unit(3, 0), noise,
                       told);
    };
    for (int k = 1; k <= 3; ++k) {
        record = step(*m.imm, record, k);
        alone = step(first, alone, k);
        CHECK(difference(moments(*m.imm, record), moments(first, alone)) < 1e-12);
        CHECK(m.probabilities(record) == VectorXd(VectorXd::Unit(3, 0)));
    }
    // What an interacting pair would do that starts where the first filter is.
    const Models pair({singer("0.01"), singer("1")}, "0.9");
    const Moments here = moments(first, alone);
    Batch other = started(*pair.imm, here.mean, here.covariance);
    for (int k = 4; k <= 6; ++k) {
        record = step(*m.imm, record, k);
        other = step(*pair.imm, other, k);
        CHECK(difference(moments(*m.imm, record), moments(*pair.imm, other)) < 1e-10);
        CHECK((m.probabilities(record).tail(2) - pair.probabilities(other)).norm() < 1e-10);
        CHECK(m.probabilities(record)(0) == 0);
    }
}

TEST_CASE("imm: models that take over from a warm-up are those that `stay` speaks of, and a filter alone goes on",
          "[imm]") {
    CHECK_THROWS_WITH(Models({straight, singer("1"), singer("2")}, "0.4", "2 s"), Catch::Contains("1/2"));
    CHECK_NOTHROW(Models({straight, singer("1")}, "0.1", "2 s"));  // nothing changes any more
    const Models m({singer("1")}, "0.9", "2 s");
    Batch record = started(*m.imm, place(), spread), alone = started(m.single[0], place(), spread);
    for (int k = 0; k < 4; ++k) {
        record = predicted(*m.imm, record, 1);
        alone = predicted(m.single[0], alone, 1);
    }
    CHECK(difference(moments(*m.imm, record), moments(m.single[0], alone)) < 1e-14);
}

TEST_CASE("imm: models of other components meet by name, and a missing one enters with its prior", "[imm]") {
    const Models m({straight, singer("1")});
    REQUIRE(m.imm->n() == 9);
    CHECK((m.imm->info().flags & PLR_ESTIMATOR_ASSIGNABLE) == 0);
    CHECK(m.imm->part().table().assign == nullptr);
    const Batch record = started(*m.imm, place(), spread);
    const Moments now = moments(*m.imm, record);
    CHECK((now.mean.head(6) - place().head(6)).norm() < 1e-12);
    CHECK((now.mean.tail(3) - 0.5 * place().tail(3)).norm() < 1e-12);  // one model knows it, the other takes 0
    for (int k = 6; k < 9; ++k)
        CHECK(now.covariance(k, k) ==
              Approx(0.5 * (spread(k, k) + 0.25) + 0.25 * place()(k) * place()(k)));  // 0.25: the prior of Singer's
    // The straight model starts the step from the mixture without the accelerations.
    const Batch after = predicted(*m.imm, record, 1);
    EstimatorUnderTest::Told told(3, 1);
    const Batch seen = updated(*m.imm, after, place().head(3) + place().segment(3, 3), MatrixXd::Identity(3, 3), told);
    CHECK(m.probabilities(seen).sum() == Approx(1));
    CHECK(moments(*m.imm, seen).covariance.allFinite());
}

TEST_CASE("imm: a manoeuvre is noticed, and its end", "[imm]") {
    const Models m({singer("0.01"), singer("5")}, "0.95");
    VectorXd start = place();
    start.tail(3).setZero();
    MatrixXd known = MatrixXd::Zero(9, 9);
    known.diagonal() << VectorXd::Constant(3, 1), VectorXd::Constant(3, 0.1), VectorXd::Constant(3, 0.01);
    Batch record = started(*m.imm, start, known);
    Eigen::Vector3d position = start.head(3), velocity = start.segment(3, 3);
    std::mt19937_64 engine(2);
    std::normal_distribution<double> normal;
    std::vector<double> quiet;
    for (int k = 0; k < 90; ++k) {
        const Eigen::Vector3d acceleration = k >= 30 && k < 45 ? Eigen::Vector3d(0, 6, 0) : Eigen::Vector3d(0, 0, 0);
        position += velocity + 0.5 * acceleration;
        velocity += acceleration;
        record = predicted(*m.imm, record, 1);
        EstimatorUnderTest::Told told(3, 1);
        const VectorXd z = position + Eigen::Vector3d(Eigen::Vector3d::NullaryExpr([&] { return normal(engine); }));
        record = updated(*m.imm, record, z, MatrixXd::Identity(3, 3), told);
        quiet.push_back(m.probabilities(record)(0));
    }
    CHECK(quiet[29] > 0.9);
    // Once the acceleration is known and steady, quiet flight from there explains it nearly as well.
    CHECK(*std::min_element(quiet.begin() + 30, quiet.begin() + 33) < 0.01);
    CHECK(quiet[89] > 0.9);
    CHECK((moments(*m.imm, record).mean.head(3) - VectorXd(position)).norm() < 3);
}

TEST_CASE("imm: its covariance tells its errors where the target changes as it believes", "[imm]") {
    // Truth drawn from the filter's own chain of models.
    const Models m({singer("0.05"), singer("2")}, "0.95");
    constexpr int runs = 150, steps = 60;
    std::mt19937_64 engine(4);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    std::vector<Eigen::Matrix3d> factor;
    Eigen::Matrix3d transition;
    for (const auto& motion : m.motions) {
        const auto part = motion->as<pelorus::MotionPart>();
        const auto& blocks = *part.extension<plr_motion_structure>(PLR_MOTION_STRUCTURE);
        Eigen::Matrix3d q;
        Call call;
        REQUIRE(blocks.blocks(part.self(), &static_cast<const plr_call&>(call), 1, transition.data(), q.data()) ==
                PLR_OK);
        factor.push_back(q.llt().matrixL());
    }
    double nees = 0, nis = 0;
    for (int run = 0; run < runs; ++run) {
        Eigen::Matrix3d truth = Eigen::Map<const Eigen::Matrix3d>(place().data());  // axes x derivatives
        Eigen::Matrix3d error;
        for (int k = 0; k < 9; ++k) error.data()[k] = std::sqrt(spread(k, k)) * normal(engine);
        Batch record = started(*m.imm, VectorXd(place() + Eigen::Map<VectorXd>(error.data(), 9)), spread);
        std::size_t mode = uniform(engine) < 0.5 ? 0 : 1;
        EstimatorUnderTest::Told told(3, 1);
        for (int k = 0; k < steps; ++k) {
            if (uniform(engine) > 0.95) mode = 1 - mode;
            const Eigen::Matrix3d unit = Eigen::Matrix3d::NullaryExpr([&] { return normal(engine); });
            truth = truth * transition.transpose() + unit * factor[mode].transpose();
            record = predicted(*m.imm, record, 1);
            const VectorXd z =
                truth.col(0) + Eigen::Vector3d(Eigen::Vector3d::NullaryExpr([&] { return normal(engine); }));
            record = updated(*m.imm, record, z, MatrixXd::Identity(3, 3), told);
            const VectorXd e = told.innovation[0];
            nis += e.dot(told.covariance[0].inverse() * e) / (3.0 * runs * steps);
        }
        const Moments now = moments(*m.imm, record);
        const VectorXd off = now.mean - Eigen::Map<const VectorXd>(truth.data(), 9);
        nees += off.dot(now.covariance.inverse() * off) / (9.0 * runs);
    }
    // The mixture is no Gaussian: its tails are heavier than chi-square's, so bounds are wide.
    CHECK(nis == Approx(1).margin(0.1));
    CHECK(nees == Approx(1).margin(0.25));
}

TEST_CASE("imm: parts that do not go together are refused", "[imm]") {
    CHECK_THROWS_WITH(Models({singer("0.01"), singer("1")}, "0.4"),
                      "must be at least 1/2, which is leaving a model to chance");
    const Instance motion("motion", "constant_velocity"), plane("motion", "constant_velocity", {{"dimension", "2"}});
    const Instance radar("sensor", "position"), flat("sensor", "position", {{"dimension", "2"}});
    const Instance space("estimator", "kalman", {}, {{"motion", "", &motion}, {"sensors", "radar", &radar}});
    const Instance other("estimator", "kalman", {}, {{"motion", "", &plane}, {"sensors", "radar", &flat}});
    CHECK_THROWS_WITH(Instance("estimator", "imm", {}, {{"estimators", "a", &space}, {"estimators", "b", &other}}),
                      "b has other sensors than a; all filters take the same (radar measures position.x [m], "
                      "position.y [m], position.z [m])");
    const Instance logarithmic("motion", "log_spherical");
    const Instance strange("estimator", "kalman", {}, {{"motion", "", &logarithmic}, {"sensors", "radar", &radar}});
    CHECK_THROWS_WITH(Instance("estimator", "imm", {}, {{"estimators", "a", &space}, {"estimators", "b", &strange}}),
                      Catch::StartsWith("a has no component of its state (position.x [m], ") &&
                          Catch::EndsWith(") in common with another filter, so that there is nothing to mix"));
    const Instance wandering("motion", "random_walk"), angular("motion", "log_spherical");
    const Instance near("estimator", "kalman", {}, {{"motion", "", &wandering}, {"sensors", "radar", &radar}});
    const Instance far("estimator", "kalman", {}, {{"motion", "", &angular}, {"sensors", "radar", &radar}});
    CHECK_THROWS_WITH(Instance("estimator", "imm", {},
                               {{"estimators", "straight", &space},
                                {"estimators", "log", &strange},
                                {"estimators", "still", &near},
                                {"estimators", "angular", &far}}),
                      "are of two halves that have no component in common, so that nothing can be mixed between them: "
                      "straight, still and log, angular");
}
