/// A registration stage in a test, fed with scans of single measurements; what it tells is read back.
#pragma once

#include <pelorus/pelorus.hpp>

#include "../../../tests/fixtures/stage_bench.hpp"
#include <catch2/catch.hpp>

namespace streams_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using pelorus::test::StageUnderTest;

inline std::int64_t ns(double seconds) { return std::llround(seconds * 1e9); }

/// Range and azimuth, in another frame than the root.
inline pelorus::Space polar() { return pelorus::Space({{"range", "m"}, {"azimuth", "rad", 0, 0, true}}); }

inline VectorXd vector(std::initializer_list<double> numbers) {
    VectorXd out(static_cast<Eigen::Index>(numbers.size()));
    std::copy(numbers.begin(), numbers.end(), out.data());
    return out;
}

struct Told {
    std::string sensor;
    std::int64_t time;
    std::uint64_t id;
    VectorXd value;
    MatrixXd covariance;
    bool operator==(const Told& other) const {
        return sensor == other.sensor && time == other.time && id == other.id && value == other.value &&
               covariance == other.covariance;
    }
};

template <class Stage> struct StreamRig {
    pelorus::test::Bench bench;
    StageUnderTest stage;
    pelorus::Space space = polar();
    MatrixXd covariance = vector({25, 1e-6}).asDiagonal();
    std::uint64_t last_id = 0;

    StreamRig(const char* id, const std::string& with) : stage(bench, pelorus::test::plugin_of<Stage>(id), with) {}

    /// One measurement with the stamp `time`, at `arrival` (s).
    void send(const std::string& sensor, double time, const VectorXd& value, double arrival) {
        pelorus::ScanBuilder scan(sensor, "site", space);
        scan.add(++last_id, value.data(), covariance.data());
        stage.receive(0, scan.message(ns(time)), ns(arrival));
    }
    void send(const std::string& sensor, double time, const VectorXd& value) { send(sensor, time, value, time); }
    void send_empty(const std::string& sensor, double time) {
        pelorus::ScanBuilder scan(sensor, "site", space);
        stage.receive(0, scan.message(ns(time)));
    }
    void eo(double time, double range = 0) { send_range("eo", time, range); }
    void radar(double time) { send_range("radar", time, 1000); }
    void send_range(const std::string& sensor, double time, double range) {
        VectorXd value = VectorXd::Zero(space.size());
        value(0) = range;
        send(sensor, time, value);
    }

    /// All that has been published, or that of one sensor.
    std::vector<Told> told(const std::string& sensor = "") const {
        std::vector<Told> out;
        for (const auto& published : bench.published) {
            const plr_scan& scan = published.scan();
            if (!sensor.empty() && sensor != scan.sensor) continue;
            REQUIRE(scan.measurements.count == 1);
            CHECK(std::string(scan.frame) == "site");
            out.push_back({scan.sensor, published.message->time, scan.ids[0], pelorus::item(scan.measurements, 0),
                           pelorus::item(scan.covariances, 0)});
        }
        return out;
    }
    /// `radar 2, eo 2`: what was published, in its order.
    std::string order() const {
        std::string out;
        for (const Told& each : told()) {
            char line[64];
            std::snprintf(line, sizeof line, "%s %g", each.sensor.c_str(), static_cast<double>(each.time) * 1e-9);
            out += (out.empty() ? "" : ", ") + std::string(line);
        }
        return out;
    }
    std::int64_t counted(const std::string& what) const {
        const auto found = bench.counters.find(what);
        return found == bench.counters.end() ? 0 : found->second;
    }
};

}  // namespace streams_test
