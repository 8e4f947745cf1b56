#include "geojson_sink.hpp"

#include <cmath>

namespace sink_geojson {

namespace {

constexpr double degree = 3.14159265358979323846 / 180;
constexpr const char* opening = "{\"type\": \"FeatureCollection\", \"features\": [\n";

}  // namespace

void GeoJsonSink::describe(pelorus::Describe<GeoJsonSink>& plugin) {
    plugin.title("Tracks on the map")
        .purpose(
            "Writes each track as a line of a GeoJSON file (longitude, latitude, height on WGS84), with its id, start, "
            "end "
            "and the time of every position as properties, for any geographic information system. A track is written "
            "when it ends; those that live are kept in memory.")
        .source("H. Butler et al., The GeoJSON Format, RFC 7946, 2016; C. F. F. Karney, GeographicLib, LocalCartesian");
    plugin.parameter("file", &GeoJsonSink::name_)
        .initially("tracks.geojson")
        .doc("file, relative to the result folder");
    plugin.parameter("entries", &GeoJsonSink::entries_)
        .initially("confirmed")
        .choices({{"confirmed", "confirmed and coasting tracks"}, {"all", "tentative ones, too"}})
        .doc("which entries of the tracks make the lines");
    plugin.parameter("origin", &GeoJsonSink::origin_)
        .unit("rad, rad, m")
        .rows(3, 3)
        .doc(
            "latitude, longitude, height (WGS84) of the east-north-up frame that the tracks are in; left out where "
            "their "
            "frame stands on Earth");
    plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "estimates");
}

void GeoJsonSink::setup(const pelorus::Setup& setup) {
    file_.setup(setup, "file", name_);
    frames_ = setup.optional_service<plr_frames>();
    if (!origin_) return;
    const std::vector<double>& o = *origin_;
    if (!(std::abs(o[0]) <= 90 * degree * (1 + 1e-15)))
        throw pelorus::ParameterError("origin", "has a latitude beyond the poles");
    local_.emplace(o[0] / degree, o[1] / degree, o[2]);
}

/// Latitude, longitude (deg), height. Throws ArgumentError where the frame does not stand on Earth.
std::array<double, 3> GeoJsonSink::geodetic(const std::string& frame, const std::array<double, 3>& position) const {
    std::array<double, 3> g{};
    if (local_) {
        local_->Reverse(position[0], position[1], position[2], g[0], g[1], g[2]);
        return g;
    }
    plr_error error{};
    error.struct_size = sizeof error;
    if (frames_ == nullptr ||
        frames_->to_geodetic(frames_->context, frame.c_str(), position.data(), g.data(), &error) != PLR_OK)
        throw pelorus::ArgumentError(std::string(error.message) +
                                     "; tracks come onto the map with a frame that stands on Earth, or with `origin`");
    g[0] /= degree;
    g[1] /= degree;
    return g;
}

void GeoJsonSink::on_tracks(const pelorus::Event&, const plr_tracks& message) {
    any_ = true;
    const pelorus::Space space(*message.space);
    const int axes[] = {space.index("position.x"), space.index("position.y"), space.index("position.z")};
    if (axes[0] < 0 || axes[1] < 0)
        throw pelorus::ArgumentError("tracks have the components " + space.text() +
                                     ", expected position.x and position.y");
    for (std::int64_t i = 0; i < message.count; ++i) {
        const std::uint64_t id = message.ids[i];
        if (message.status[i] == PLR_TRACK_DELETED) {
            const auto ended = lines_.find(id);
            if (ended == lines_.end()) continue;
            write(id, ended->second);
            lines_.erase(ended);
            continue;
        }
        if (message.status[i] == PLR_TRACK_TENTATIVE && entries_ == Entries::confirmed) continue;
        std::array<double, 3> position{};
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (axes[axis] >= 0) position[axis] = pelorus::item(message.mean, i)(axes[axis], 0);
        const std::array<double, 3> place = geodetic(message.frame, position);
        Line& line = lines_[id];
        line.times.push_back(message.times[i]);
        line.positions.push_back(place);
    }
}

void GeoJsonSink::write_position(const std::array<double, 3>& position) {
    file_.write("[");
    file_.fixed(position[1], 7);  // 1 cm
    file_.write(", ");
    file_.fixed(position[0], 7);
    file_.write(", ");
    file_.fixed(position[2], 2);
    file_.write("]");
}

void GeoJsonSink::write(std::uint64_t id, const Line& line) {
    file_.write(file_.size() == 0 ? opening : ",\n");
    file_.write("{\"type\": \"Feature\", \"id\": ");
    file_.integer(id);
    file_.write(", \"properties\": {\"id\": ");
    file_.integer(id);
    file_.write(", \"start\": ");
    file_.seconds(line.times.front());
    file_.write(", \"end\": ");
    file_.seconds(line.times.back());
    file_.write(", \"times\": [");
    for (std::size_t i = 0; i < line.times.size(); ++i) {
        if (i > 0) file_.write(", ");
        file_.seconds(line.times[i]);
    }
    // A line has two positions at least.
    const bool point = line.positions.size() == 1;
    file_.write(point ? "]}, \"geometry\": {\"type\": \"Point\", \"coordinates\": "
                      : "]}, \"geometry\": {\"type\": \"LineString\", \"coordinates\": [");
    for (std::size_t i = 0; i < line.positions.size(); ++i) {
        if (i > 0) file_.write(", ");
        write_position(line.positions[i]);
    }
    file_.write(point ? "}}" : "]}}");
}

void GeoJsonSink::finish(const pelorus::Event&) {
    for (const auto& [id, line] : lines_) write(id, line);
    lines_.clear();
    if (!any_) return;
    if (file_.size() == 0) file_.write(opening);
    file_.write("\n]}\n");
    file_.finish();
}

}  // namespace sink_geojson
