/// sink.geojson: writes tracks as lines on the map. See README.md.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <GeographicLib/LocalCartesian.hpp>
#include <pelorus/result_file.hpp>
#include <pelorus/stage.hpp>

namespace sink_geojson {

enum class Entries { confirmed, all };

/// One track so far.
struct Line {
    std::vector<std::int64_t> times;               ///< ns
    std::vector<std::array<double, 3>> positions;  ///< latitude, longitude (deg), height (m)
    template <class Archive> void state(Archive& archive) { archive(times, positions); }
};

class GeoJsonSink : public pelorus::Stage<GeoJsonSink> {
public:
    static constexpr const char* kind = "sink";
    static void describe(pelorus::Describe<GeoJsonSink>& plugin);
    void setup(const pelorus::Setup& setup);

    void on_tracks(const pelorus::Event& event, const plr_tracks& message);
    void finish(const pelorus::Event& event);

    template <class Archive> void state(Archive& archive) { archive(file_, lines_, any_); }

private:
    std::array<double, 3> geodetic(const std::string& frame, const std::array<double, 3>& position) const;
    void write(std::uint64_t id, const Line& line);
    void write_position(const std::array<double, 3>& position);

    std::string name_;
    Entries entries_ = Entries::confirmed;
    std::optional<std::vector<double>> origin_;  // rad, rad, m
    std::optional<GeographicLib::LocalCartesian> local_;
    const plr_frames* frames_ = nullptr;

    pelorus::ResultFile file_;
    std::map<std::uint64_t, Line> lines_;  // tracks that have not ended
    bool any_ = false;                     // a message has come
};

}  // namespace sink_geojson
