#include "cli/value_json.hpp"

namespace pelorus::cli {

using Json = nlohmann::ordered_json;

namespace {

Json scalar_json(const graph::Value& value) {
    if (value.quoted) return value.scalar;
    if (value.scalar == "true" || value.scalar == "false") return value.scalar == "true";
    Json number = Json::parse(value.scalar, nullptr, false);
    return number.is_number() ? number : Json(value.scalar);
}

/// Whether YAML in flow style takes the text as it stands, and as a text.
bool is_plain(const std::string& text) {
    if (text.empty() || text.front() == ' ' || text.back() == ' ') return false;
    if (text.find_first_of(",[]{}#\"\n\t:") != std::string::npos) return false;
    if (std::string("?~&*!|>'%@`").find(text.front()) != std::string::npos) return false;
    if (text.front() == '-' && (text.size() == 1 || text[1] == ' ' || text[1] == '-')) return false;
    const Json read = Json::parse(text, nullptr, false);
    return read.is_discarded();  // numbers, true, false and null are not texts
}

}  // namespace

Json value_json(const graph::Value& value) {
    switch (value.kind) {
        case graph::Value::Kind::scalar:
            return scalar_json(value);
        case graph::Value::Kind::list: {
            Json list = Json::array();
            for (const graph::Value& item : value.list) list.push_back(value_json(item));
            return list;
        }
        case graph::Value::Kind::map: {
            Json map = Json::object();
            for (const graph::Value::Entry& entry : value.map) map[entry.key] = value_json(entry.value);
            return map;
        }
        case graph::Value::Kind::null:
            break;
    }
    return nullptr;
}

std::string flow_text(const Json& value) {
    std::string text;
    if (value.is_array()) {
        for (const Json& item : value) text += (text.empty() ? "" : ", ") + flow_text(item);
        return "[" + text + "]";
    }
    if (value.is_object()) {
        for (const auto& [key, item] : value.items()) text += (text.empty() ? "" : ", ") + key + ": " + flow_text(item);
        return "{" + text + "}";
    }
    if (value.is_null()) return "~";
    if (value.is_string() && is_plain(value.get<std::string>())) return value.get<std::string>();
    return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace pelorus::cli
