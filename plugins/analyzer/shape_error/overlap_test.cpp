#include "overlap.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include <Eigen/Dense>

namespace {

using pelorus::Matrix;
using pelorus::Vector;
using shape_error::intersection_over_union;

const double pi = std::acos(-1.0);

Matrix<2> ellipse(double a, double b, double degrees) {
    const Matrix<2> r = Eigen::Rotation2Dd(degrees * pi / 180).toRotationMatrix();
    return r * Vector<2>(a * a, b * b).asDiagonal() * r.transpose();
}
Matrix<3> ball(double radius) { return radius * radius * Matrix<3>::Identity(); }

/// Two circles whose centres are d apart.
double circles(double r, double s, double d) {
    const double common = r * r * std::acos((d * d + r * r - s * s) / (2 * d * r)) +
                          s * s * std::acos((d * d + s * s - r * r) / (2 * d * s)) -
                          0.5 * std::sqrt((r + s - d) * (d + r - s) * (d - r + s) * (d + r + s));
    return common / (pi * (r * r + s * s) - common);
}
/// Two balls of radii r and s.
double balls(double r, double s, double d) {
    const double common = pi * (r + s - d) * (r + s - d) * (d * d + 2 * d * (r + s) - 3 * (r - s) * (r - s)) / (12 * d);
    return common / (4 * pi / 3 * (r * r * r + s * s * s) - common);
}

template <int D> Matrix<D> random_extent(std::mt19937& random) {
    std::normal_distribution<double> normal;
    Matrix<D> a;
    for (int k = 0; k < D * D; ++k) a.data()[k] = normal(random);
    return a * a.transpose() + 0.05 * Matrix<D>::Identity();
}

/// By counting points of a grid that are within.
template <int D> double counted(const Vector<D>& offset, const Matrix<D>& one, const Matrix<D>& other, int steps) {
    const Matrix<D> first = one.inverse(), second = other.inverse();
    Vector<D> low, high;
    for (int k = 0; k < D; ++k) {
        low(k) = std::min(offset(k) - std::sqrt(one(k, k)), -std::sqrt(other(k, k)));
        high(k) = std::max(offset(k) + std::sqrt(one(k, k)), std::sqrt(other(k, k)));
    }
    long both = 0, any = 0, total = 1;
    for (int k = 0; k < D; ++k) total *= steps;
    for (long i = 0; i < total; ++i) {
        Vector<D> point;
        long rest = i;
        for (int k = 0; k < D; ++k, rest /= steps)
            point(k) = low(k) + (high(k) - low(k)) * (static_cast<double>(rest % steps) + 0.5) / steps;
        const bool a = (point - offset).dot(first * (point - offset)) < 1, b = point.dot(second * point) < 1;
        both += a && b;
        any += a || b;
    }
    return static_cast<double>(both) / static_cast<double>(any);
}

}  // namespace

TEST_CASE("overlap: circles and balls have their closed forms", "[shape_error]") {
    for (const double d : {0.5, 1.2, 2.0, 2.9}) {
        const double angle = 0.3 + d;
        CHECK(intersection_over_union(Vector<2>(d * std::cos(angle), d * std::sin(angle)), ellipse(2, 2, 0),
                                      ellipse(1, 1, 0)) == Approx(d < 1 ? 0.25 : circles(2, 1, d)).epsilon(1e-12));
        const Vector<3> far = d * Vector<3>(0.6, -0.3, 0.5).normalized();
        CHECK(intersection_over_union(far, ball(2), ball(1)) == Approx(d < 1 ? 0.125 : balls(2, 1, d)).epsilon(1e-4));
    }
    CHECK(intersection_over_union(Vector<2>(3.01, 0), ellipse(2, 2, 0), ellipse(1, 1, 0)) == 0);
    CHECK(intersection_over_union(Vector<3>(0, 0, 3.01), ball(2), ball(1)) == 0);
    CHECK(intersection_over_union(Vector<3>(3.01, 0, 0), ball(2), ball(1)) == 0);
}

TEST_CASE("overlap: crossed ellipses have their closed form", "[shape_error]") {
    // a, b crossed at right angles: the common area is 4 a b atan(b/a).
    const double common = 4 * 12 * 5 * std::atan(5.0 / 12);
    for (const double turn : {0.0, 17.0, 45.0, 90.0})
        CHECK(intersection_over_union(Vector<2>(0, 0), ellipse(12, 5, turn), ellipse(12, 5, turn + 90)) ==
              Approx(common / (2 * pi * 60 - common)).epsilon(1e-12));
}

TEST_CASE("overlap: an affine map of everything changes nothing", "[shape_error]") {
    std::mt19937 random(3);
    for (int k = 0; k < 50; ++k) {
        const Matrix<2> one = random_extent<2>(random), other = random_extent<2>(random),
                        map = random_extent<2>(random);
        const Vector<2> offset(0.8, -0.3);
        const double before = intersection_over_union(offset, one, other);
        CHECK(intersection_over_union(Vector<2>(map * offset), Matrix<2>(map * one * map.transpose()),
                                      Matrix<2>(map * other * map.transpose())) == Approx(before).epsilon(1e-9));
        CHECK(intersection_over_union(Vector<2>(-offset), other, one) == Approx(before).epsilon(1e-9));
    }
    for (int k = 0; k < 20; ++k) {
        const Matrix<3> one = random_extent<3>(random), other = random_extent<3>(random),
                        map = random_extent<3>(random);
        const Vector<3> offset(0.8, -0.3, 0.4);
        const double before = intersection_over_union(offset, one, other);
        const double after = intersection_over_union(Vector<3>(map * offset), Matrix<3>(map * one * map.transpose()),
                                                     Matrix<3>(map * other * map.transpose()));
        CHECK(after == Approx(before).margin(1e-4));  // sliced along another direction
    }
}

TEST_CASE("overlap: is what counting points of a grid finds", "[shape_error]") {
    std::mt19937 random(4);
    for (int k = 0; k < 40; ++k) {
        const Matrix<2> one = random_extent<2>(random), other = random_extent<2>(random);
        const Vector<2> offset = Vector<2>(0.7, -0.4) * (k % 4);
        CHECK(intersection_over_union(offset, one, other) == Approx(counted<2>(offset, one, other, 500)).margin(4e-3));
    }
    for (int k = 0; k < 8; ++k) {
        const Matrix<3> one = random_extent<3>(random), other = random_extent<3>(random);
        const Vector<3> offset = Vector<3>(0.5, -0.3, 0.4) * (k % 4);
        CHECK(intersection_over_union(offset, one, other) == Approx(counted<3>(offset, one, other, 80)).margin(6e-3));
    }
}

TEST_CASE("overlap: of a shape with itself it is all, however nearly equal they are", "[shape_error]") {
    for (const double change : {0.0, 1e-15, 1e-12, 1e-9, 1e-7, 1e-5}) {
        const Matrix<2> flat = ellipse(12, 5, 30), solid = ellipse(12 * (1 + change), 5, 30);
        CHECK(intersection_over_union(Vector<2>(change, 0), flat, solid) == Approx(1).margin(1e-7 + 2 * change));
        CHECK(intersection_over_union(Vector<3>(0, change, 0), ball(3), ball(3 + change)) ==
              Approx(1).margin(1e-4 + 3 * change));
    }
}

TEST_CASE("overlap: one within the other is the ratio of their sizes", "[shape_error]") {
    CHECK(intersection_over_union(Vector<2>(0.1, 0.2), ellipse(12, 5, 30), ellipse(3, 2, 75)) ==
          Approx(6 / 60.0).epsilon(1e-12));
    const Matrix<3> large = Vector<3>(144, 25, 16).asDiagonal(), small = Vector<3>(36, 9, 4).asDiagonal();
    CHECK(intersection_over_union(Vector<3>(0, 0.1, 0), large, small) == Approx(36 / 240.0).epsilon(1e-4));
}

TEST_CASE("overlap: what is no ellipse overlaps with nothing", "[shape_error]") {
    CHECK(std::isnan(intersection_over_union(Vector<2>(0, 0), Matrix<2>::Zero(), ellipse(1, 1, 0))));
    CHECK(std::isnan(intersection_over_union(Vector<3>(0, 0, 0), ball(1), Matrix<3>::Zero())));
}
