/// A fusion in a test: of a radar (range, azimuth, zenith) and a camera (azimuth, zenith), or of others; and of tracks of positions in
/// the plane.
#pragma once

#include <cmath>

#include <catch2/catch.hpp>

#include "../../../tests/support/airship_parts.hpp"
#include "gathering.hpp"

namespace fusion_rig {

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

inline VectorXd vector(std::initializer_list<double> numbers) {
    VectorXd out(static_cast<Eigen::Index>(numbers.size()));
    std::copy(numbers.begin(), numbers.end(), out.data());
    return out;
}
inline MatrixXd diagonal(std::initializer_list<double> variances) { return vector(variances).asDiagonal(); }

struct Told {
    std::int64_t time;
    std::vector<std::uint64_t> ids;
    std::vector<VectorXd> means;
    std::vector<MatrixXd> covariances;
};

template <class Fusion> struct Rig {
    Bench bench;
    std::map<std::string, pelorus::Space> spaces;
    std::unique_ptr<StageUnderTest> stage;

    /// Sensors by name: kind and parameters.
    Rig(const char* id, const std::string& with,
        const std::vector<std::array<std::string, 3>>& sensors = {
            {"radar", "spherical", "{angle: zenith, noise: [5 m, 3 mrad, 3 mrad]}"},
            {"eo", "bearings", "{angle: zenith, noise: 10 urad}"}}) {
        std::vector<Part> parts;
        for (const auto& [name, kind, parameters] : sensors) {
            const auto sensor = part(bench, "sensor", kind, parameters);
            spaces.emplace(name,
                           pelorus::Space(*sensor->template table<plr_sensor>().info(sensor->self())->measurement));
            parts.push_back({"sensors", name, sensor});
        }
        stage = std::make_unique<StageUnderTest>(bench, pelorus::test::plugin_of<Fusion>(id), with, parts, "eo");
    }

    struct Seen {
        std::uint64_t id;
        VectorXd value;
        MatrixXd covariance;  ///< empty: none
    };
    void scan(const std::string& sensor, double time, const std::vector<Seen>& seen, double arrival = -1) {
        pelorus::ScanBuilder builder(sensor, "eo", spaces.at(sensor));
        for (const Seen& one : seen)
            builder.add(one.id, one.value.data(), one.covariance.size() == 0 ? nullptr : one.covariance.data());
        stage->receive(Fusion::scans_in, builder.message(std::llround(time * 1e9)),
                       std::llround((arrival < 0 ? time : arrival) * 1e9));
    }
    struct Track {
        std::uint64_t id;
        VectorXd mean;
        MatrixXd covariance;
        std::int32_t status = PLR_TRACK_CONFIRMED;
    };
    /// Of the tracker at that port.
    void tracks(std::uint32_t port, double time, const std::vector<Track>& all, double arrival = -1) {
        pelorus::TracksBuilder builder("eo", pelorus::position_space(2));
        for (const Track& track : all) {
            pelorus::TrackEntry entry;
            entry.id = track.id;
            entry.time = std::llround(time * 1e9);
            entry.status = track.status;
            entry.mean = track.mean.data();
            entry.covariance = track.covariance.data();
            builder.add(entry);
        }
        stage->receive(port, builder.message(std::llround(time * 1e9)),
                       std::llround((arrival < 0 ? time : arrival) * 1e9));
    }
    /// The fused tracks of the last message.
    std::vector<Track> fused() const {
        std::vector<Track> out;
        const plr_tracks& tracks = bench.published.back().tracks();
        for (std::int64_t i = 0; i < tracks.count; ++i)
            out.push_back(
                {tracks.ids[i], pelorus::item(tracks.mean, i), pelorus::item(tracks.covariance, i), tracks.status[i]});
        return out;
    }
    std::vector<Told> told() const {
        std::vector<Told> out;
        for (const auto& published : bench.published) {
            if (published.message->kind != PLR_MESSAGE_SCAN) continue;
            const plr_scan& scan = published.scan();
            Told one{published.message->time, {}, {}, {}};
            for (std::int64_t i = 0; i < scan.measurements.count; ++i) {
                one.ids.push_back(scan.ids[i]);
                one.means.emplace_back(pelorus::item(scan.measurements, i));
                one.covariances.emplace_back(pelorus::item(scan.covariances, i));
            }
            out.push_back(std::move(one));
        }
        return out;
    }
};

/// Positive definite, with all correlations.
inline MatrixXd full(Eigen::Index n, int seed) {
    MatrixXd root(n, n);
    for (Eigen::Index i = 0; i < root.size(); ++i)
        root.data()[i] = std::sin(1.0 + 3.7 * static_cast<double>(i) + 11.3 * seed);
    return root * root.transpose() + 0.2 * MatrixXd::Identity(n, n);
}

}  // namespace fusion_rig
