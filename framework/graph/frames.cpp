#include "graph/frames.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "graph/names.hpp"
#include "graph/units.hpp"

namespace pelorus::graph {

namespace {

using Matrix = std::array<double, 9>;  // column-major

struct FrameText {
    std::string name;
    Location where, parent_where;
    bool geodetic = false;
    std::array<double, 3> origin{};  // rad, rad, m
    std::string parent;
    std::array<double, 3> translation{};
    Matrix rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};
};

Matrix from_attitude(const std::array<double, 3>& attitude) {
    const double cr = std::cos(attitude[0]), sr = std::sin(attitude[0]);
    const double cp = std::cos(attitude[1]), sp = std::sin(attitude[1]);
    const double cy = std::cos(attitude[2]), sy = std::sin(attitude[2]);
    return {cy * cp,
            sy * cp,
            -sp,
            cy * sp * sr - sy * cr,
            sy * sp * sr + cy * cr,
            cp * sr,
            cy * sp * cr + sy * sr,
            sy * sp * cr - cy * sr,
            cp * cr};
}

Matrix from_quaternion(double w, double x, double y, double z) {
    return {1 - 2 * (y * y + z * z), 2 * (x * y + w * z),     2 * (x * z - w * y),
            2 * (x * y - w * z),     1 - 2 * (x * x + z * z), 2 * (y * z + w * x),
            2 * (x * z + w * y),     2 * (y * z - w * x),     1 - 2 * (x * x + y * y)};
}

class FrameReader {
public:
    explicit FrameReader(Problems& problems) : problems_(problems) {}

    /// The frame, and in `json` what it says in SI.
    FrameText read(const Value::Entry& entry, nlohmann::ordered_json& json) {
        label_ = "frames." + entry.key;
        FrameText frame;
        frame.name = entry.key;
        frame.where = frame.parent_where = entry.where;
        const std::string problem = name_problem(entry.key, "frame");
        if (!problem.empty()) problems_.add(entry.where, problem);
        json = nlohmann::ordered_json::object();
        if (!entry.value.is_map()) {
            problems_.add(entry.value.where,
                          label_ +
                              ": expected a map such as {origin: [43 deg, 6 deg, 12 m]} or {parent: site, "
                              "translation: [0 m, 0 m, 20 m]}, got " +
                              entry.value.described());
            return frame;
        }
        check_keys(entry.value);
        if (const Value* origin = entry.value.find("origin"))
            read_geodetic(*origin, frame, json);
        else
            read_local(entry.value, frame, json);
        return frame;
    }

private:
    void check_keys(const Value& map) {
        static const std::vector<std::string> local{"parent", "translation", "attitude", "quaternion"};
        static const std::vector<std::string> all{"origin", "parent", "translation", "attitude", "quaternion"};
        const bool geodetic = map.find("origin") != nullptr;
        for (const Value::Entry& entry : map.map) {
            if (std::find(all.begin(), all.end(), entry.key) == all.end())
                problems_.add(entry.where,
                              label_ + ": unknown key '" + entry.key + "'" + suggestion(entry.key, all, "keys"));
            else if (geodetic && entry.key != "origin")
                problems_.add(entry.where, label_ + ": a frame with an origin has no " + entry.key +
                                               "; put a second frame below it");
        }
        if (map.find("attitude") != nullptr && map.find("quaternion") != nullptr)
            problems_.add(map.find("quaternion")->where, label_ + ": give attitude or quaternion, not both");
    }

    template <std::size_t N>
    bool numbers(const Value& value, const std::string& key, const std::array<const char*, N>& units,
                 std::array<double, N>& out) {
        const std::string label = label_ + "." + key;
        if (!value.is_list() || value.list.size() != N) {
            problems_.add(value.where, label + ": expected a list of " + std::to_string(N) + " numbers, got " +
                                           (value.is_list() ? std::to_string(value.list.size()) : value.described()));
            return false;
        }
        bool good = true;
        for (std::size_t i = 0; i < N; ++i) {
            const Value& item = value.list[i];
            const std::string element = label + "[" + std::to_string(i) + "]: ";
            try {
                if (!item.is_scalar()) throw UnitError("expected a number, got " + item.described());
                out[i] = parse_quantity(item.scalar, units[i]);
            } catch (const UnitError& error) {
                problems_.add(item.where, element + error.what());
                good = false;
            }
        }
        return good;
    }

    void read_geodetic(const Value& origin, FrameText& frame, nlohmann::ordered_json& json) {
        frame.geodetic = true;
        if (!numbers<3>(origin, "origin", {"rad", "rad", "m"}, frame.origin)) return;
        constexpr double right_angle = 1.57079632679489661923;
        if (std::abs(frame.origin[0]) > right_angle)
            problems_.add(origin.list[0].where, label_ + ".origin[0]: a latitude is between -90 and 90 deg, got " +
                                                    origin.list[0].described() +
                                                    " (a number without a unit is in rad)");
        if (std::abs(frame.origin[1]) > 4 * right_angle)
            problems_.add(origin.list[1].where, label_ + ".origin[1]: a longitude is between -360 and 360 deg, got " +
                                                    origin.list[1].described() +
                                                    " (a number without a unit is in rad)");
        json["origin"] = frame.origin;
    }

    void read_local(const Value& map, FrameText& frame, nlohmann::ordered_json& json) {
        if (const Value* parent = map.find("parent")) {
            frame.parent_where = parent->where;
            if (parent->is_scalar())
                frame.parent = parent->scalar;
            else
                problems_.add(parent->where,
                              label_ + ".parent: expected the name of a frame, got " + parent->described());
        }
        if (const Value* translation = map.find("translation"))
            numbers<3>(*translation, "translation", {"m", "m", "m"}, frame.translation);
        json["parent"] = frame.parent;
        json["translation"] = frame.translation;
        if (const Value* attitude = map.find("attitude")) {
            std::array<double, 3> angles{};
            if (numbers<3>(*attitude, "attitude", {"rad", "rad", "rad"}, angles))
                frame.rotation = from_attitude(angles);
            json["attitude"] = angles;
        } else if (const Value* quaternion = map.find("quaternion")) {
            std::array<double, 4> q{1, 0, 0, 0};
            if (numbers<4>(*quaternion, "quaternion", {"", "", "", ""}, q)) set_quaternion(*quaternion, q, frame);
            json["quaternion"] = q;
        }
    }

    void set_quaternion(const Value& value, const std::array<double, 4>& q, FrameText& frame) {
        const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        if (std::abs(norm - 1) > 1e-6) {
            problems_.add(value.where, label_ + ".quaternion: its norm is " + std::to_string(norm) +
                                           ", expected 1 (order w, x, y, z)");
            return;
        }
        frame.rotation = from_quaternion(q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm);
    }

    Problems& problems_;
    std::string label_;
};

/// Adds frames parents first; a chain of parents that comes back to itself is a problem.
class FrameAdder {
public:
    FrameAdder(const std::vector<FrameText>& frames, host::FrameTree& tree, Problems& problems)
        : tree_(tree), problems_(problems) {
        for (const FrameText& frame : frames) {
            by_name_.emplace(frame.name, &frame);
            names_.push_back(frame.name);
        }
    }

    void add(const FrameText& frame) {
        if (done_.count(frame.name) != 0) return;
        for (std::size_t i = 0; i < path_.size(); ++i) {
            if (path_[i] != frame.name) continue;
            std::vector<std::string> circle(path_.begin() + static_cast<std::ptrdiff_t>(i), path_.end());
            circle.push_back(frame.name);
            problems_.add(frame.parent_where, "frames stand on each other in a circle: " + join(circle, " -> "));
            return;
        }
        path_.push_back(frame.name);
        if (!frame.parent.empty()) add_parent(frame);
        path_.pop_back();
        if (!done_.insert(frame.name).second) return;
        if (frame.geodetic)
            tree_.add_geodetic(frame.name, frame.origin[0], frame.origin[1], frame.origin[2]);
        else if (frame.parent.empty() || tree_.contains(frame.parent))
            tree_.add_local(frame.name, frame.parent, frame.rotation.data(), frame.translation.data());
    }

private:
    void add_parent(const FrameText& frame) {
        const auto parent = by_name_.find(frame.parent);
        if (parent != by_name_.end())
            add(*parent->second);
        else
            problems_.add(frame.parent_where, "frames." + frame.name + ".parent: there is no frame '" + frame.parent +
                                                  "'" + suggestion(frame.parent, names_, "frames"));
    }

    host::FrameTree& tree_;
    Problems& problems_;
    std::map<std::string, const FrameText*> by_name_;
    std::vector<std::string> names_, path_;
    std::set<std::string> done_;
};

}  // namespace

nlohmann::ordered_json read_frames(const Value* block, host::FrameTree& tree, Problems& problems) {
    auto json = nlohmann::ordered_json::object();
    if (block == nullptr) return json;
    if (!block->is_map()) {
        problems.add(block->where, "frames: expected a map from name to frame, got " + block->described());
        return json;
    }
    const std::size_t before = problems.count();
    std::vector<FrameText> frames;
    FrameReader reader(problems);
    for (const Value::Entry& entry : block->map) frames.push_back(reader.read(entry, json[entry.key]));
    if (problems.count() != before) return json;
    FrameAdder adder(frames, tree, problems);
    for (const FrameText& frame : frames) adder.add(frame);
    return json;
}

}  // namespace pelorus::graph
