#include "runtime/config_difference.hpp"

#include <algorithm>
#include <vector>

#include <nlohmann/json.hpp>

namespace pelorus::runtime {

namespace {

using Json = nlohmann::ordered_json;

std::string shown(const Json* value) {
    constexpr std::size_t longest = 120;
    if (value == nullptr) return "absent";
    std::string text = value->dump(-1, ' ', false, Json::error_handler_t::replace);
    if (text.size() <= longest) return text;
    std::size_t end = longest;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0u) == 0x80u) --end;  // not through a character
    return text.substr(0, end) + "...";
}

/// Words of the file that are no part of an address.
bool is_silent(const std::string& key, std::size_t depth) {
    return (depth == 0 && key == "config") || (depth == 1 && key == "graph") || key == "with" || key == "parts";
}

std::vector<std::string> keys_of(const Json& a, const Json& b) {
    std::vector<std::string> keys;
    for (const Json* map : {&a, &b})
        for (const auto& [key, value] : map->items())
            if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
    return keys;
}

std::string compare(const Json& there, const Json& here, const std::string& address, std::size_t depth) {
    if (there == here) return {};
    if (!there.is_object() || !here.is_object())
        return address + " is " + shown(&there) + " there, " + shown(&here) + " here";
    for (const std::string& key : keys_of(there, here)) {
        const auto left = there.find(key), right = here.find(key);
        const std::string below = is_silent(key, depth) ? address : address + (address.empty() ? "" : ".") + key;
        if (left == there.end() || right == here.end())
            return below + " is " + shown(left == there.end() ? nullptr : &*left) + " there, " +
                   shown(right == here.end() ? nullptr : &*right) + " here";
        const std::string found = compare(*left, *right, below, depth + 1);
        if (!found.empty()) return found;
    }
    return {};  // the same keys in another order, which is no difference
}

}  // namespace

std::string first_difference(const std::string& there, const std::string& here) {
    // A snapshot is a file from somewhere: what nests deeper than any config would be walked by recursion.
    constexpr int deepest = 200;
    bool too_deep = false;
    const auto watch = [&too_deep](int depth, Json::parse_event_t, Json&) {
        too_deep = too_deep || depth > deepest;
        return !too_deep;
    };
    const Json left = Json::parse(there, watch, false), right = Json::parse(here, nullptr, false);
    if (too_deep || left.is_discarded() || right.is_discarded()) return {};
    return compare(left, right, {}, 0);
}

}  // namespace pelorus::runtime
