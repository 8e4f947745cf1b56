/// The services that the host hands to plugins (ABI headers log.h, random.h, publish.h, frames.h, parallel.h, output.h,
/// diagnostics.h).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include <pelorus/abi/abi.h>

#include "host/guard/fault.hpp"

namespace spdlog {
class logger;
}

namespace pelorus::host {

/// Where the publish service of a stage leads; the runtime implements it.
class Publisher {
public:
    virtual ~Publisher() = default;
    virtual plr_status publish(std::uint32_t port, const plr_message& message, plr_error* error) = 0;
};

/// Frames of reference of one graph (ABI frames.h). "" is the root frame. Built by one thread; then the service may be
/// called by any number of them.
class FrameTree {
public:
    FrameTree();
    FrameTree(const FrameTree&) = delete;
    FrameTree& operator=(const FrameTree&) = delete;

    /// Adds a frame at p_parent = C p + t; C column-major. Throws std::invalid_argument: doubled or empty name, unknown parent, C
    /// no rotation.
    void add_local(const std::string& name, const std::string& parent, const double rotation[9],
                   const double translation[3]);
    /// Adds a local east-north-up frame at a geodetic origin (rad, rad, m above the WGS84 ellipsoid). Throws
    /// std::invalid_argument: doubled or empty name, no such place.
    void add_geodetic(const std::string& name, double latitude, double longitude, double height);
    bool contains(const std::string& name) const;
    const plr_frames& service() const noexcept { return service_; }

private:
    struct Pose {  // p_outer = rotation p + translation; rotation column-major
        double rotation[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
        double translation[3] = {0, 0, 0};
    };
    // Local frames are kept relative to their anchor, the root or geodetic frame that they hang on: relative to the Earth's
    // centre a millimetre would drown in a radius of 6.4e6 m.
    struct Frame {
        std::string anchor;
        Pose to_anchor;
    };
    const Frame* require(const char* name, plr_error* error) const;
    const Pose* require_earth(const char* name, const Frame& frame, plr_error* error) const;
    static plr_status transform(void*, const char*, const char*, std::int64_t, plr_frame_pose*, plr_error*) noexcept;
    static plr_status from_geodetic(void*, const char*, const double*, double*, plr_error*) noexcept;
    static plr_status to_geodetic(void*, const char*, const double*, double*, plr_error*) noexcept;

    std::map<std::string, Frame, std::less<>> frames_;
    std::map<std::string, Pose> origins_;  // of geodetic frames: to Earth-centred, Earth-fixed
    plr_frames service_{};
};

/// A fixed set of threads behind plr_parallel; the thread that calls run() is one of them. Runs of several callers follow one
/// another. Blocks after a failed one may or may not run.
class ThreadPool {
public:
    /// 0 threads: as many as the machine has cores. Throws Error (Exit::run_failed) if the system refuses them.
    explicit ThreadPool(unsigned threads);
    ~ThreadPool();
    ThreadPool(const ThreadPool&) = delete;
    ThreadPool& operator=(const ThreadPool&) = delete;
    const plr_parallel& service() const noexcept { return service_; }

private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
    plr_parallel service_{};
};

/// The counter-based generator (ABI random.h).
const plr_random& random_service() noexcept;
/// The key of a node: (seed, run, node name).
plr_key node_key(std::uint64_t seed, std::uint64_t run, const std::string& node) noexcept;

/// The plr_host of one instance. Its address must not change: keep it behind a pointer.
class InstanceHost {
public:
    struct Shared {
        const FrameTree* frames = nullptr;
        const ThreadPool* pool = nullptr;
        const std::string* output_folder = nullptr;    ///< absolute; nullptr or empty: no files are kept
        std::shared_ptr<FaultLatch> faults = nullptr;  ///< of the stage's tree, or nullptr: models are not guarded
    };
    InstanceHost(std::string address, std::string plugin_id, Shared shared);
    ~InstanceHost();
    InstanceHost(const InstanceHost&) = delete;
    InstanceHost& operator=(const InstanceHost&) = delete;

    const plr_host* host() const noexcept { return &host_; }
    const plr_log* log() const noexcept { return &log_; }
    /// The runtime connects stages before the first call; models never get one.
    void connect(Publisher* publisher) noexcept { publisher_ = publisher; }
    const std::string& address() const noexcept { return address_; }
    const std::string& plugin_id() const noexcept { return plugin_id_; }
    /// What the guard finds wrong with the models of the stage's tree, or nullptr.
    const FaultLatch* faults() const noexcept { return shared_.faults.get(); }

    struct Gauge {
        std::string unit;
        double value = 0;
    };
    /// Copies of what the plugin has told so far. Thread-safe.
    std::map<std::string, std::int64_t> counters() const;
    std::map<std::string, Gauge> gauges() const;
    /// Puts back what a snapshot kept. Thread-safe.
    void restore(std::map<std::string, std::int64_t> counters, std::map<std::string, Gauge> gauges);

private:
    static const void* service(const plr_host*, const char* id) noexcept;
    static plr_status publish(void*, std::uint32_t, const plr_message*, plr_error*) noexcept;
    static void write_log(void*, std::int32_t, const char*) noexcept;
    static void count(void*, const char*, std::int64_t) noexcept;
    static void gauge(void*, const char*, const char*, double) noexcept;
    static const char* output_folder(void*) noexcept;

    std::string address_, plugin_id_;
    Shared shared_;
    Publisher* publisher_ = nullptr;
    std::shared_ptr<spdlog::logger> logger_;
    mutable std::mutex diagnostics_mutex_;
    std::map<std::string, std::int64_t> counters_;
    std::map<std::string, Gauge> gauges_;
    plr_host host_{};
    plr_log log_{};
    plr_publish publish_{};
    plr_diagnostics diagnostics_{};
    plr_output output_{};
};

/// Log level by name (trace, debug, info, warning, error; info unless set) of what is created from now on: set it before the
/// graph is built. Throws Error (Exit::misuse) for another name. The log goes to standard error through spdlog.
void set_log_level(const std::string& name);

}  // namespace pelorus::host
