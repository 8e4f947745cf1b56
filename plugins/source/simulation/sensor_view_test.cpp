// Where simulated sensors look: fields of view, and commands that turn them.
#include <catch2/catch.hpp>
#include <cmath>

#include "simulation_rig.hpp"

namespace {

using namespace simulation_rig;
constexpr std::uint32_t pointing_port = 2;
const double degree = std::acos(-1.0) / 180;

Part eye(const std::string& slot, const std::string& model = "bearings",
         const std::string& with = "{noise: [1e-9 rad, 1e-9 rad]}") {
    return {"sensors", "eye", part(parts_bench(), "sensor", model, with), slot};
}

/// An object at rest in that direction (rad), 1 km away.
Part rock(const std::string& name, double azimuth, double elevation) {
    const double level = 1000 * std::cos(elevation);
    return target(name, "{start: [" + std::to_string(level * std::cos(azimuth)) + " m, " +
                            std::to_string(level * std::sin(azimuth)) + " m, " +
                            std::to_string(1000 * std::sin(elevation)) + " m], speed: 0 m/s}");
}

std::size_t seen_in(const std::string& slot, double azimuth, double elevation) {
    Simulated run("{scans: 1}", {rock("a", azimuth, elevation), eye(slot)});
    run.source->run();
    return run.seen("eye").front().ids.size();
}

void command(Simulated& run, const Eigen::VectorXd& angles, double from, double to = 1e6, const char* unit = "rad") {
    pelorus::ValuesBuilder values;
    values.add("eye", "pointing", unit, angles, std::llround(from * 1e9), std::llround(to * 1e9));
    run.source->receive(0, values.message(0));
}

/// Azimuth and elevation that `eye` was told to have at each scan.
std::vector<VectorXd> looks(const Simulated& run) {
    std::vector<VectorXd> out;
    for (const auto& published : run.bench.published)
        if (published.port == pointing_port) {
            const plr_quantity& told = published.message->body.values->quantities[0];
            CHECK(std::string(told.address) == "eye");
            CHECK(std::string(told.name) == "pointing");
            CHECK(told.valid_from == published.message->time);
            out.emplace_back(pelorus::item(told.numbers, 0));
        }
    return out;
}

}  // namespace

TEST_CASE("simulation: what lies outside the field of view is not detected", "[simulation]") {
    const std::string cone = "{field_of_view: 10 deg, pointing: [30 deg, 40 deg]}";
    CHECK(seen_in(cone, 30 * degree, 44.9 * degree) == 1);
    CHECK(seen_in(cone, 30 * degree, 45.1 * degree) == 0);
    // Across azimuth, an angle of 4.9 deg at 40 deg of elevation is 4.9 / cos 40 = 6.4 deg of azimuth, nearly.
    CHECK(seen_in(cone, 36.3 * degree, 40 * degree) == 1);
    CHECK(seen_in(cone, 36.7 * degree, 40 * degree) == 0);
    const std::string window = "{field_of_view: [20 deg, 4 deg], pointing: [170 deg, 0 deg]}";
    CHECK(seen_in(window, 179.9 * degree, 0) == 1);
    CHECK(seen_in(window, -179.9 * degree, 0) == 0);
    CHECK(seen_in(window, 160.1 * degree, 1.9 * degree) == 1);
    CHECK(seen_in(window, 170 * degree, 2.1 * degree) == 0);
    CHECK(seen_in(window, -10 * degree, 0) == 0);  // right behind
    CHECK(seen_in("{field_of_view: [20 deg, 4 deg], pointing: [175 deg, 0 deg]}", -176 * degree, 0) == 1);
}

TEST_CASE("simulation: a field of view is about the zenith angle, and in the plane about azimuth, too",
          "[simulation]") {
    const auto count = [](const Part& sensor, const Part& object) {
        Simulated run("{scans: 1}", {object, sensor});
        run.source->run();
        return run.seen("eye").front().ids.size();
    };
    const std::string slot = "{field_of_view: 2 deg, pointing: [0 deg, 20 deg]}";
    const Part zenith = eye(slot, "bearings", "{angle: zenith}");
    CHECK(count(zenith, rock("a", 0, 20.9 * degree)) == 1);
    CHECK(count(zenith, rock("a", 0, 21.1 * degree)) == 0);
    const Part plane = eye("{field_of_view: 2 deg, pointing: 179.5 deg}", "azimuth", "{}");
    CHECK(count(plane, target("a", "{start: [-1000 m, -5 m], speed: 0 m/s}")) == 1);
    CHECK(count(plane, target("a", "{start: [-1000 m, -15 m], speed: 0 m/s}")) == 0);
}

TEST_CASE("simulation: a view turns along the great circle at its slew rate, from when a command is valid",
          "[simulation]") {
    Simulated run("{scans: 21}", {rock("a", 0, 0), eye("{field_of_view: 1 deg, slew_rate: 0.1 rad/s}")});
    command(run, Eigen::Vector2d(0.9, 0.7), 2.5);
    run.source->run();
    const auto seen = looks(run);
    REQUIRE(seen.size() == 21);
    const Eigen::Vector3d goal(std::cos(0.7) * std::cos(0.9), std::cos(0.7) * std::sin(0.9), std::sin(0.7));
    const double way = std::acos(goal.x());  // from +x
    for (std::size_t k = 0; k < seen.size(); ++k) {
        const double a = seen[k](0), e = seen[k](1), t = static_cast<double>(k);
        const Eigen::Vector3d at(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
        const double done = std::min(std::max(0.0, 0.1 * (t - 2.5)), way);
        CHECK(std::acos(std::min(1.0, at.x())) == Approx(done).margin(1e-7));
        CHECK(std::acos(std::min(1.0, at.dot(goal))) == Approx(way - done).margin(1e-7));
    }
    CHECK(seen.back()(0) == 0.9);
    CHECK(seen.back()(1) == 0.7);
    const auto found = run.seen("eye");
    for (std::size_t k = 0; k < 21; ++k)
        CHECK(found[k].ids.size() == (k < 3 ? 1u : 0u));  // turned away by 2.9 deg at k = 3
}

TEST_CASE("simulation: a later command takes over, and at the end of the last one the view rests", "[simulation]") {
    Simulated run("{scans: 31}", {target("a", dot), eye("{field_of_view: 1 deg, slew_rate: 0.1 rad/s}")});
    command(run, Eigen::Vector2d(0.5, 0), 0);
    command(run, Eigen::Vector2d(-3, 0), 20, 25);
    command(run, Eigen::Vector2d(-1, 0), 10, 15);  // in the place of the one before, which is later
    run.source->run();
    const auto seen = looks(run);
    for (std::size_t k = 0; k < seen.size(); ++k) {
        const double t = static_cast<double>(k);
        const double expected = t < 5 ? 0.1 * t : t < 10 ? 0.5 : t < 15 ? 0.5 - 0.1 * (t - 10) : 0.0;
        CHECK(seen[k](0) == Approx(expected).margin(1e-9));
        CHECK(seen[k](1) == Approx(0).margin(1e-12));
    }
}

TEST_CASE("simulation: what is seen in a field is the very same measurement as without one", "[simulation]") {
    const auto run = [](const std::string& slot) {
        Simulated out(
            "{scans: 50}",
            {target("ship", airship, "{points_per_scan: 9}"),
             {"sensors", "eye", part(parts_bench(), "sensor", "spherical", "{position: [-1 km, 0 m, 0 m]}"), slot}});
        out.source->run();
        return out.seen("eye");
    };
    const std::string clutter = "clutter: 20, clutter_min: [-2 km, -2 km, -2 km], clutter_max: [2 km, 2 km, 2 km]";
    const auto all = run("{" + clutter + "}"), some = run("{field_of_view: 60 deg, " + clutter + "}");
    std::size_t whole = 0, part_of_it = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
        whole += all[k].ids.size();
        part_of_it += some[k].ids.size();
        for (Eigen::Index i = 0; i < some[k].points.cols(); ++i) {
            CHECK((all[k].points.colwise() - some[k].points.col(i)).colwise().norm().minCoeff() == 0);
            const double a = some[k].points(1, i), e = some[k].points(2, i);
            CHECK(std::acos(std::cos(a) * std::cos(e)) < 30.5 * degree);
        }
    }
    CHECK(part_of_it > 100);
    CHECK(part_of_it < whole / 2);
}

TEST_CASE("simulation: a view that is saved on its way goes on bit for bit", "[simulation]") {
    const std::vector<Part> parts{rock("a", 0.3, 0.2), eye("{field_of_view: 20 deg, slew_rate: 0.02 rad/s}")};
    Simulated whole("{scans: 30}", parts), first("{scans: 30}", parts), rest("{scans: 30}", parts);
    for (Simulated* each : {&whole, &first}) command(*each, Eigen::Vector2d(0.3, 0.2), 3.25);
    whole.source->run();
    first.source->run(12);
    rest.source->load(first.source->save());
    rest.source->run();
    auto joined = looks(first);
    for (const VectorXd& look : looks(rest)) joined.push_back(look);
    CHECK(joined == looks(whole));
}

TEST_CASE("simulation: views and commands that cannot be are refused", "[simulation]") {
    const auto refusal = [](const Part& sensor) -> std::string {
        try {
            const Simulated run("{scans: 3}", {target("a", dot), sensor});
            return "";
        } catch (const std::exception& problem) {
            return problem.what();
        }
    };
    CHECK(refusal(radar("eye", "{}", "{field_of_view: 1 deg}"))
              .find("sensors: sensor eye has a field_of_view, but measures no azimuth: ") == 0);
    CHECK(refusal(eye("{slew_rate: 1 deg/s}")) ==
          "sensors: sensor eye can be pointed, but sees everything: give it a field_of_view");
    CHECK(refusal(eye("{field_of_view: 1 deg, pointing: 3 deg}")) ==
          "sensors: sensor eye has a pointing that has 1 angles, not 2 (azimuth, elevation)");
    Simulated run("{scans: 3}", {target("a", dot), eye("{field_of_view: 1 deg}")});
    CHECK_THROWS_WITH(command(run, Eigen::Vector3d(1, 0, 0), 0),
                      "the command to point sensor eye has 3 angles, not 2 (azimuth, elevation)");
    CHECK_THROWS_WITH(command(run, Eigen::Vector2d(1, 2), 0), Catch::Contains("is no direction"));
    CHECK_THROWS_WITH(command(run, Eigen::Vector2d(1, 0), 0, 1, "deg"),
                      "the pointing of sensor eye is in rad, the command in deg");
    Simulated everywhere("{scans: 3}", {target("a", dot), eye("{}")});
    CHECK_THROWS_WITH(command(everywhere, Eigen::Vector2d(1, 0), 0),
                      "sensor eye has no field of view that could be pointed");
}
