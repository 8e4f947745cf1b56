#include "../../../tests/support/extent_under_test.hpp"
#include "../../../tests/support/reference.hpp"

using namespace test_support;

namespace {

const std::string name = "least_squares_ellipsoid";
const MatrixXd no_noise = MatrixXd::Zero(3, 3);

/// Points on the surface of an ellipsoid whose half axes lie along the columns of `axes`.
MatrixXd surface(const Eigen::Matrix3d& axes, const Eigen::Vector3d& half_axes, int n) {
    MatrixXd points = cloud(3, n, 11, MatrixXd::Identity(3, 3));
    for (Eigen::Index k = 0; k < n; ++k) points.col(k) = axes * half_axes.asDiagonal() * points.col(k).normalized();
    return points;
}

}  // namespace

TEST_CASE("least squares: the quadric of the last frame of the airship's trace", "[least_squares]") {
    const auto trace = reference("airship_giw_trace.json");
    const MatrixXd points = matrix(trace.at("Z").back()).transpose();
    const ExtentUnderTest extent("{}", name);
    const MatrixXd record = extent.init({{points, MatrixXd::Identity(3, 3)}});
    const auto shape = extent.shape(record);
    const auto& known = trace.at("lsq9_last");
    CHECK(shape.half_axes(0) == Approx(known.at("smaj").get<double>()).epsilon(1e-8));
    CHECK(0.5 * (shape.half_axes(1) + shape.half_axes(2)) == Approx(known.at("smin").get<double>()).epsilon(1e-8));
    VectorXd axis(3);
    for (int k = 0; k < 3; ++k) axis(k) = known.at("axis")[static_cast<std::size_t>(k)].get<double>();
    CHECK(std::fabs(axis.dot(shape.axes.col(0))) == Approx(1).epsilon(1e-8));
    CHECK_FALSE(known.at("is_ellipsoid").get<bool>());
    CHECK(record(18) == 1);  // scans
    CHECK(record(19) == 0);  // ellipsoids among them
}

TEST_CASE("least squares: points on an ellipsoid give that ellipsoid", "[least_squares]") {
    const Eigen::Matrix3d axes = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    const Eigen::Vector3d half_axes(12, 5, 3);
    const ExtentUnderTest extent("{}", name);
    MatrixXd record = extent.init({{surface(axes, half_axes, 30), no_noise}});
    const auto shape = extent.shape(record);
    CHECK((shape.half_axes - half_axes).norm() < 1e-6);
    CHECK((shape.matrix - axes * half_axes.cwiseAbs2().asDiagonal() * axes.transpose()).norm() < 1e-5);
    CHECK(record(19) == 1);
    // The next scan alone counts.
    const VectorXd e = VectorXd::Zero(3);
    record = extent.update(record, {surface(axes, 2 * half_axes, 30), no_noise}, e, MatrixXd::Identity(3, 3)).records;
    CHECK((extent.shape(record).half_axes - 2 * half_axes).norm() < 1e-5);
}

TEST_CASE("least squares: points that determine no quadric leave the shape as it was", "[least_squares]") {
    const ExtentUnderTest extent("{}", name);
    const MatrixXd record = extent.init({{cloud(3, 20, 1, diagonal({144, 25, 25})), no_noise}});
    const auto before = extent.shape(record).matrix;
    const VectorXd e = VectorXd::Zero(3);
    MatrixXd flat = cloud(3, 20, 2, diagonal({144, 25, 25}));
    flat.row(2).setConstant(4);
    for (const MatrixXd& points : {MatrixXd(cloud(3, 8, 3, diagonal({144, 25, 25}))), flat,
                                   MatrixXd(VectorXd::Constant(3, 7.0).replicate(1, 12))}) {
        const MatrixXd after = extent.update(record, {points, no_noise}, e, MatrixXd::Identity(3, 3)).records;
        CHECK(after.allFinite());
        CHECK((extent.shape(after).matrix - before).norm() < 1e-9 * before.norm());
    }
}

TEST_CASE("least squares: never a NaN, whatever the points", "[least_squares]") {
    const ExtentUnderTest extent("{}", name);
    MatrixXd record = extent.init({{cloud(3, 9, 1, diagonal({144, 25, 25})), no_noise}});
    int ellipsoids = 0;
    for (std::uint64_t seed = 2; seed < 300; ++seed) {
        const VectorXd e = VectorXd::Zero(3);
        const int n = 9 + static_cast<int>(seed % 14);
        const Cloud scan(cloud(3, n, seed, diagonal({144, 25, 25}), 1e3), MatrixXd::Identity(3, 3));
        record = extent.update(record, scan, e, MatrixXd::Identity(3, 3)).records;
        CHECK(record.allFinite());
        CHECK(extent.shape(record).half_axes.minCoeff() > 0);
        ellipsoids = static_cast<int>(record(19));
    }
    CHECK(record(18) == 299);
    CHECK(ellipsoids > 100);  // about three fifths
    CHECK(ellipsoids < 250);
}
