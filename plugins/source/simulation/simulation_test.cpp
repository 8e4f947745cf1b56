#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <set>

#include <Eigen/Dense>
#include <pelorus/sensor.hpp>

#include "simulation_rig.hpp"
#include "ticks.hpp"

namespace {

using namespace simulation_rig;

/// A sensor of range whose noise is the commanded waveform's only parameter.
struct Ranger : pelorus::Sensor<Ranger, 1, 3> {
    using Look = pelorus::Look;
    static constexpr std::uint32_t flags = PLR_SENSOR_WAVEFORM;
    static void describe(pelorus::Describe<Ranger>& plugin) { plugin.title("Ranger"); }
    pelorus::Space measurement_space() const { return {{{"range", "m"}}}; }
    pelorus::Space cartesian_space() const { return pelorus::position_space(3); }
    pelorus::Space waveform_space() const { return {{{"deviation", "m", 1.0, 1.0}}}; }
    Measurement measure(const Cartesian& x, const Look&) const { return Measurement::Constant(x.norm()); }
    Jacobian jacobian(const Cartesian& x, const Look&) const { return x.transpose() / x.norm(); }
    Noise noise(const Query& query, const Look&) const {
        const double deviation = query.waveform == nullptr ? 1.0 : *query.waveform;
        return Noise::Constant(deviation * deviation);
    }
};

/// Everything published, as text of all its numbers.
std::vector<double> numbers(const Bench& bench) {
    std::vector<double> out;
    for (const auto& p : bench.published) {
        out.push_back(static_cast<double>(p.message->time));
        const plr_const_view& v = p.port == scans ? p.scan().measurements : p.truth().state;
        for (std::int64_t i = 0; i < v.count; ++i)
            for (std::int64_t r = 0; r < v.rows; ++r) out.push_back(v.data[i * v.item_stride + r]);
        if (p.port == scans)
            for (std::int64_t i = 0; i < v.count; ++i) out.push_back(static_cast<double>(p.scan().ids[i]));
    }
    return out;
}

}  // namespace

TEST_CASE("simulation: tick k lies at round(k x period), never accumulated", "[simulation]") {
    CHECK(simulation::Clock(0.05).time(12000) == 600 * second);
    CHECK(simulation::Clock(1.0 / 3).time(3) == second);
    CHECK(simulation::Clock(1.0 / 3).time(1) == 333'333'333);
    CHECK(simulation::Clock(1e-9 / 3).time(5) == 2);
    CHECK(simulation::Clock(0.1).time(31'536'000'000) == 3'153'600'000 * second);
}

TEST_CASE("simulation: a run of a year at 1 MHz begins at once", "[simulation]") {
    Simulated run("{duration: 31536000 s, period: 1 us}", {target("a", dot), radar("r", "{}")});
    run.source->run(200);
    const auto seen = run.seen("r");
    REQUIRE(seen.size() == 200);
    CHECK(seen.back().time == 199'000);
}

TEST_CASE("simulation: a tick that ns cannot count never comes", "[simulation]") {
    CHECK(simulation::Clock(5e9).time(2) == std::numeric_limits<std::int64_t>::max());
    Simulated run("{duration: 8e9 s, period: 5e9 s}", {target("a", dot), radar("r", "{}")});
    run.source->run();
    CHECK(run.seen("r").size() == 2);
}

TEST_CASE("simulation: scans counts k = 0, duration tells the last tick, a sensor may have its own period",
          "[simulation]") {
    const std::vector<Part> parts{target("a", dot), radar("slow", "{}"), radar("fast", "{}", "{period: 0.25 s}")};
    Simulated by_count("{scans: 3, period: 1 s}", parts), by_time("{duration: 2 s, period: 1 s}", parts);
    by_count.source->run();
    by_time.source->run();
    CHECK(times_of(by_count.seen("slow")) == std::vector<std::int64_t>{0, second, 2 * second});
    CHECK(by_count.seen("fast").size() == 9);
    CHECK(by_count.seen("fast").back().time == 2 * second);
    CHECK(numbers(by_count.bench) == numbers(by_time.bench));
    // Truth once a time, before the scans of that time.
    std::set<std::int64_t> told;
    for (const auto& p : by_count.bench.published) {
        if (p.port == truth) CHECK(told.insert(p.message->time).second);
        if (p.port == scans) CHECK(told.count(p.message->time) == 1);
    }
    CHECK(told.size() == 9);
}

TEST_CASE("simulation: before first_scan, scans are empty", "[simulation]") {
    Simulated run("{scans: 4, first_scan: 2}",
                  {target("a", dot), radar("r", "{}"), radar("f", "{}", "{period: 0.5 s}")});
    run.source->run();
    const auto slow = run.seen("r"), fast = run.seen("f");
    REQUIRE(slow.size() == 4);
    for (std::size_t k = 0; k < 4; ++k) CHECK(slow[k].ids.size() == (k < 2 ? 0u : 1u));
    REQUIRE(fast.size() == 7);
    for (std::size_t k = 0; k < 7; ++k) CHECK(fast[k].ids.size() == (k < 2 ? 0u : 1u));  // its own ticks
}

TEST_CASE("simulation: ids are unique and truth tells where measurements come from", "[simulation]") {
    Simulated run("{scans: 20}",
                  {target("ship", airship, "{points_per_scan: 5}"), target("dot", dot),
                   radar("r", "{}", "{clutter: 3, clutter_min: [0 m, 0 m, 0 m], clutter_max: [9 m, 9 m, 9 m]}")});
    run.source->run();
    std::set<std::uint64_t> all, owned;
    std::size_t clutter = 0;
    for (const auto& p : run.bench.published) {
        if (p.port == scans) {
            for (std::int64_t i = 0; i < p.scan().measurements.count; ++i) {
                CHECK(all.insert(p.scan().ids[i]).second);
                if (owned.count(p.scan().ids[i]) > 0) continue;
                ++clutter;
                CHECK(pelorus::item(p.scan().measurements, i).maxCoeff() < 15);  // the box, and noise of 1 m
            }
            continue;
        }
        const plr_truth& t = p.truth();
        REQUIRE(t.count == 2);
        CHECK(t.ids[0] == 1);
        CHECK(t.ids[1] == 2);
        CHECK(t.measurement_offsets[1] == 5);
        CHECK(t.measurement_offsets[2] == 6);
        for (int k = 0; k < 6; ++k) CHECK(owned.insert(t.measurements[k]).second);
        CHECK(t.extent.data[0] > 80);  // along 45 degrees: (144 + 25) / 2
        CHECK(t.extent.data[9] == 0);  // a point beside an ellipsoid
        CHECK(t.parents[1] == 2);
    }
    CHECK(owned.size() == 120);
    CHECK(clutter > 30);
    CHECK(clutter < 100);
}

TEST_CASE("simulation: points lie as the extent says, and the noise as the sensor says", "[simulation]") {
    const bool uniform = GENERATE(false, true);
    const std::string spread = uniform ? "uniform" : "gaussian";
    Simulated run("{scans: 200}", {target("ship", airship, "{points_per_scan: 100, spread: " + spread + "}"),
                                   radar("r", "{noise: 2 m}")});
    run.source->run();
    MatrixXd sum = MatrixXd::Zero(3, 3);
    VectorXd mean = VectorXd::Zero(3);
    double farthest = 0;
    for (const Seen& seen : run.seen("r")) {
        const double way = static_cast<double>(seen.time / second) * 20 / std::sqrt(2.0);
        const MatrixXd offset = seen.points.colwise() - VectorXd(Eigen::Vector3d(way, way, 300));
        sum += offset * offset.transpose();
        mean += offset.rowwise().sum();
        farthest = std::max(farthest, offset.colwise().norm().maxCoeff());
    }
    const Eigen::Vector3d u(std::sqrt(0.5), std::sqrt(0.5), 0);
    const MatrixXd extent = 25 * MatrixXd::Identity(3, 3) + 119 * u * u.transpose();
    const MatrixXd expected = (uniform ? 0.2 : 1.0) * extent + 4 * MatrixXd::Identity(3, 3);
    CHECK((sum / 20000 - expected).norm() < 0.03 * expected.norm());
    CHECK((mean / 20000).norm() < 0.2);
    if (uniform) CHECK(farthest < 12 + 12);
}

TEST_CASE("simulation: a shared error is one a scan, others are one a point", "[simulation]") {
    const bool shared = GENERATE(false, true);
    const std::string slot = shared ? "{shared_error: true}" : "{}";
    Simulated quiet("{scans: 50}",
                    {target("ship", airship, "{points_per_scan: 8}"), radar("r", "{noise: 1e-9 m}", slot)});
    Simulated noisy("{scans: 50}", {target("ship", airship, "{points_per_scan: 8}"), radar("r", "{noise: 3 m}", slot)});
    quiet.source->run();
    noisy.source->run();
    const auto exact = quiet.seen("r"), measured = noisy.seen("r");
    double squares = 0, within = 0;
    for (std::size_t k = 0; k < 50; ++k) {
        const MatrixXd error = measured[k].points - exact[k].points;
        squares += error.squaredNorm() / 24;
        within += (error.colwise() - error.rowwise().mean()).squaredNorm();
    }
    CHECK(std::sqrt(squares / 50) == Approx(3).epsilon(shared ? 0.2 : 0.07));
    CHECK((within < 1e-6) == shared);
}

TEST_CASE("simulation: what one thing draws does not depend on what else there is", "[simulation]") {
    const Part ship = target("ship", airship, "{points_per_scan: 6}");
    Simulated alone("{scans: 10}", {ship, radar("r", "{}")});
    Simulated crowded("{scans: 10}",
                      {target("other", dot), ship,
                       radar("q", "{}", "{period: 0.5 s, clutter: 5, clutter_min: [0 m], clutter_max: [1 m]}"),
                       radar("r", "{}", "{detection_probability: 0.5}")});
    alone.source->run();
    crowded.source->run();
    const auto one = alone.seen("r"), many = crowded.seen("r");
    std::size_t kept = 0;
    for (std::size_t k = 0; k < 10; ++k) {
        // Every point that is still detected is the very same point.
        for (Eigen::Index i = 0; i < many[k].points.cols(); ++i) {
            const bool found = ((one[k].points.colwise() - many[k].points.col(i)).colwise().norm().minCoeff() == 0);
            kept += found;
        }
    }
    CHECK(kept > 15);
    CHECK(kept < 45);
}

TEST_CASE("simulation: false alarms arise in a box of the scene, or about where the objects are", "[simulation]") {
    const auto farthest = [](const std::string& about) {
        Simulated run("{scans: 60}", {target("ship", airship), target("other", airship),
                                      radar("r", "{}",
                                            "{detection_probability: 0, clutter: 8, clutter_min: [-9 m, -9 m, -9 m], "
                                            "clutter_max: [9 m, 9 m, 9 m]" +
                                                about + "}")});
        run.source->run();
        Eigen::Vector3d middle = Eigen::Vector3d::Zero();
        double far = 0, scans_seen = 0;
        for (const auto& p : run.bench.published) {
            if (p.port == truth) middle = pelorus::item(p.truth().state, 0).block<3, 1>(0, 0);
            if (p.port != scans) continue;
            ++scans_seen;
            for (std::int64_t i = 0; i < p.scan().measurements.count; ++i)
                far = std::max(
                    far,
                    (pelorus::item(p.scan().measurements, i).block<3, 1>(0, 0) - middle).lpNorm<Eigen::Infinity>());
        }
        CHECK(scans_seen == 60);
        return far;
    };
    CHECK(farthest(", clutter_about: targets") < 15);  // the box, and noise of 1 m
    CHECK(farthest(", clutter_about: targets") > 5);
    CHECK(farthest("") > 300);  // the ship flies at a height of 300 m
}

TEST_CASE("simulation: detection and loss happen as often as they should", "[simulation]") {
    Simulated run("{scans: 4000}", {target("a", dot, "{detection_probability: 0.8}"),
                                    radar("r", "{}", "{detection_probability: 0.5, drop: 0.25}")});
    run.source->run();
    const auto seen = run.seen("r");
    CHECK(static_cast<double>(seen.size()) == Approx(3000).epsilon(0.04));
    double hits = 0;
    for (const Seen& s : seen) hits += static_cast<double>(s.ids.size());
    CHECK(hits / static_cast<double>(seen.size()) == Approx(0.4).epsilon(0.08));
}

TEST_CASE("simulation: the same seed gives the same run, and a saved one goes on bit for bit", "[simulation]") {
    const std::vector<Part> parts{target("ship", airship, "{points_per_scan: 3}"), radar("r", "{}", "{drop: 0.1}"),
                                  radar("f", "{}", "{period: 0.3 s}")};
    Simulated whole("{scans: 90}", parts), again("{scans: 90}", parts), resumed("{scans: 90}", parts);
    whole.source->run();
    again.source->run();
    CHECK(numbers(whole.bench) == numbers(again.bench));
    for (const int events : {0, 1, 100}) {  // 100: within a block of states
        Simulated first("{scans: 90}", parts);
        first.source->run(events);
        Simulated second_half("{scans: 90}", parts);
        second_half.source->load(first.source->save());
        second_half.source->run();
        auto joined = numbers(first.bench);
        const auto rest = numbers(second_half.bench);
        joined.insert(joined.end(), rest.begin(), rest.end());
        CHECK(joined == numbers(whole.bench));
    }
}

TEST_CASE("simulation: saved state that is damaged or of another simulation is refused whole", "[simulation]") {
    Simulated run("{scans: 9}", {target("a", dot), radar("r", "{}")});
    run.source->run(4);
    auto bytes = run.source->save();
    Simulated other("{scans: 9}", {target("a", dot), radar("r", "{}"), radar("s", "{}")});
    CHECK_THROWS_WITH(other.source->load(bytes), Catch::Contains("saved state is"));
    bytes.back() ^= 1;
    CHECK_THROWS_WITH(run.source->load(bytes), "saved state is corrupt");
    CHECK(run.source->next().arrival == 4 * second);
}

TEST_CASE("simulation: a commanded waveform is obeyed at the next measurement, within its validity", "[simulation]") {
    const Part ranger{
        "sensors", "ranger",
        std::make_shared<const BenchInstance>(parts_bench(), pelorus::test::plugin_of<Ranger>("sensor.ranger"))};
    Simulated run("{scans: 6}", {target("a", dot), ranger});
    const auto command = [&](const char* address, double value, std::int64_t from, std::int64_t to) {
        pelorus::ValuesBuilder values;
        values.add(address, "waveform", "m", Eigen::MatrixXd::Constant(1, 1, value), from, to);
        run.source->receive(0, values.message(0));
    };
    command("ranger", 7, 2 * second, 3 * second);
    run.source->run();
    std::vector<double> told, deviations;
    for (const auto& p : run.bench.published)
        if (p.port == scans) {
            told.push_back(p.scan().waveform.data[0]);
            deviations.push_back(std::sqrt(p.scan().covariances.data[0]));
        }
    CHECK(told == std::vector<double>{1, 1, 7, 7, 1, 1});
    CHECK(deviations == told);
    CHECK_THROWS_WITH(command("nobody", 1, 0, 1),
                      "no sensor takes this command, and no model has an input of that name");
    Simulated plain("{scans: 6}", {target("a", dot), radar("r", "{}")});
    pelorus::ValuesBuilder values;
    values.add("r", "waveform", "m", Eigen::MatrixXd::Constant(1, 1, 1));
    CHECK_THROWS_WITH(plain.source->receive(0, values.message(0)), "sensor r has no waveform that could be commanded");
}

TEST_CASE("simulation: covariances can be left out", "[simulation]") {
    Simulated run("{scans: 2, covariances: false}", {target("a", dot), radar("r", "{}")});
    run.source->run();
    for (const auto& p : run.bench.published)
        if (p.port == scans) CHECK(p.scan().covariances.data == nullptr);
}

TEST_CASE("simulation: an object is told and seen only while it lives", "[simulation]") {
    Simulated run("{scans: 5}", {target("a", "{start: [0 m, 0 m, 0 m], speed: 1 m/s, birth: 1 s, death: 3 s}"),
                                 target("b", dot), radar("r", "{}")});
    run.source->run();
    const auto seen = run.seen("r");
    std::vector<std::size_t> counts;
    for (const Seen& s : seen) counts.push_back(s.ids.size());
    CHECK(counts == std::vector<std::size_t>{1, 2, 2, 1, 1});
}

TEST_CASE("simulation: what cannot be simulated is refused by name", "[simulation]") {
    const auto refusal = [](const std::string& with, const std::vector<Part>& parts) -> std::string {
        try {
            const Simulated run(with, parts);
            return "";
        } catch (const std::exception& problem) {
            return problem.what();
        }
    };
    const Part plane = target("flat", "{start: [0 m, 0 m], speed: 1 m/s}");
    CHECK(refusal("{}", {target("a", dot), radar("r", "{}")}) == "scans: give either scans or duration");
    CHECK(refusal("{scans: 1, duration: 1 s}", {target("a", dot), radar("r", "{}")}) ==
          "scans: give either scans or duration");
    CHECK(refusal("{scans: 1}", {target("a", dot, "{points_per_scan: 3}"), radar("r", "{}")}) ==
          "targets: target a gives 3 points a scan but has no extent that they could lie on");
    CHECK(refusal("{scans: 1}", {plane, radar("r", "{}")})
              .find("sensors: sensor r looks at position.z, which target flat has not") == 0);
    CHECK(refusal("{scans: 1}", {target("a", dot), radar("r", "{}", "{clutter: 1}")}) ==
          "sensors: sensor r has clutter; say where: clutter_min and clutter_max");
    CHECK(refusal("{duration: 8e9 s, period: 5 ns}", {target("a", dot), radar("r", "{}")})
              .find("period: is too short for") == 0);
    CHECK(refusal("{duration: 1 s, period: 0.1 ns}", {target("a", dot), radar("r", "{}")})
              .find("period: is too short: times are counted in ns") == 0);
    CHECK(refusal("{scans: 1}", {target("a", dot), plane, radar("r", "{dimension: 2}")}) ==
          "targets: targets a and flat move on different numbers of axes");
}

TEST_CASE("simulation: decoys have the object that released them for a parent, from when they are born",
          "[simulation]") {
    const auto cloud =
        part(parts_bench(), "trajectory", "release",
             "{start: [0 m, 0 m, 9 km], velocity: [100 m/s, 0 m/s, 0 m/s], decoys: 2, release_time: 1 s}");
    Simulated run("{scans: 3}", {target("first", dot), {"targets", "cloud", cloud, "{}"}, radar("r", "{}")});
    run.source->run();
    std::vector<const plr_truth*> told;
    for (const auto& published : run.bench.published)
        if (published.port == truth) told.push_back(&published.truth());
    REQUIRE(told.size() == 3);
    REQUIRE(told[0]->count == 2);
    REQUIRE(told[1]->count == 4);
    const std::uint64_t ids[] = {1, 2, 3, 4}, parents[] = {1, 2, 2, 2};
    for (std::size_t k = 0; k < 4; ++k) {
        CHECK(told[1]->ids[k] == ids[k]);
        CHECK(told[1]->parents[k] == parents[k]);
        CHECK(told[1]->births[k] == (k < 2 ? 0 : second));
    }
    CHECK(run.seen("r")[0].points.cols() == 2);
    CHECK(run.seen("r")[2].points.cols() == 4);
}
