// An extent asked without a tracker: points, calls, shapes. For tests of extent plugins.
#pragma once

#include <catch2/catch.hpp>
#include <cmath>

#include <Eigen/Dense>

#include "airship_parts.hpp"

namespace test_support {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Points of several objects, ragged.
struct Cloud {
    std::vector<std::int64_t> offsets{0};
    std::vector<double> points, noise, weights;
    int d;

    explicit Cloud(int dimension) : d(dimension) {}
    Cloud(const MatrixXd& columns, const MatrixXd& covariance) : d(static_cast<int>(columns.rows())) {
        add(columns, covariance);
    }
    void add(const MatrixXd& columns, const MatrixXd& covariance) {
        points.insert(points.end(), columns.data(), columns.data() + columns.size());
        for (Eigen::Index k = 0; k < columns.cols(); ++k)
            noise.insert(noise.end(), covariance.data(), covariance.data() + covariance.size());
        offsets.push_back(offsets.back() + columns.cols());
    }
    plr_extent_points c() const {
        return {offsets.data(), pelorus::const_view(points.data(), d, 1, offsets.back()),
                pelorus::const_view(noise.data(), d, d, offsets.back()),
                weights.empty() ? pelorus::absent_view() : pelorus::const_view(weights.data(), 1, 1, offsets.back())};
    }
};

/// An extent plugin asked item by item or in a batch. Records are columns.
class ExtentUnderTest {
public:
    explicit ExtentUnderTest(const std::string& with, const std::string& name = "random_matrix")
        : instance_(bench_, plugin("extent", name), with) {}
    const plr_extent& table() const { return instance_.table<plr_extent>(); }
    const plr_extent_info& info() const { return *table().info(instance_.self()); }

    MatrixXd init(const std::vector<Cloud>& scans, Call& call, plr_status expected = PLR_OK) const {
        std::vector<plr_extent_points> raw;
        for (const Cloud& scan : scans) raw.push_back(scan.c());
        const auto count = static_cast<Eigen::Index>(scans.front().offsets.size() - 1);
        const double times[] = {0, 1};
        MatrixXd records = MatrixXd::Zero(info().record_size, count);
        auto args = pelorus::arguments<plr_extent_init>();
        args.scans = static_cast<std::uint32_t>(raw.size());
        args.scan = raw.data();
        args.times = pelorus::const_view(times, static_cast<std::int64_t>(raw.size()), 1, 1);
        args.record = out(records);
        REQUIRE(table().init(instance_.self(), &static_cast<const plr_call&>(call), &args) == expected);
        return records;
    }
    MatrixXd init(const std::vector<Cloud>& scans) const {
        Call call(64);
        return init(scans, call);
    }
    /// Kinematics as columns (positions, velocities), covariances side by side; empty: not told.
    MatrixXd predict(MatrixXd records, double dt, const MatrixXd& before = {}, const MatrixXd& after = {},
                     const MatrixXd& covariance = {}) const {
        Call call(64);
        auto args = pelorus::arguments<plr_extent_predict>();
        if (before.size() > 0) {
            args.before = in(before);
            args.after = in(after);
        }
        if (covariance.size() > 0)
            args.before_covariance = args.after_covariance =
                pelorus::const_view(covariance.data(), before.rows(), before.rows(), before.cols());
        args.dt = pelorus::common_view(&dt, 1, 1, records.cols());
        args.record = in(records);
        args.out = out(records);
        REQUIRE(table().predict(instance_.self(), &static_cast<const plr_call&>(call), &args) == PLR_OK);
        return records;
    }
    struct Updated {
        MatrixXd records;
        VectorXd log_likelihood;
    };
    /// Innovations as columns, covariances side by side.
    Updated update(const MatrixXd& records, const Cloud& scan, const MatrixXd& innovation, const MatrixXd& covariance,
                   const MatrixXd& kinematics = {}, const MatrixXd& kinematics_covariance = {}) const {
        Call call(64);
        const std::int64_t n = records.cols(), d = scan.d;
        Updated result{records, VectorXd::Zero(n)};
        auto args = pelorus::arguments<plr_extent_update>();
        args.scan = scan.c();
        args.innovation = pelorus::const_view(innovation.data(), d, 1, n);
        args.innovation_covariance = pelorus::const_view(covariance.data(), d, d, n);
        if (kinematics.size() > 0) args.kinematics = in(kinematics);
        if (kinematics_covariance.size() > 0)
            args.kinematics_covariance =
                pelorus::const_view(kinematics_covariance.data(), kinematics.rows(), kinematics.rows(), n);
        args.record = in(records);
        args.out = out(result.records);
        args.log_likelihood = pelorus::view(result.log_likelihood.data(), 1, 1, n);
        REQUIRE(table().update(instance_.self(), &static_cast<const plr_call&>(call), &args) == PLR_OK);
        return result;
    }
    MatrixXd effective_noise(const MatrixXd& record, const MatrixXd& noise, double number) const {
        Call call;
        MatrixXd result = noise;
        auto args = pelorus::arguments<plr_extent_effective_noise>();
        args.record = in(record);
        args.noise = pelorus::const_view(noise);
        args.number = pelorus::const_view(&number, 1, 1, 1);
        args.out = pelorus::view(result);
        REQUIRE(table().effective_noise(instance_.self(), &static_cast<const plr_call&>(call), &args) == PLR_OK);
        return result;
    }
    struct Shape {
        MatrixXd matrix, axes;
        VectorXd half_axes;
    };
    Shape shape(const MatrixXd& record) const {
        Call call;
        const auto d = info().dimension;
        Shape result{MatrixXd(d, d), MatrixXd(d, d), VectorXd(d)};
        auto args = pelorus::arguments<plr_extent_shape>();
        args.record = in(record);
        args.matrix = pelorus::view(result.matrix);
        args.half_axes = pelorus::view(result.half_axes);
        args.axes = pelorus::view(result.axes);
        REQUIRE(table().shape(instance_.self(), &static_cast<const plr_call&>(call), &args) == PLR_OK);
        return result;
    }
    VectorXd gate(const MatrixXd& record, const VectorXd& centre, const MatrixXd& covariance, const Cloud& scan) const {
        Call call;
        VectorXd result(scan.offsets.back());
        auto args = pelorus::arguments<plr_extent_gate>();
        args.record = in(record);
        args.predicted = pelorus::const_view(centre);
        args.covariance = pelorus::const_view(covariance);
        args.scan = scan.c();
        args.squared_distance = pelorus::view(result.data(), 1, 1, scan.offsets.back());
        REQUIRE(table().gate(instance_.self(), &static_cast<const plr_call&>(call), &args) == PLR_OK);
        return result;
    }

private:
    static plr_const_view in(const MatrixXd& records) {
        return pelorus::const_view(records.data(), records.rows(), 1, records.cols());
    }
    static plr_view out(MatrixXd& records) { return pelorus::view(records.data(), records.rows(), 1, records.cols()); }
    Bench bench_;
    BenchInstance instance_;
};

/// n points N(centre, X), the same for the same seed.
inline MatrixXd cloud(int d, int n, std::uint64_t seed, const MatrixXd& extent, double offset = 0) {
    MatrixXd unit(d, n);
    pelorus::host::random_service().normal({{seed, 1}}, 0, unit.size(), unit.data());
    const MatrixXd root = extent.llt().matrixL();
    return (root * unit).array() + offset;
}
inline MatrixXd scatter(const MatrixXd& points) {
    const MatrixXd centred = points.colwise() - points.rowwise().mean();
    return centred * centred.transpose();
}
inline MatrixXd diagonal(std::initializer_list<double> values) {
    return VectorXd(Eigen::Map<const VectorXd>(values.begin(), static_cast<Eigen::Index>(values.size()))).asDiagonal();
}

}  // namespace test_support
