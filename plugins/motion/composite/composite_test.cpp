#include <pelorus/motion.hpp>

#include "../../../tests/support/motion_filter.hpp"

using namespace test_support;

namespace {

/// Why joining these parts was refused, or "accepted".
std::string refusal(std::vector<Instance::Filled> parts) {
    try {
        const Instance instance("motion", "composite", {}, std::move(parts));
    } catch (const Refused& error) {
        CHECK(error.where == "motions");
        return error.what();
    }
    return "accepted";
}

std::string names_of(const MotionUnderTest& motion) {
    std::string names;
    for (std::int64_t i = 0; i < motion.size(); ++i)
        names += std::string(i == 0 ? "" : " ") + motion.component(static_cast<std::size_t>(i)).name;
    return names;
}

/// A point that stands, of a kind that cannot be a part: it asks for the extent, or holds range and azimuth.
template <bool uses_extent> struct Standing : pelorus::Motion<Standing<uses_extent>, 2> {
    static constexpr std::uint32_t flags = uses_extent ? std::uint32_t{PLR_MOTION_USES_EXTENT} : 0u;
    static constexpr bool cartesian = uses_extent;
    using State = Eigen::Vector2d;
    using Square = Eigen::Matrix2d;

    static void describe(pelorus::Describe<Standing>& plugin) { plugin.title("Standing"); }
    pelorus::Space space() const {
        if (uses_extent) return pelorus::kinematic_space(2, {1.0});
        return pelorus::Space({{"range", "m", 0.0, 1.0, false}, {"azimuth", "rad", 0.0, 1.0, true}});
    }
    pelorus::Space cartesian_space() const { return pelorus::kinematic_space(2, {1.0}); }
    State propagate(const State& x, const pelorus::Step&) const { return x; }
    Square jacobian(const State&, const pelorus::Step&) const { return Square::Identity(); }
    template <class Posterior> Square noise(const Posterior&, const pelorus::Step&) const { return Square::Zero(); }
    State to_cartesian(const State& x) const { return x(0) * State(std::cos(x(1)), std::sin(x(1))); }
    State from_cartesian(const State& c) const { return {c.norm(), std::atan2(c(1), c(0))}; }
    Square to_cartesian_jacobian(const State&) const { return Square::Identity(); }
    Square from_cartesian_jacobian(const State&) const { return Square::Identity(); }
};

template <bool uses_extent> const plr_plugin& standing() {
    return *pelorus::detail::plugin<Standing<uses_extent>>("motion.standing", "motion.standing");
}

}  // namespace

TEST_CASE("a composite joins its parts in canonical order", "[motion]") {
    const Instance height("motion", "random_walk",
                          {{"dimension", "1"}, {"noise", "4 m2/s"}, {"prior_position", "50 m"}}),
        plane("motion", "constant_velocity", {{"dimension", "2"}, {"noise", "0.5 m2/s3"}});
    const Instance whole("motion", "composite", {},
                         {{"motions", "height", &height, {{"axes", "z"}}}, {"motions", "plane", &plane}});
    const MotionUnderTest motion(whole), in_plane(plane);
    CHECK(names_of(motion) == "position.x position.y position.z velocity.x velocity.y");
    CHECK(motion.component(2).prior_deviation == 50.0);
    check_linear_motion(motion, 0.7, 2.3);
    CHECK((motion.flags() & PLR_MOTION_EXACT_NOISE) != 0);
    CHECK((motion.flags() & PLR_MOTION_BACKWARD) != 0);

    Eigen::VectorXd x(5), expected(5);
    x << 1.0, 2.0, 3.0, 10.0, -20.0;
    expected << 21.0, -38.0, 3.0, 10.0, -20.0;
    CHECK(motion.propagate(2.0, x) == expected);
    const std::vector<int> of_plane{0, 1, 3, 4}, of_height{2};
    const Eigen::MatrixXd q = motion.noise(2.0);
    CHECK(reordered(q, of_plane, of_plane) == in_plane.noise(2.0));
    CHECK(q(2, 2) == 8.0);
    CHECK(reordered(q, of_height, of_plane).isZero(0.0));
}

TEST_CASE("a composite keeps the flags that all its parts have, and their factors", "[motion]") {
    const Instance discrete("motion", "constant_velocity", {{"dimension", "1"}, {"form", "discrete"}}),
        accelerated("motion", "constant_acceleration", {{"dimension", "1"}, {"form", "discrete"}}),
        truncated("motion", "singer", {{"dimension", "1"}, {"form", "truncated"}}),
        smooth("motion", "constant_velocity", {{"dimension", "1"}});
    const Instance factored("motion", "composite", {},
                            {{"motions", "y", &discrete, {{"axes", "y"}}},
                             {"motions", "x", &accelerated},
                             {"motions", "z", &truncated, {{"axes", "z"}}}});
    const MotionUnderTest motion(factored);
    CHECK(names_of(motion) ==
          "position.x position.y position.z velocity.x velocity.y velocity.z acceleration.x acceleration.z");
    CHECK(motion.factor(0.7).cols() == 3);
    CHECK((motion.flags() & (PLR_MOTION_EXACT_NOISE | PLR_MOTION_BACKWARD | PLR_MOTION_TIME_INVARIANT)) == 0u);
    check_linear_motion(motion, 0.7, 2.3);
    const Instance without("motion", "composite", {},
                           {{"motions", "x", &accelerated}, {"motions", "y", &smooth, {{"axes", "y"}}}});
    CHECK(MotionUnderTest(without).factor(0.7).size() == 0);
}

TEST_CASE("parts of a composite with records filter as they would alone", "[motion]") {
    const Instance height("motion", "modified_current_statistical", {{"dimension", "1"}}),
        plane("motion", "adaptive_constant_acceleration", {{"dimension", "2"}});
    const Instance whole("motion", "composite", {},
                         {{"motions", "height", &height, {{"axes", "z"}}}, {"motions", "plane", &plane}});
    CHECK((MotionUnderTest(whole).flags() & (PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE)) == 0u);
    const std::vector<int> of_plane{0, 1, 3, 4, 6, 7}, of_height{2, 5, 8};
    Eigen::VectorXd start(9);
    start << 1.0, 2.0, 3.0, -4.0, 5.0, -6.0, 0.7, -0.8, 0.9;
    const Eigen::MatrixXd covariance = Eigen::VectorXd::LinSpaced(9, 1.0, 3.0).asDiagonal();
    const auto part = [&](const Instance& instance, const std::vector<int>& of) {
        return MotionFilter(instance, reordered(start, of, {0}), reordered(covariance, of, of));
    };
    MotionFilter joined(whole, start, covariance), high = part(height, of_height), flat = part(plane, of_plane);
    for (int step = 0; step < 8; ++step) {
        joined.predict(0.5);
        high.predict(0.5);
        flat.predict(0.5);
    }
    CHECK(relative_difference(reordered(joined.mean(), of_height, {0}), high.mean()) < 1e-12);
    CHECK(relative_difference(reordered(joined.mean(), of_plane, {0}), flat.mean()) < 1e-12);
    CHECK(relative_difference(reordered(joined.covariance(), of_height, of_height), high.covariance()) < 1e-12);
    CHECK(relative_difference(reordered(joined.covariance(), of_plane, of_plane), flat.covariance()) < 1e-12);
    REQUIRE(joined.record().size() == high.record().size() + flat.record().size());
    CHECK(relative_difference(joined.record().tail(2), flat.record()) < 1e-12);
}

TEST_CASE("a composite moves any number of items and points in blocks", "[motion]") {
    const Instance height("motion", "random_walk", {{"dimension", "1"}}),
        plane("motion", "current_statistical", {{"dimension", "2"}});
    const Instance whole("motion", "composite", {},
                         {{"motions", "plane", &plane}, {"motions", "height", &height, {{"axes", "z"}}}});
    const auto motion = whole.as<pelorus::MotionPart>();
    constexpr std::int64_t items = 35, points = 37;
    Batch states(7, points, items), means(7, 1, items), out(7, points, items);
    for (std::size_t k = 0; k < states.numbers.size(); ++k) states.numbers[k] = 0.25 * static_cast<double>(k % 101);
    for (std::size_t k = 0; k < means.numbers.size(); ++k) means.numbers[k] = 0.5 * static_cast<double>(k % 17);
    std::vector<double> steps;
    for (std::int64_t i = 0; i < items; ++i) steps.push_back(0.1 * static_cast<double>(i));
    auto args = pelorus::arguments<plr_motion_propagate>();
    args.dt = pelorus::const_view(steps.data(), 1, 1, items);
    args.state = states.in();
    args.mean = means.in();
    args.out = out.out();
    Call call(items);
    REQUIRE(motion.call(&plr_motion::propagate, call, args) == PLR_OK);
    const std::vector<int> of_plane{0, 1, 3, 4, 5, 6};
    for (const std::int64_t i : {std::int64_t{0}, std::int64_t{15}, std::int64_t{16}, items - 1}) {
        const Eigen::MatrixXd own = states[i], mean = means[i], moved = out[i];
        const MotionFilter alone(plane, reordered(mean, of_plane, {0}), Eigen::MatrixXd::Identity(6, 6));
        std::vector<int> all(points);
        for (int p = 0; p < points; ++p) all[static_cast<std::size_t>(p)] = p;
        CHECK(reordered(moved, of_plane, all) ==
              alone.moved(steps[static_cast<std::size_t>(i)], reordered(own, of_plane, all)));
        CHECK(moved.row(2) == own.row(2));
    }
}

TEST_CASE("a step that one item of a composite cannot make leaves the others", "[motion]") {
    const Instance plane("motion", "current_statistical", {{"dimension", "2"}});
    const Instance whole("motion", "composite", {}, {{"motions", "plane", &plane}});
    const auto motion = whole.as<pelorus::MotionPart>();
    constexpr std::int64_t items = 20;
    const Batch states = [&] {
        Batch zero(6, 1, items);
        std::fill(zero.numbers.begin(), zero.numbers.end(), 1.0);
        return zero;
    }();
    Batch out(6, 1, items);
    std::vector<double> steps(items, 1.0);
    steps[18] = -1.0;
    auto args = pelorus::arguments<plr_motion_propagate>();
    args.dt = pelorus::const_view(steps.data(), 1, 1, items);
    args.state = states.in();
    args.out = out.out();
    Call call(items);
    CHECK(motion.call(&plr_motion::propagate, call, args) == PLR_ITEMS_FAILED);
    CHECK(call.status(18) == PLR_E_UNSUPPORTED);
    CHECK(call.error().item == 18);
    CHECK(call.status(19) == PLR_OK);
    CHECK(out[19](0) == 2.5);
}

TEST_CASE("a composite says why parts cannot be joined", "[motion]") {
    using Catch::Matchers::Contains;
    const Instance line("motion", "constant_velocity", {{"dimension", "1"}}),
        other("motion", "random_walk", {{"dimension", "1"}});
    CHECK_THAT(refusal({{"motions", "a", &line}, {"motions", "b", &other}}), Contains("both have position.x"));
    CHECK_THAT(refusal({{"motions", "a", &line, {{"axes", "xy"}}}}),
               Contains("moves on 1 axes") && Contains("names 2"));
    CHECK_THAT(refusal({{"motions", "a", &line}, {"motions", "b", &other, {{"axes", "z"}}}}),
               Contains("no part has position.y, but one has position.z"));
    CHECK_THAT(refusal({{"motions", "a", &line, {{"axes", "y"}}}}), Contains("no part has position.x"));
    CHECK(refusal({{"motions", "a", &line}, {"motions", "b", &other, {{"axes", "y"}}}}) == "accepted");
}

TEST_CASE("a composite refuses parts that are not Cartesian or that read the extent", "[motion]") {
    using Catch::Matchers::Contains;
    const Instance polar(standing<false>(), {}, {}, 0), stretched(standing<true>(), {}, {}, 0);
    CHECK_THAT(refusal({{"motions", "a", &polar}}), Contains("not Cartesian: range [m], azimuth [rad]"));
    CHECK_THAT(refusal({{"motions", "a", &stretched}}), Contains("reads the extent"));
}
