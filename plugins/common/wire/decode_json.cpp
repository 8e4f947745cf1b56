#include <algorithm>
#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include "decode.hpp"
#include "text.hpp"

namespace wire {

namespace {

using nlohmann::json;

constexpr int deepest = 6;  // measurements are three deep; nothing needs more

/// One line as an object: no key twice, no deep nesting, no number that a double cannot hold, UTF-8.
json parse(std::string_view line) {
    std::set<std::string> keys;
    const auto watch = [&](int depth, json::parse_event_t event, json& parsed) {
        if (depth > deepest) throw BadFrame("is nested too deep");
        if (event == json::parse_event_t::key && depth == 1 && !keys.insert(parsed.get<std::string>()).second)
            throw BadFrame("has the key '" + shown(parsed.get<std::string>()) + "' twice");
        return true;
    };
    try {
        json object = json::parse(line, watch);
        if (!object.is_object()) throw BadFrame("is no JSON object");
        return object;
    } catch (const json::exception& problem) {
        const std::string text = problem.what();
        const auto end = text.find("] ");
        throw BadFrame("is no JSON: " + shown(end == std::string::npos ? text : text.substr(end + 2), 200));
    }
}

/// Reads an object key by key, and knows which keys nobody asked for.
class Reader {
public:
    explicit Reader(const json& object) : object_(object) {}

    bool has(const char* key) { return find(key) != nullptr; }
    const json* find(const char* key) {
        known_.insert(key);
        const auto found = object_.find(key);
        return found == object_.end() || found->is_null() ? nullptr : &*found;
    }
    const json& need(const char* key) {
        const json* found = find(key);
        if (found == nullptr) throw BadFrame(std::string(key) + " is missing");
        return *found;
    }
    std::string text(const char* key) {
        const json& value = need(key);
        if (!value.is_string()) throw BadFrame(std::string(key) + " is no text");
        return value.get<std::string>();
    }
    const json& list(const char* key) {
        const json& value = need(key);
        if (!value.is_array()) throw BadFrame(std::string(key) + " is no list");
        return value;
    }
    void refuse_unknown() const {
        for (const auto& [key, value] : object_.items())
            if (known_.count(key) == 0 && key.rfind("x-", 0) != 0)
                throw BadFrame("key '" + shown(key) + "' is unknown (keys of your own begin with x-)");
    }

private:
    const json& object_;
    std::set<std::string> known_;
};

double number(const json& value, const std::string& where) {
    if (!value.is_number()) throw BadFrame(where + " is no number");
    const double read = value.get<double>();
    if (!std::isfinite(read)) throw BadFrame(where + " is not finite");
    return read;
}

std::uint64_t whole(const json& value, const std::string& where) {
    if (!value.is_number_unsigned()) throw BadFrame(where + " is no whole number from 0 to 2^64 - 1");
    return value.get<std::uint64_t>();
}

std::int64_t time_ns(const json& value, const std::string& where) {
    constexpr std::int64_t limit = std::int64_t{1} << 62;
    const bool large = value.is_number_unsigned() && value.get<std::uint64_t>() > std::uint64_t{limit};
    if (!value.is_number_integer() || large || value.get<std::int64_t>() < -limit)
        throw BadFrame(where + " is no whole number of nanoseconds within 2^62");
    return value.get<std::int64_t>();
}

std::int64_t seconds(const json& value, const std::string& where) {
    std::int64_t time = 0;
    if (!nanoseconds(number(value, where), time)) throw BadFrame(where + " is beyond what nanoseconds can count");
    return time;
}

/// `NAME_ns` in whole nanoseconds or `NAME` in seconds.
std::optional<std::int64_t> instant(Reader& reader, const char* name) {
    const std::string exact = std::string(name) + "_ns";
    const json *fine = reader.find(exact.c_str()), *plain = reader.find(name);
    if (fine != nullptr && plain != nullptr) throw BadFrame(exact + " and " + name + " are both given");
    if (fine != nullptr) return time_ns(*fine, exact);
    if (plain != nullptr) return seconds(*plain, name);
    return std::nullopt;
}

std::string indexed(const std::string& name, std::size_t i) { return name + "[" + std::to_string(i) + "]"; }

/// Appends `count` numbers.
void numbers(const json& list, std::size_t count, const std::string& where, const std::string& because,
             std::vector<double>& to) {
    if (!list.is_array() || list.size() != count)
        throw BadFrame(where + " is no list of " + std::to_string(count) + " numbers" + because);
    for (std::size_t i = 0; i < count; ++i) to.push_back(number(list[i], indexed(where, i)));
}

void matrix(const json& rows, std::size_t size, const std::string& where, std::vector<double>& to) {
    if (!rows.is_array() || rows.size() != size)
        throw BadFrame(where + " is no matrix of " + std::to_string(size) + " rows");
    const std::size_t before = to.size();
    for (std::size_t r = 0; r < size; ++r) numbers(rows[r], size, indexed(where, r), "", to);
    check_covariance(to.data() + before, size, where);
}

/// A list with an entry for each row, if it is there at all.
template <class Take> void column(Reader& reader, const char* key, std::size_t rows, Take take) {
    if (!reader.has(key)) return;
    const json& list = reader.list(key);
    if (list.size() != rows)
        throw BadFrame(std::string(key) + " has " + std::to_string(list.size()) + " entries, expected " +
                       std::to_string(rows));
    for (std::size_t i = 0; i < rows; ++i) take(list[i], indexed(key, i));
}

void check_components(Reader& reader, const pelorus::Space& space) {
    if (!reader.has("components")) return;
    const json& names = reader.list("components");
    bool same = names.size() == static_cast<std::size_t>(space.size());
    for (std::size_t i = 0; same && i < names.size(); ++i) same = names[i] == space[static_cast<int>(i)].name;
    if (!same) throw BadFrame("components are " + shown(names.dump(-1, ' ', true), 120) + ", expected " + space.text());
}

void values(Reader& reader, const char* key, const pelorus::Space& space, Frame& frame) {
    frame.width = static_cast<std::uint64_t>(space.size());
    check_components(reader, space);
    const json& rows = reader.list(key);
    const std::string because = ": " + space.text();
    for (std::size_t i = 0; i < rows.size(); ++i)
        numbers(rows[i], static_cast<std::size_t>(frame.width), indexed(key, i), because, frame.values);
}

void ids_and_times(Reader& reader, Frame& frame) {
    column(reader, "ids", frame.rows(),
           [&](const json& v, const std::string& at) { frame.ids.push_back(whole(v, at)); });
    if (reader.has("times") && reader.has("times_ns")) throw BadFrame("times_ns and times are both given");
    column(reader, "times_ns", frame.rows(),
           [&](const json& v, const std::string& at) { frame.times.push_back(time_ns(v, at)); });
    column(reader, "times", frame.rows(),
           [&](const json& v, const std::string& at) { frame.times.push_back(seconds(v, at)); });
}

void read_scan(Reader& reader, const Vocabulary& vocabulary, Frame& frame) {
    frame.sensor = reader.text("sensor");
    const Vocabulary::Sensor& sensor = sensor_of(vocabulary, frame.sensor);
    values(reader, "measurements", sensor.measurement, frame);
    ids_and_times(reader, frame);
    const auto size = static_cast<std::size_t>(frame.width);
    column(reader, "covariances", frame.rows(),
           [&](const json& v, const std::string& at) { matrix(v, size, at, frame.covariances); });
    if (const json* common = reader.find("covariance")) {
        if (!frame.covariances.empty()) throw BadFrame("covariances and covariance are both given");
        matrix(*common, size, "covariance", frame.covariances);
        frame.common = true;
    }
    column(reader, "snr", frame.rows(),
           [&](const json& v, const std::string& at) { frame.snr.push_back(number(v, at)); });
    if (const json* waveform = reader.find("waveform")) {
        if (sensor.waveform.size() == 0) throw BadFrame("waveform is given, but sensor " + frame.sensor + " has none");
        numbers(*waveform, static_cast<std::size_t>(sensor.waveform.size()), "waveform", ": " + sensor.waveform.text(),
                frame.waveform);
    }
}

void read_truth(Reader& reader, const Vocabulary& vocabulary, Frame& frame) {
    values(reader, "states", vocabulary.truth, frame);
    ids_and_times(reader, frame);
    if (frame.ids.size() != frame.rows()) throw BadFrame("ids are missing");
    column(reader, "parents", frame.rows(),
           [&](const json& v, const std::string& at) { frame.parents.push_back(whole(v, at)); });
    column(reader, "births_ns", frame.rows(),
           [&](const json& v, const std::string& at) { frame.births.push_back(time_ns(v, at)); });
    column(reader, "extents", frame.rows(), [&](const json& v, const std::string& at) {
        if (!v.is_array() || v.empty() || v.size() > 3 ||
            (frame.extent_dimension && v.size() != frame.extent_dimension))
            throw BadFrame(at + " is no matrix of 1 to 3 rows, the same for all");
        frame.extent_dimension = v.size();
        for (std::size_t r = 0; r < v.size(); ++r) numbers(v[r], v.size(), indexed(at, r), "", frame.extents);
    });
    column(reader, "measurements", frame.rows(), [&](const json& v, const std::string& at) {
        if (!v.is_array()) throw BadFrame(at + " is no list");
        frame.measurements.emplace_back();
        for (std::size_t i = 0; i < v.size(); ++i) frame.measurements.back().push_back(whole(v[i], indexed(at, i)));
    });
}

/// Sender, session and sequence: of the datagram, so the same in all of its lines that have them.
void read_envelope(Reader& reader, Datagram& datagram, bool first) {
    Datagram told;
    if (whole(reader.need("pelorus"), "pelorus") != version)
        throw BadFrame("pelorus is " + reader.need("pelorus").dump() + ", this reader knows version 1");
    if (reader.has("sender")) {
        told.sender = reader.text("sender");
        if (told.sender.empty()) throw BadFrame("sender is empty");
    }
    if (const json* session = reader.find("session")) told.session = whole(*session, "session");
    if (const json* sequence = reader.find("sequence")) told.sequence = whole(*sequence, "sequence");
    adopt_envelope(told, first, datagram);
}

Kind kind_of(const std::string& word) {
    if (word == "scan") return Kind::scan;
    if (word == "truth") return Kind::truth;
    if (word == "tracks") return Kind::tracks;
    if (word == "end") return Kind::end;
    throw BadFrame("kind is '" + shown(word) + "', expected scan, truth, tracks or end");
}

Frame read_frame(Reader& reader, const Vocabulary& vocabulary, const Datagram& datagram) {
    Frame frame;
    frame.kind = kind_of(reader.text("kind"));
    if (frame.kind == Kind::tracks || (frame.kind == Kind::truth && vocabulary.truth.size() == 0)) return frame;
    const auto time = instant(reader, "time");
    frame.arrival = instant(reader, "arrival");
    if (!time && frame.kind != Kind::end) throw BadFrame("time_ns (or time, in seconds) is missing");
    frame.time = time.value_or(0);
    if (reader.has("part")) {
        const json& part = reader.list("part");
        if (part.size() != 2) throw BadFrame("part is not [number, of how many]");
        frame.part = {whole(part[0], "part[0]"), whole(part[1], "part[1]")};
        check_part(frame.part);
        if (!datagram.sequence && frame.part[1] > 1) throw BadFrame("has a part, but no sequence to order it by");
    }
    if (reader.has("frame") && reader.text("frame") != vocabulary.frame)
        throw BadFrame("frame is '" + shown(reader.text("frame")) + "', expected '" + vocabulary.frame + "'");
    if (frame.kind == Kind::scan) read_scan(reader, vocabulary, frame);
    if (frame.kind == Kind::truth) read_truth(reader, vocabulary, frame);
    reader.refuse_unknown();
    return frame;
}

}  // namespace

void decode_json(std::string_view bytes, const Vocabulary& vocabulary, Datagram& into) {
    bool first = true;
    for (std::size_t at = 0, line = 1; at < bytes.size(); ++line) {
        const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
        const std::string_view text = bytes.substr(at, end - at);
        at = end + 1;
        if (text.find_first_not_of(" \t\r") == std::string_view::npos) continue;
        try {
            const json object = parse(text);
            Reader reader(object);
            read_envelope(reader, into, first);
            into.frames.push_back(read_frame(reader, vocabulary, into));
        } catch (const BadFrame& problem) {
            throw BadFrame("line " + std::to_string(line) + ": " + problem.what());
        }
        first = false;
    }
}

}  // namespace wire
