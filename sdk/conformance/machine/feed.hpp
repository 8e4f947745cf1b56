/// Messages for the in ports of a stage, made from what the ports say that they want: a small world of targets that fly straight
/// on, a kilometre and more from one another, measured, tracked and known.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "bench.hpp"
#include "instance.hpp"

namespace pelorus::conformance {

/// What comes in at a port.
struct Delivery {
    std::uint32_t port = 0;
    std::int64_t tick = 0;
    std::shared_ptr<const plr_message> message;
};

struct FeedOptions {
    int targets = 3;
    int points = 0;  ///< measurements of a target in a scan; 0: 8 for a stage with a slot of kind `extent`, else 1
    std::int64_t ticks = 18;
    std::int64_t first_tick = 0;
    std::uint64_t first_id = 1;                           ///< of measurements
    double clutter = 0.2;                                 ///< probability of a false alarm a scan
    std::function<bool(int target, std::int64_t)> lives;  ///< absent: the third target ends after two thirds
    bool has_covariances = true, has_extents = true, has_lists = true;
    bool is_scan_timed = false;         ///< each measurement has a time of its own
    bool is_covariance_common = false;  ///< one covariance for all measurements
    std::int64_t ticks_a_message = 1;   ///< tracks and truth of so many ticks come in one message
};

constexpr std::int64_t feed_period = 1'000'000'000;  // ns

class Feed {
public:
    Feed(const Bench& bench, const Instance& instance, Sample sample, FeedOptions options = {});

    const std::vector<Delivery>& deliveries() const noexcept { return deliveries_; }
    /// The target that a measurement came from; -1: a false alarm.
    int target_of(std::uint64_t measurement) const;
    Eigen::Vector3d position(int target, std::int64_t time) const;
    /// Ports of a kind of message.
    static std::vector<std::uint32_t> ports_of(const Instance& instance, std::uint32_t kind);

private:
    void add(std::uint32_t kind, std::uint32_t port, std::int64_t tick);
    void add_scans(std::uint32_t port, const plr_port_type& type, std::int64_t tick);
    void add_tracks(std::uint32_t port, const plr_port_type& type, std::int64_t tick);
    void add_truth(std::uint32_t port, const plr_port_type& type, std::int64_t tick);
    void add_values(std::uint32_t port, std::int64_t tick);
    void add_table(std::uint32_t port, std::int64_t tick);
    void deliver(std::uint32_t port, std::int64_t tick, const plr_message& message);
    bool lives(int target, std::int64_t tick) const;
    std::vector<int> living(std::int64_t tick) const;
    std::vector<std::uint64_t> measurements_of(int target, std::int64_t tick) const;
    double component(const plr_component& component, int target, std::int64_t time) const;
    Eigen::VectorXd state(const plr_space& space, int target, std::int64_t time) const;

    const Bench& bench_;
    const Instance& instance_;
    mutable Sample sample_;
    FeedOptions options_;
    std::vector<Eigen::Vector3d> starts_, velocities_;
    std::map<std::uint64_t, int> origins_;                                     // of measurements
    std::map<std::pair<int, std::int64_t>, std::vector<std::uint64_t>> seen_;  // by target and tick
    std::vector<Delivery> deliveries_;
    std::uint64_t next_id_;
    Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();  // of the point that is measured, from the target's centre
};

/// The deviation of a measured component in the feed.
double deviation_of(const plr_component& component) noexcept;
/// What a port wants or carries. Fails the check if the stage does not say.
plr_port_type port_type_of(const Instance& instance, bool is_output, std::uint32_t port);

}  // namespace pelorus::conformance
