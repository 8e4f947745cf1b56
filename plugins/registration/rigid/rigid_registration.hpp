/// registration.rigid: moves scans and tracks into other axes. See README.md.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include <pelorus/stage.hpp>

#include "local_sensor.hpp"
#include "sensor_move.hpp"

namespace rigid {

enum class Direction { forward, inverse };
enum class Derivatives { position, velocity, acceleration };

class RigidRegistration : public pelorus::Stage<RigidRegistration>, public Placement {
public:
    static constexpr const char* kind = "registration";
    enum InPort : std::uint32_t { scans_in, tracks_in, inputs_in };
    enum OutPort : std::uint32_t { scans_out, tracks_out };

    static void describe(pelorus::Describe<RigidRegistration>& plugin);
    void setup(const pelorus::Setup& setup);
    std::vector<pelorus::Stream> in_streams(std::uint32_t port) const;
    std::vector<pelorus::Stream> out_streams(std::uint32_t port) const;
    std::uint32_t passes_on(std::uint32_t port) const { return port == scans_out ? 1 + scans_in : 0; }

    void on_scan(const pelorus::Event& event, const plr_scan& scan);
    void on_tracks(const pelorus::Event& event, const plr_tracks& tracks);
    void on_values(const pelorus::Event& event, const plr_values& values);

    template <class Archive> void state(Archive& archive) { archive(caller_); }

private:
    pelorus::Space track_space() const;
    void find_sensors(const pelorus::Setup& setup);
    /// From the axes of `frame` into this node's.
    Motion motion_from(const char* frame, std::int64_t time) const;
    /// Whether a local sensor stands where this node's axes do; once.
    void check_local(const plr_scan& scan, std::int64_t time);
    void check_plane(const Motion& motion, const std::string& sensor) const;
    void send(std::int64_t time, const plr_scan& scan);
    void send(std::int64_t time, const plr_tracks& tracks);

    Direction direction_ = Direction::forward;
    Covariance covariance_ = Covariance::transformed;
    Derivatives derivatives_ = Derivatives::velocity;

    std::map<std::string, SensorMove> moved_;
    std::map<std::string, pelorus::Space> measured_;
    std::map<std::string, LocalSensor> local_;
    std::set<std::string> checked_;  ///< of the local ones, since this instance began
    Motion given_;                   ///< where the parameters tell it
    pelorus::Caller caller_;
    std::string frame_;
    const plr_frames* frames_ = nullptr;
    const plr_diagnostics* diagnostics_ = nullptr;
};

}  // namespace rigid
