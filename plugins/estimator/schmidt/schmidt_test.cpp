#include "../../../tests/support/estimator_under_test.hpp"

#include <cmath>
#include <random>

#include <catch2/catch.hpp>
#include <Eigen/Dense>

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// A row of the parameter `consider`; a negative element is absent.
struct Row {
    std::string input;
    int element;
    double deviation;
};

/// estimator.schmidt as a host makes it that tells of the inputs below it and of rows of `consider`.
class Told {
public:
    Told(const plr_description& sensor, const std::vector<Row>& rows) : real_(plugin("estimator", "schmidt")) {
        for (std::uint32_t i = 0; i < sensor.input_count; ++i) {
            names_.push_back(std::string("sensors.radar.") + sensor.inputs[i].name);
            add(sensor.inputs[i].size, sensor.inputs[i].unit, sensor.inputs[i].defaults);
        }
        names_.push_back("motion.wind");
        add(1, "m/s", &no_wind_);
        for (std::size_t i = 0; i < places_.size(); ++i) places_[i].name = names_[i].c_str();
        rows_ = rows;
        for (const Row& row : rows_) {
            const double element = row.element < 0 ? pelorus::not_a_number : row.element;
            numbers_.insert(numbers_.end(), {pelorus::not_a_number, element, row.deviation});
            texts_.insert(texts_.end(), {row.input.c_str(), nullptr, nullptr});
        }
        const auto count = static_cast<std::int64_t>(rows_.size());
        table_.struct_size = sizeof table_;
        table_.present = 1;
        table_.numbers = {numbers_.data(), count, 3, 1, 3, 1, 3 * count};
        table_.texts = texts_.data();
        description_ = *real_.description;
        description_.parameter_count = 0;  // told here
        plugin_ = real_;
        plugin_.description = &description_;
        plugin_.create = &create;
    }
    const plr_plugin& now() {
        telling = this;
        return plugin_;
    }
    std::size_t size() const { return static_cast<std::size_t>(size_); }

private:
    void add(std::uint32_t size, const char* unit, const double* defaults) {
        places_.push_back({sizeof(plr_input_place), size, nullptr, unit, size_, defaults});
        size_ += size;
    }
    static plr_status create(const plr_config* config, plr_instance* out, plr_error* error) {
        plr_config full = *config;
        full.values = &telling->table_;
        full.value_count = 1;
        full.inputs = telling->places_.data();
        full.input_count = static_cast<std::uint32_t>(telling->places_.size());
        full.input_size = telling->size_;
        return telling->real_.create(&full, out, error);
    }

    static Told* telling;
    const plr_plugin& real_;
    plr_plugin plugin_{};
    plr_description description_{};
    std::vector<std::string> names_;
    std::vector<plr_input_place> places_;
    std::vector<Row> rows_;
    std::vector<double> numbers_;
    std::vector<const char*> texts_;
    plr_value table_{};
    std::int64_t size_ = 0;
    double no_wind_ = 0.0;
};
Told* Told::telling = nullptr;

void done(const Call& call, plr_status status) {
    if (status != PLR_OK) throw std::runtime_error(call.message());
    if (call.scratch_used() != 0) throw std::runtime_error("scratch memory was not given back");
}

const double process_noise = 0.01;  // m2/s3
const Eigen::Vector3d noise_deviation(10.0, 1e-3, 1e-3), bias_deviation(20.0, 3e-3, 2e-3);
const MatrixXd noise = noise_deviation.cwiseAbs2().asDiagonal();
const VectorXd start = (VectorXd(6) << 5e3, 4e3, 1e3, 50.0, -30.0, 5.0).finished();
const MatrixXd spread = (VectorXd(6) << 1e4, 1e4, 1e4, 400.0, 400.0, 400.0).finished().asDiagonal().toDenseMatrix();

/// Constant velocity seen by a spherical radar; consider filter where rows are given, else estimator.kalman.
struct Tracking {
    explicit Tracking(const std::vector<Row>& rows)
        : told(*plugin("sensor", "spherical").description, rows),
          instance(told.now(), {}, {{"motion", "", &motion}, {"sensors", "radar", &sensor}}, 0),
          filter(instance) {}
    Tracking()
        : told(*plugin("sensor", "spherical").description, {}),
          instance("estimator", "kalman", {}, {{"motion", "", &motion}, {"sensors", "radar", &sensor}}),
          filter(instance) {}

    Batch started(std::int64_t count = 1) const {
        const Batch one = filter.record_of(start, spread);
        Batch out(filter.record_size(), 1, count);
        for (std::int64_t i = 0; i < count; ++i) std::copy(one.numbers.begin(), one.numbers.end(), out[i].data());
        return out;
    }
    void predict(double dt, Batch& record) const {
        Call call(record.count);
        done(call, filter.predict(call, pelorus::common_view(&dt, 1, 1, record.count), record, record));
    }
    EstimatorUnderTest::Told update(const Batch& z, Batch& record) const {
        Call call(record.count);
        EstimatorUnderTest::Told out(3, record.count);
        done(call,
             filter.update(call, 0, record, z, pelorus::common_view(noise.data(), 3, 3, record.count), record, out));
        return out;
    }
    std::pair<VectorXd, MatrixXd> moments(const Batch& records, std::int64_t i = 0) const {
        Call call(records.count);
        Batch x(6, 1, records.count), p(6, 6, records.count);
        done(call, filter.moments(call, records, x, p));
        return {x[i], p[i]};
    }
    /// X, the cross-covariance with the parameters in their deviations.
    MatrixXd cross(Batch& records, std::int64_t i = 0) const {
        return Eigen::Map<const MatrixXd>(records[i].data() + 42, 6, (records.rows - 42) / 6);
    }

    Told told;
    Instance motion{"motion", "constant_velocity", {{"noise", "0.01"}}};
    Instance sensor{"sensor", "spherical"};
    Instance instance;
    EstimatorUnderTest filter;
};

const std::vector<Row> biases{{"sensors.radar.bias", 0, bias_deviation(0)},
                              {"sensors.radar.bias", 1, bias_deviation(1)},
                              {"sensors.radar.bias", 2, bias_deviation(2)}};

VectorXd seen(const VectorXd& x) {
    return Eigen::Vector3d(x.head(3).norm(), std::atan2(x(1), x(0)), std::atan2(x(2), x.head(2).norm()));
}
/// d seen / d state by the textbook's derivatives of a polar conversion.
MatrixXd slope(const VectorXd& x) {
    const double range = x.head(3).norm(), ground = x.head(2).norm();
    MatrixXd h = MatrixXd::Zero(3, 6);
    h.topLeftCorner(1, 3) = x.head(3).transpose() / range;
    h(1, 0) = -x(1) / (ground * ground);
    h(1, 1) = x(0) / (ground * ground);
    h(2, 0) = -x(0) * x(2) / (range * range * ground);
    h(2, 1) = -x(1) * x(2) / (range * range * ground);
    h(2, 2) = ground / (range * range);
    return h;
}

MatrixXd transition(double dt) {
    MatrixXd f = MatrixXd::Identity(6, 6);
    f.topRightCorner(3, 3) = dt * MatrixXd::Identity(3, 3);
    return f;
}
MatrixXd motion_noise(double dt) {
    const MatrixXd one = MatrixXd::Identity(3, 3) * process_noise;
    MatrixXd q(6, 6);
    q << dt * dt * dt / 3.0 * one, dt * dt / 2.0 * one, dt * dt / 2.0 * one, dt * one;
    return q;
}

class Draws {
public:
    explicit Draws(unsigned seed) : engine_(seed) {}
    VectorXd operator()(const MatrixXd& covariance) {
        VectorXd white(covariance.rows());
        for (Eigen::Index k = 0; k < white.size(); ++k) white(k) = normal_(engine_);
        return covariance.llt().matrixL() * white;
    }

private:
    std::mt19937_64 engine_;
    std::normal_distribution<double> normal_;
};

/// The mean over tracks of the normalised estimation error squared after 30 looks through a constant bias drawn a track.
double mean_error(const Tracking& tracking) {
    const std::int64_t tracks = 200;
    const double dt = 1.0;
    Draws draw(11);
    MatrixXd truth(6, tracks), bias(3, tracks);
    for (std::int64_t i = 0; i < tracks; ++i) {
        truth.col(i) = start + draw(spread);
        bias.col(i) = draw(bias_deviation.cwiseAbs2().asDiagonal());
    }
    Batch records = tracking.started(tracks), z(3, 1, tracks);
    for (int k = 0; k < 30; ++k) {
        tracking.predict(dt, records);
        for (std::int64_t i = 0; i < tracks; ++i) {
            truth.col(i) = transition(dt) * truth.col(i) + draw(motion_noise(dt));
            z[i] = seen(truth.col(i)) + bias.col(i) + draw(noise);
        }
        tracking.update(z, records);
    }
    double sum = 0.0;
    for (std::int64_t i = 0; i < tracks; ++i) {
        const auto [x, p] = tracking.moments(records, i);
        const VectorXd error = truth.col(i) - x;
        sum += error.dot(p.llt().solve(error));
    }
    return sum / static_cast<double>(tracks);
}

std::string refusal(const std::vector<Row>& rows) {
    try {
        const Tracking tracking(rows);
    } catch (const Refused& refused) {
        return refused.where + ": " + refused.what();
    }
    return "";
}

}  // namespace

TEST_CASE(
    "the consider filter's errors are as large as it says through an unknown bias where the Kalman filter's are not",
    "[schmidt]") {
    // Of 200 tracks with 6 components the mean has the deviation 6 sqrt(2 / 1200) = 0.245.
    const double considered = mean_error(Tracking(biases));
    CHECK(considered > 5.2);
    CHECK(considered < 6.8);
    CHECK(mean_error(Tracking()) > 20.0);
}

TEST_CASE("the consider filter has the error covariance of its gain in the state with the parameters appended",
          "[schmidt]") {
    const Tracking tracking(biases);
    Batch record = tracking.started(), z(3, 1);
    MatrixXd joint = MatrixXd::Zero(9, 9), f = MatrixXd::Identity(9, 9), q = MatrixXd::Zero(9, 9);
    joint.topLeftCorner(6, 6) = spread;
    joint.bottomRightCorner(3, 3) = bias_deviation.cwiseAbs2().asDiagonal();
    VectorXd mean = start;
    Draws draw(3);
    for (int k = 0; k < 20; ++k) {
        const double dt = 0.5 + 0.1 * k;
        f.topLeftCorner(6, 6) = transition(dt);
        q.topLeftCorner(6, 6) = motion_noise(dt);
        mean = transition(dt) * mean;
        joint = f * joint * f.transpose() + q;
        tracking.predict(dt, record);

        MatrixXd h(3, 9);
        h << slope(mean), MatrixXd::Identity(3, 3);
        const Eigen::Matrix3d s = h * joint * h.transpose() + noise;
        MatrixXd gain = joint * h.transpose() * s.inverse();
        gain.bottomRows(3).setZero();  // the parameters are not estimated
        z[0] = seen(mean) + draw(noise);
        const VectorXd innovation = z[0] - seen(mean);
        mean += gain.topRows(6) * innovation;
        const MatrixXd rest = MatrixXd::Identity(9, 9) - gain * h;
        joint = rest * joint * rest.transpose() + gain * noise * gain.transpose();
        auto told = tracking.update(z, record);

        const auto [x, p] = tracking.moments(record);
        const VectorXd deviations = joint.diagonal().cwiseSqrt();
        const MatrixXd scale = deviations.cwiseInverse().asDiagonal();
        const MatrixXd cross = tracking.cross(record) * bias_deviation.asDiagonal();
        CHECK((scale.topLeftCorner(6, 6) * (x - mean)).cwiseAbs().maxCoeff() < 1e-8);
        CHECK((scale.topLeftCorner(6, 6) * (p - joint.topLeftCorner(6, 6)) * scale.topLeftCorner(6, 6))
                  .cwiseAbs()
                  .maxCoeff() < 1e-9);
        CHECK((scale.topLeftCorner(6, 6) * (cross - joint.topRightCorner(6, 3)) * scale.bottomRightCorner(3, 3))
                  .cwiseAbs()
                  .maxCoeff() < 1e-9);
        CHECK((told.covariance[0] - s).norm() < 1e-9 * s.norm());
        const double expected = -0.5 * (innovation.dot(s.inverse() * innovation) + std::log(s.determinant()) +
                                        3.0 * std::log(2.0 * std::acos(-1.0)));
        CHECK(told.log_likelihood[0](0) == Approx(expected).epsilon(1e-7));
    }
}

TEST_CASE("without any deviation the consider filter is the Kalman filter", "[schmidt]") {
    const Tracking plain;
    for (const auto& rows : {std::vector<Row>{}, std::vector<Row>{{"sensors.radar.bias", -1, 0.0}}}) {
        const Tracking tracking(rows);
        Batch record = tracking.started(), other = plain.started(), z(3, 1);
        Draws draw(5);
        for (int k = 0; k < 10; ++k) {
            tracking.predict(0.7, record);
            plain.predict(0.7, other);
            z[0] = seen(plain.moments(other).first) + draw(noise);
            auto told = tracking.update(z, record), expected = plain.update(z, other);
            const auto [x, p] = tracking.moments(record);
            const auto [mean, covariance] = plain.moments(other);
            CHECK((x - mean).norm() < 1e-12 * mean.norm());
            CHECK((p - covariance).norm() < 1e-12 * covariance.norm());
            CHECK(told.log_likelihood[0](0) == Approx(expected.log_likelihood[0](0)).epsilon(1e-10));
        }
    }
}

TEST_CASE("a place of the platform known by so much blurs a look like a target known by so much less", "[schmidt]") {
    const double deviation = 30.0;
    const Tracking tracking({{"sensors.radar.platform_position", -1, deviation}});
    const Batch record = tracking.started();
    Batch z(3, 1), covariance(3, 3), cross(6, 3);
    Call call;
    done(call, tracking.filter.project(call, 0, record, z, covariance, cross));
    MatrixXd blurred = spread;
    for (int axis = 0; axis < 3; ++axis) blurred(axis, axis) += deviation * deviation;
    const MatrixXd h = slope(start), expected = h * blurred * h.transpose();
    const VectorXd scale = expected.diagonal().cwiseSqrt().cwiseInverse();
    CHECK((scale.asDiagonal() * (covariance[0] - expected) * scale.asDiagonal()).cwiseAbs().maxCoeff() < 1e-6);
    CHECK((cross[0] - spread * h.transpose()).norm() < 1e-9 * cross[0].norm());
    CHECK((z[0] - seen(start)).norm() < 1e-9);
}

TEST_CASE("a batch of the consider filter of items with inputs of their own answers what single items answer",
          "[schmidt]") {
    const Tracking tracking({{"sensors.radar.bias", 1, 2e-3}, {"sensors.radar.platform_position", -1, 15.0}});
    const std::int64_t count = 19;
    const auto size = static_cast<std::int64_t>(tracking.told.size());
    Batch inputs(size, 1, count), records = tracking.started(count), z(3, 1, count);
    for (std::int64_t i = 0; i < count; ++i) {
        inputs[i].setZero();
        inputs[i](1) = 1e-4 * static_cast<double>(i);
        inputs[i](4) = 10.0 * static_cast<double>(i);
        z[i] = seen(start);
    }
    const Batch before = records, given = inputs;
    Call call(count);
    call.inputs(inputs.numbers.data(), size);
    EstimatorUnderTest::Told told(3, count);
    const auto noises = pelorus::common_view(noise.data(), 3, 3, count);
    done(call, tracking.filter.update(call, 0, records, z, noises, records, told));
    CHECK(inputs.numbers == given.numbers);
    for (std::int64_t i = 0; i < count; ++i) {
        Batch one(records.rows, 1), z1(3, 1);
        std::copy_n(before.numbers.data() + i * records.rows, records.rows, one.numbers.data());
        z1[0] = z[i];
        Call single;
        single.inputs(inputs[i].data());
        EstimatorUnderTest::Told alone(3, 1);
        done(single,
             tracking.filter.update(single, 0, one, z1, pelorus::const_view(noise.data(), 3, 3, 1), one, alone));
        CHECK(one[0] == records[i]);
        CHECK(alone.innovation[0] == told.innovation[i]);
    }
    CHECK(records[0] != records[1]);
}

TEST_CASE("a damaged record of the consider filter fails alone", "[schmidt]") {
    const Tracking tracking(biases);
    Batch good = tracking.started(3), z(3, 1, 3);
    for (int i = 0; i < 3; ++i) z[i] = seen(start);
    tracking.update(z, good);
    const auto check = [&](Batch& records) {
        Batch out(records.rows, 1, 3);
        EstimatorUnderTest::Told told(3, 3);
        Call call(3), step(3);
        const double dt = 1.0;
        CHECK(tracking.filter.update(call, 0, records, z, pelorus::common_view(noise.data(), 3, 3, 3), out, told) ==
              PLR_ITEMS_FAILED);
        CHECK(tracking.filter.predict(step, pelorus::common_view(&dt, 1, 1, 3), records, out) == PLR_ITEMS_FAILED);
        for (const Call* each : {&call, &step}) {
            CHECK(each->status(0) == PLR_OK);
            CHECK(each->status(1) == PLR_E_NUMERIC);
            CHECK(each->status(2) == PLR_OK);
        }
        return call.message();
    };
    const std::string indefinite =
        "the joint covariance of the state and the considered inputs is not positive semidefinite";
    Batch records = good;
    records[1](42) = 1e6;  // more than the state's own covariance allows
    CHECK(check(records) == indefinite);
    records = good;
    records[1](42 + 17) = pelorus::not_a_number;
    CHECK(check(records) == indefinite);
    records = good;
    records[1](6) = -1.0;
    CHECK(check(records) == indefinite);
    records = good;
    records[1](3) = pelorus::not_a_number;
    check(records);
}

TEST_CASE("assigned moments keep the cross-covariance as far as they leave room for it", "[schmidt]") {
    const Tracking tracking(biases);
    Batch record = tracking.started(), z(3, 1), mean(6, 1), covariance(6, 6), out(record.rows, 1);
    z[0] = seen(start);
    tracking.update(z, record);
    mean[0] = start;
    Call call;
    covariance[0] = 2.0 * tracking.moments(record).second;
    done(call, tracking.filter.assign(call, record, mean, covariance, out));
    CHECK(tracking.cross(out) == tracking.cross(record));
    covariance[0] = MatrixXd::Identity(6, 6);
    done(call, tracking.filter.assign(call, record, mean, covariance, out));
    CHECK(tracking.moments(out).second == covariance[0]);
    const MatrixXd x = tracking.cross(out);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(x.transpose() * x);
    CHECK(eigen.eigenvalues().maxCoeff() == Approx(1.0));
    tracking.update(z, out);  // stands at the edge, and can go on
}

TEST_CASE("a mixture of hypotheses has the mean of their cross-covariances", "[schmidt]") {
    const Tracking tracking(biases);
    Batch first = tracking.started(), second = first, z(3, 1);
    z[0] = seen(start);
    tracking.update(z, first);
    const auto* const mix = tracking.filter.part().extension<plr_estimator_mix>(PLR_ESTIMATOR_MIX);
    Batch both(first.rows, 2), weights(2, 1), out(first.rows, 1);
    both[0].col(0) = first[0];
    both[0].col(1) = second[0];
    weights[0] << 0.25, 0.75;
    const plr_estimator_mix_args args{sizeof args, 0, weights.in(), both.in(), out.out()};
    const Call call;
    REQUIRE(mix->mix(tracking.filter.part().self(), &static_cast<const plr_call&>(call), &args) == PLR_OK);
    CHECK(tracking.cross(first).norm() > 1.0);
    CHECK((tracking.cross(out) - 0.25 * tracking.cross(first)).norm() < 1e-12);
}

TEST_CASE("rows of consider that name no uncertain constant of a sensor are refused", "[schmidt]") {
    CHECK(
        refusal({{"sensors.radar.bais", -1, 1.0}}) ==
        "consider: row 1: no input sensors.radar.bais; there are sensors.radar.bias, "
        "sensors.radar.platform_position, sensors.radar.platform_attitude, sensors.radar.attitude_error, motion.wind");
    CHECK(refusal({{"sensors.radar.bias", 0, 1.0}, {"sensors.radar.bias", 3, 1.0}}) ==
          "consider: row 2: element is 3, expected 0 to 2 of sensors.radar.bias");
    CHECK(refusal({{"sensors.radar.bias", 1, 1.0}, {"sensors.radar.bias", -1, 1.0}}) ==
          "consider: row 2: element 1 of sensors.radar.bias has been named before");
    CHECK(refusal({{"motion.wind", 0, 1.0}}) ==
          "consider: row 1: motion.wind is not a sensor's; only inputs of sensors can be considered");
}
