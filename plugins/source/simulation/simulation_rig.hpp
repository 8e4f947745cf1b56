// A simulation that has run, and the parts that it is made of: for its tests.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include "../../../tests/support/airship_parts.hpp"

namespace simulation_rig {

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;
enum Port : std::uint32_t { scans, truth };

struct Seen {
    std::int64_t time, arrival;
    MatrixXd points;  ///< a column a measurement
    std::vector<std::uint64_t> ids;
};

/// A simulation that has run to its end.
struct Simulated {
    Bench bench;
    std::unique_ptr<StageUnderTest> source;

    explicit Simulated(const std::string& with, const std::vector<Part>& parts = {}) {
        source = std::make_unique<StageUnderTest>(bench, plugin("source", "simulation"), with, parts);
    }
    std::vector<Seen> seen(const std::string& sensor) const {
        std::vector<Seen> out;
        for (const auto& published : bench.published) {
            if (published.port != scans || published.scan().sensor != sensor) continue;
            const plr_scan& scan = published.scan();
            Seen one{published.message->time,
                     published.message->arrival,
                     MatrixXd(scan.measurements.rows, scan.measurements.count),
                     {}};
            for (std::int64_t i = 0; i < scan.measurements.count; ++i) {
                one.points.col(i) = pelorus::item(scan.measurements, i);
                one.ids.push_back(scan.ids[i]);
            }
            out.push_back(one);
        }
        return out;
    }
};

inline Bench& parts_bench() {
    static Bench bench;
    return bench;
}
inline Part target(const std::string& name, const std::string& path, const std::string& slot = "{}") {
    return {"targets", name, part(parts_bench(), "trajectory", "legs", path), slot};
}
inline Part radar(const std::string& name, const std::string& model, const std::string& slot = "{}") {
    return {"sensors", name, part(parts_bench(), "sensor", "position", model), slot};
}
inline const std::string airship =
    "{start: [0 m, 0 m, 300 m], speed: 20 m/s, heading: 45 deg, semi_axes: [12 m, 5 m, 5 m]}";
inline const std::string dot = "{start: [0 m, 0 m, 300 m], speed: 20 m/s}";

inline std::vector<std::int64_t> times_of(const std::vector<Seen>& scans_seen) {
    std::vector<std::int64_t> out;
    for (const Seen& s : scans_seen) out.push_back(s.time);
    return out;
}

}  // namespace simulation_rig
