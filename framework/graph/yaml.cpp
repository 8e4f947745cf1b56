#include "graph/yaml.hpp"

#include "graph/yaml_diagnosis.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

namespace pelorus::graph {

namespace {

constexpr std::size_t deepest = 200;
constexpr std::size_t most_values = 1'000'000;

struct Measure {
    std::size_t count = 1, depth = 1;
};

Measure measure(const Value& value) {
    Measure total;
    const auto add = [&](const Value& below) {
        const Measure inner = measure(below);
        total.count += inner.count;
        total.depth = std::max(total.depth, inner.depth + 1);
    };
    for (const Value& item : value.list) add(item);
    for (const Value::Entry& entry : value.map) add(entry.value);
    return total;
}

/// The offset of the first byte that is not UTF-8 (RFC 3629), or npos.
std::size_t first_not_utf8(const std::string& text) {
    for (std::size_t at = 0; at < text.size();) {
        const auto lead = static_cast<unsigned char>(text[at]);
        const std::size_t length = lead < 0x80 ? 1 : lead >= 0xC2 && lead < 0xE0 ? 2 : (lead & 0xF0u) == 0xE0 ? 3 : 4;
        if ((lead >= 0x80 && lead < 0xC2) || lead > 0xF4 || at + length > text.size()) return at;
        for (std::size_t i = 1; i < length; ++i)
            if ((static_cast<unsigned char>(text[at + i]) & 0xC0u) != 0x80u) return at;
        const auto second = static_cast<unsigned char>(length > 1 ? text[at + 1] : 0);
        const bool is_overlong = (lead == 0xE0 && second < 0xA0) || (lead == 0xF0 && second < 0x90);
        const bool is_no_character = (lead == 0xED && second > 0x9F) || (lead == 0xF4 && second > 0x8F);
        if (is_overlong || is_no_character) return at;
        at += length;
    }
    return std::string::npos;
}

void refuse_other_encodings(const std::string& text, const TextOrigin& origin) {
    const std::size_t at = first_not_utf8(text);
    if (at == std::string::npos) return;
    Location where = origin.where;
    if (!origin.file.empty()) {
        const std::size_t line_start = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;  // npos + 1 is 0
        where = {origin.file,
                 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n')),
                 1 + static_cast<int>(at - line_start)};
    }
    throw ConfigError({{where, "this is not UTF-8; a config is text, saved as UTF-8"}});
}

/// The parser's own words where they leave a reader alone.
std::string plain_words(const std::string& message) {
    if (message == "the referenced anchor is not defined") return "no anchor of this name (&NAME) stands before it";
    if (message == "end of map not found" || message == "illegal map value")
        return "this does not continue the map above it; are the indentation and the colons right? (" + message + ")";
    return message;
}

/// Builds values from the parser's events.
class Builder : public YAML::EventHandler {
public:
    explicit Builder(const TextOrigin& origin) : origin_(origin) {}

    Value take() { return std::move(result_); }
    const Problems& problems() const noexcept { return problems_; }
    Problems& problems() noexcept { return problems_; }

    Location location(const YAML::Mark& mark) const {
        if (origin_.file.empty()) return origin_.where;
        if (mark.is_null()) return {origin_.file, 0, 0};
        return {origin_.file, mark.line + 1, mark.column + 1};
    }

    void OnDocumentStart(const YAML::Mark& mark) override {
        if (++documents_ > 1) stop(location(mark), "a second document begins here; a config is one document");
    }
    void OnDocumentEnd() override {}

    void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        put(scalar(mark, Value::Kind::null), anchor);
    }

    void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        const auto found = anchors_.find(anchor);
        if (found == anchors_.end()) stop(location(mark), "an anchor is used inside its own value");
        const Measure size = measure(found->second);
        values_ += size.count;
        if (values_ > most_values)
            stop(location(mark), "aliases expand to more than " + std::to_string(most_values) + " values");
        if (open_.size() + size.depth > deepest) too_deep(mark);
        put(found->second, 0);
    }

    void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  const std::string& text) override {
        refuse_tag(mark, tag);
        Value value = scalar(mark, Value::Kind::scalar);
        value.quoted = tag == "!";
        value.scalar = text;
        put(std::move(value), anchor);
    }

    void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value) override {
        open(mark, tag, anchor, Value::Kind::list);
    }
    void OnSequenceEnd() override { close(); }
    void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value) override {
        open(mark, tag, anchor, Value::Kind::map);
    }
    void OnMapEnd() override {
        Open& top = open_.back();
        if (top.key) stop(top.key->where, "a key without a value");
        top.value.map = assemble(std::move(top.entries));
        close();
    }

private:
    struct RawEntry {
        Value key, value;
    };
    /// A list or map whose end has not come yet.
    struct Open {
        Value value;
        YAML::anchor_t anchor = 0;
        std::optional<Value> key;
        std::vector<RawEntry> entries;
    };

    [[noreturn]] void stop(const Location& where, const std::string& text) {
        problems_.add(where, text);
        problems_.raise();
        throw ConfigError(problems_.items());
    }
    [[noreturn]] void too_deep(const YAML::Mark& mark) {
        stop(location(mark), "nested more than " + std::to_string(deepest) + " levels deep");
    }
    void refuse_tag(const YAML::Mark& mark, const std::string& tag) {
        if (!tag.empty() && tag != "?" && tag != "!")
            problems_.add(location(mark), "the tag '" + tag + "' has no meaning in a config");
    }

    Value scalar(const YAML::Mark& mark, Value::Kind kind) const {
        Value value;
        value.kind = kind;
        value.where = location(mark);
        value.base = origin_.base;
        return value;
    }

    void open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, Value::Kind kind) {
        refuse_tag(mark, tag);
        if (open_.size() + 1 > deepest) too_deep(mark);
        open_.push_back({scalar(mark, kind), anchor, std::nullopt, {}});
    }

    void close() {
        Value value = std::move(open_.back().value);
        const YAML::anchor_t anchor = open_.back().anchor;
        open_.pop_back();
        put(std::move(value), anchor);
    }

    /// A value is complete: it is remembered under its anchor and goes where it belongs.
    void put(Value value, YAML::anchor_t anchor) {
        if (++values_ > most_values) stop(value.where, "more than " + std::to_string(most_values) + " values");
        if (anchor != 0) anchors_[anchor] = value;
        if (open_.empty()) {
            result_ = std::move(value);
            return;
        }
        Open& top = open_.back();
        if (top.value.is_list()) {
            top.value.list.push_back(std::move(value));
        } else if (!top.key) {
            top.key = std::move(value);
        } else {
            top.entries.push_back({std::move(*top.key), std::move(value)});
            top.key.reset();
        }
    }

    static bool is_merge(const Value& key) { return key.is_scalar() && !key.quoted && key.scalar == "<<"; }

    std::vector<Value::Entry> assemble(std::vector<RawEntry> raw) {
        std::map<std::string, Location> explicit_keys;
        for (const RawEntry& entry : raw) {
            if (!entry.key.is_scalar()) {
                problems_.add(entry.key.where, "a key must be a word, not " + entry.key.described());
                continue;
            }
            const std::string blank = entry.key.quoted ? std::string() : blank_problem(entry.key.scalar);
            if (!blank.empty()) {
                problems_.add(entry.key.where, blank);
                continue;
            }
            const auto [first, fresh] = explicit_keys.emplace(entry.key.scalar, entry.key.where);
            if (!fresh)
                problems_.add(entry.key.where,
                              "the key '" + entry.key.scalar + "' stands twice" +
                                  (first->second.line > 0 ? ", first in line " + std::to_string(first->second.line)
                                                          : std::string()));
        }
        std::vector<Value::Entry> entries;
        for (RawEntry& entry : raw) {
            if (is_merge(entry.key))
                merge_maps(entry.value, explicit_keys, entries);
            else
                entries.push_back({entry.key.scalar, entry.key.where, std::move(entry.value)});
        }
        return entries;
    }

    void merge_maps(const Value& value, const std::map<std::string, Location>& explicit_keys,
                    std::vector<Value::Entry>& entries) {
        if (value.is_list()) {
            for (const Value& item : value.list) merge_map(item, explicit_keys, entries);
        } else {
            merge_map(value, explicit_keys, entries);
        }
    }

    void merge_map(const Value& value, const std::map<std::string, Location>& explicit_keys,
                   std::vector<Value::Entry>& entries) {
        if (!value.is_map()) {
            problems_.add(value.where, "'<<' merges a map or a list of maps, got " + value.described());
            return;
        }
        for (const Value::Entry& entry : value.map) {
            const bool known = std::any_of(entries.begin(), entries.end(),
                                           [&](const Value::Entry& other) { return other.key == entry.key; });
            if (!known && explicit_keys.count(entry.key) == 0) entries.push_back(entry);
        }
    }

    const TextOrigin& origin_;
    Problems problems_;
    Value result_;
    std::vector<Open> open_;
    std::map<YAML::anchor_t, Value> anchors_;
    std::size_t values_ = 0;
    int documents_ = 0;
};

/// Whether a text is one plain scalar to any reader of YAML: words and numbers, such as `0.1 m/s2` or `truncated`. Most defaults
/// are, and the parser takes far longer to find that out.
bool is_plain_scalar(const std::string& text) {
    const auto is_alphanumeric = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
    if (text.empty() || !is_alphanumeric(text.front()) || text.back() == ' ') return false;
    if (text == "null" || text == "Null" || text == "NULL") return false;
    return std::all_of(text.begin(), text.end(), [&](char c) {
        return is_alphanumeric(c) || std::string_view(" ._/+-%").find(c) != std::string_view::npos;
    });
}

}  // namespace

Value read_yaml(const std::string& text, const TextOrigin& origin) {
    if (origin.file.empty() && is_plain_scalar(text)) {
        Value value;
        value.kind = Value::Kind::scalar;
        value.scalar = text;
        value.where = origin.where;
        value.base = origin.base;
        return value;
    }
    refuse_other_encodings(text, origin);
    Builder builder(origin);
    // yaml-cpp 0.7 takes an open quote for closed if white space ends the text.
    std::istringstream stream(text.substr(0, text.find_last_not_of(" \t\r\n") + 1));
    try {
        YAML::Parser parser(stream);
        while (parser.HandleNextDocument(builder)) continue;
    } catch (const YAML::Exception& exception) {
        const YamlDiagnosis likely = diagnose_yaml(text, exception.mark.line + 1, exception.mark.column + 1);
        Location where = builder.location(exception.mark);
        if (!likely.text.empty() && !origin.file.empty()) where = {origin.file, likely.line, likely.column};
        builder.problems().add(where,
                               "this is not YAML: " + (likely.text.empty() ? plain_words(exception.msg) : likely.text));
    }
    builder.problems().raise();
    Value value = builder.take();
    if (value.where.file.empty()) value.where = origin.file.empty() ? origin.where : Location{origin.file, 1, 1};
    value.base = origin.base;
    return value;
}

}  // namespace pelorus::graph
