/// A stage that makes one scan of those of several sensors at one time.
///
///     struct Mine : fusion::ScanFusion<Mine> {
///         static void describe(pelorus::Describe<Mine>& plugin);     // title, source, describe_scans(plugin)
///         void setup(const pelorus::Setup& setup);                   // calls setup_scans
///         bool fuse(const std::vector<fusion::Piece>& pieces, fusion::Fused& out) const;   // false: they cannot be
///     };
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <pelorus/caller.hpp>
#include <pelorus/stage.hpp>

#include "gathering.hpp"
#include "matching.hpp"

namespace fusion {

template <class Derived> class ScanFusion : public pelorus::Stage<Derived>, public GatheringParameters {
public:
    static constexpr const char* kind = "fusion";
    enum InPort : std::uint32_t { scans_in };
    enum OutPort : std::uint32_t { scans_out };

    std::vector<pelorus::Stream> in_streams(std::uint32_t port) const {
        return port == scans_in ? scan_in_streams() : std::vector<pelorus::Stream>();
    }
    std::vector<pelorus::Stream> out_streams(std::uint32_t) const { return scan_out_streams(); }

    void on_scan(const pelorus::Event& event, const plr_scan& scan) {
        if (sensors_.empty()) return count("scans_of_no_sensor", 1);
        Sight sight = read(event, scan);
        if (gathering_.has(sight.sensor, sight.time))
            throw pelorus::DataError(std::string("sensor ") + scan.sensor + " has told of this time already");
        while (auto meeting = gathering_.next(event.arrival)) tell(*meeting);
        if (gathering_.is_late(sight.time)) return count("scans_late", 1);
        gathering_.add(event.arrival, std::move(sight));
        while (auto meeting = gathering_.next(event.arrival)) tell(*meeting);
    }
    void finish(const pelorus::Event&) {
        while (auto meeting = gathering_.last()) tell(*meeting);
    }
    template <class Archive> void state(Archive& archive) { archive(gathering_); }

protected:
    static void describe_scans(pelorus::Describe<Derived>& plugin) {
        plugin.slot("sensors", "sensor", 0, -1,
                    "sensors whose scans are fused, by the names of the scans, as they stand in this node's frame");
        plugin.parameter("name", &ScanFusion::name_)
            .initially("fused")
            .doc("the sensor that the fused scans are said to be of");
        plugin.parameter("gate", &ScanFusion::gate_)
            .above(0)
            .doc("measurements pair up to this distance, in standard deviations of their difference; absent: to any");
        GatheringParameters::describe_gathering(plugin);
        plugin.in_port("scans", PLR_MESSAGE_SCAN, "of all sensors in the slot", PLR_PORT_MANY | PLR_PORT_OPTIONAL);
        plugin.out_port("scans", PLR_MESSAGE_SCAN, "fused: all components that any of the sensors measures");
    }
    void setup_scans(const pelorus::Setup& setup) {
        std::uint64_t scratch = 0;
        for (const auto& part : setup.parts<pelorus::SensorPart>("sensors")) {
            if (part.name().empty())
                throw pelorus::PartError("sensors", "has a part without a name; scans are told by it");
            const pelorus::Space measured(*part.info().measurement);
            sensors_.push_back({part, measured, common_.add(measured, "sensors")});
            scratch = std::max(scratch, part.info().scratch_bytes);
        }
        gathering_.setup(*this, static_cast<int>(sensors_.size()));
        caller_.setup(setup, static_cast<std::size_t>(scratch) + 4096);
        diagnostics_ = setup.template optional_service<plr_diagnostics>();
        frame_ = setup.frame();
    }
    std::vector<pelorus::Stream> scan_in_streams() const {
        std::vector<pelorus::Stream> out;
        for (const Sensor& sensor : sensors_) {
            out.emplace_back();
            out.back().sensor = sensor.part.name();
            out.back().space = sensor.measured;
            out.back().frame = frame_;
        }
        return out;
    }
    std::vector<pelorus::Stream> scan_out_streams() const {
        if (sensors_.empty()) return {};
        pelorus::Stream stream;
        stream.sensor = name_;
        stream.space = common_.space();
        stream.frame = frame_;
        return {stream};
    }
    const CommonSpace& common() const noexcept { return common_; }
    const std::string& frame() const noexcept { return frame_; }
    /// A squared distance; infinity where none is given.
    double gate() const noexcept { return gate_ ? *gate_ * *gate_ : std::numeric_limits<double>::infinity(); }
    void count(const char* name, std::int64_t by) const {
        if (diagnostics_ != nullptr) diagnostics_->count(diagnostics_->context, name, by);
    }

private:
    struct Sensor {
        pelorus::SensorPart part;
        pelorus::Space measured;
        std::vector<int> places;
    };
    /// Measurements that are taken for one object's.
    struct Group {
        std::uint64_t id = 0;
        std::vector<Piece> pieces;
    };

    Sight read(const pelorus::Event& event, const plr_scan& scan) {
        Sight sight;
        sight.time = event.time;
        sight.sensor = -1;
        for (std::size_t s = 0; s < sensors_.size(); ++s)
            if (sensors_[s].part.name() == scan.sensor) sight.sensor = static_cast<int>(s);
        if (sight.sensor < 0) throw pelorus::DataError(std::string("sensor ") + scan.sensor + " is in no slot");
        const pelorus::Space& measured = sensors_[static_cast<std::size_t>(sight.sensor)].measured;
        if (!measured.same(pelorus::Space(*scan.space)))
            throw pelorus::DataError(std::string("sensor ") + scan.sensor + " measures " + measured.text() +
                                     ", its scan has " + pelorus::Space(*scan.space).text());
        const bool has_noise = scan.covariances.data != nullptr;
        const Eigen::MatrixXd own = has_noise ? Eigen::MatrixXd() : own_noise(sight, scan);
        for (std::int64_t i = 0; i < scan.measurements.count; ++i)
            sight.sightings.push_back({scan.ids[i], pelorus::item(scan.measurements, i),
                                       has_noise ? Eigen::MatrixXd(pelorus::item(scan.covariances, i)) : own, 0});
        return sight;
    }
    /// The noise of a sensor whose noise is always the same. Throws DataError for another.
    Eigen::MatrixXd own_noise(const Sight& sight, const plr_scan& scan) {
        const Sensor& sensor = sensors_[static_cast<std::size_t>(sight.sensor)];
        if ((sensor.part.info().flags & PLR_SENSOR_CONSTANT_NOISE) == 0)
            throw pelorus::DataError("scans of sensor " + sensor.part.name() +
                                     " have no covariances, and its own noise is not always the same");
        Eigen::MatrixXd noise(sensor.measured.size(), sensor.measured.size());
        auto args = pelorus::arguments<plr_sensor_noise>();
        args.cartesian = args.snr = pelorus::absent_view();
        args.waveform = scan.waveform;
        args.out = pelorus::view(noise);
        caller_.require(sensor.part.call(&plr_sensor::noise, caller_.begin(sight.time, 1), args),
                        "sensors." + sensor.part.name() + ", noise");
        return noise;
    }

    std::vector<Group> grouped(const Meeting& meeting) const {
        std::vector<Group> groups;
        for (const Sight& sight : meeting.sights) {
            std::vector<Piece> pieces;
            for (const Sighting& sighting : sight.sightings)
                pieces.push_back(
                    {sensors_[static_cast<std::size_t>(sight.sensor)].places, sighting.value, sighting.covariance});
            std::vector<const Piece*> rows, columns;
            for (const Piece& piece : pieces) rows.push_back(&piece);
            for (const Group& group : groups) columns.push_back(&group.pieces.front());
            const auto partners = match(common_, rows, columns, gate());
            for (std::size_t i = 0; i < pieces.size(); ++i) {
                if (partners[i] == assignment::unassigned)
                    groups.push_back({sight.sightings[i].id, {std::move(pieces[i])}});
                else
                    groups[static_cast<std::size_t>(partners[i])].pieces.push_back(std::move(pieces[i]));
            }
        }
        return groups;
    }

    /// Whether the sensors that came determine all components.
    bool is_told(const Meeting& meeting) const {
        std::vector<bool> told(static_cast<std::size_t>(common_.size()));
        for (const Sight& sight : meeting.sights)
            for (const int place : sensors_[static_cast<std::size_t>(sight.sensor)].places)
                told[static_cast<std::size_t>(place)] = true;
        return std::find(told.begin(), told.end(), false) == told.end();
    }

    void tell(const Meeting& meeting) {
        const bool is_whole = meeting.sights.size() == sensors_.size();
        if (!is_whole && (alone == Alone::drop || !is_told(meeting))) return count("times_dropped", 1);
        if (!is_whole) count("times_not_whole", 1);
        pelorus::ScanBuilder builder(name_, frame_, common_.space());
        for (const Group& group : grouped(meeting)) {
            Fused fused;
            const bool is_alone = group.pieces.size() < sensors_.size();
            if (is_alone && alone == Alone::drop) {
                count("measurements_alone", 1);
            } else if (!this->derived().fuse(group.pieces, fused)) {
                count("measurements_not_fused", 1);
            } else {
                builder.add(group.id, fused.mean.data(), fused.covariance.data());
            }
        }
        this->publish(scans_out, builder.message(meeting.time));
    }

    std::string name_ = "fused";
    std::optional<double> gate_;

    std::vector<Sensor> sensors_;
    CommonSpace common_;
    pelorus::Caller caller_;
    const plr_diagnostics* diagnostics_ = nullptr;
    std::string frame_;
    Gathering gathering_;
};

}  // namespace fusion
