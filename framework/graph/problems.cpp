#include "graph/problems.hpp"

#include <algorithm>
#include <utility>

#include "graph/value.hpp"
#include "host/plugin_error.hpp"

namespace pelorus::graph {

namespace {

std::string lower_case(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
}

/// What a message says once the address that it begins with is left away.
std::string statement(const std::string& text) {
    const std::size_t colon = text.find(": ");
    return colon == std::string::npos ? text : text.substr(colon);
}

}  // namespace

void Problems::add(const Location& where, std::string text) {
    text = host::one_line(text.c_str(), text.size());
    for (const ConfigError::Item& item : items_)  // what an anchor or `like` brings to several places is told once
        if (item.where.text() == where.text() && statement(item.text) == statement(text)) return;
    items_.push_back({where, std::move(text)});
}

void Problems::raise() const {
    if (!items_.empty()) throw ConfigError(items_);
}

std::string meant(const std::string& word, const std::vector<std::string>& candidates) {
    static const std::pair<const char*, const char*> others_say[] = {
        {"input", "in"}, {"inputs", "in"}, {"plugin", "use"}, {"parameters", "with"}, {"slots", "parts"}};
    const std::string near = nearest(word, candidates);
    if (!near.empty()) return near;
    const std::string small = lower_case(word);
    for (const std::string& candidate : candidates) {
        if (small == lower_case(candidate)) return candidate;
        for (const auto& [other, ours] : others_say)
            if (small == other && candidate == ours) return candidate;
    }
    return {};
}

std::string suggestion(const std::string& word, const std::vector<std::string>& candidates, const std::string& plural) {
    constexpr std::size_t few = 12;
    std::string text;
    std::string near = meant(word, candidates);
    const std::size_t colon = word.find(':'), equals = word.find('=');
    if (equals != std::string::npos) {  // `scans = 60` in braces is a key of that name, too
        near = meant(trimmed(word.substr(0, equals)), candidates);
        if (!near.empty())
            return "; a colon belongs in place of the '=': `" + near + ": " + trimmed(word.substr(equals + 1)) + "`";
    }
    if (colon != std::string::npos) {  // `scans:60` in braces is a key of that name
        near = nearest(word.substr(0, colon), candidates);
        if (!near.empty())
            return "; a blank is missing after the colon: `" + near + ": " + word.substr(colon + 1) + "`";
    }
    if (!near.empty()) text += "; did you mean '" + near + "'?";
    if (candidates.empty())
        text += "; it has no " + plural;
    else if (candidates.size() <= few)
        text += (near.empty() ? "; " : " ") + plural + ": " + join(candidates);
    return text;
}

void check_keys(const Value& map, const std::vector<std::string>& keys, const std::string& prefix, Problems& problems) {
    for (const Value::Entry& entry : map.map) {
        const bool is_free = prefix.empty() && entry.key.compare(0, 2, "x-") == 0;
        if (!is_free && std::find(keys.begin(), keys.end(), entry.key) == keys.end())
            problems.add(entry.where, prefix + "unknown key '" + entry.key + "'" + suggestion(entry.key, keys, "keys"));
    }
}

std::string trimmed(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \t");
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::string join(const std::vector<std::string>& words, const std::string& separator) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
    return text;
}

std::string with_article(const std::string& noun) {
    const bool vowel = !noun.empty() && std::string("aeiou").find(noun.front()) != std::string::npos;
    return (vowel ? "an " : "a ") + noun;
}

}  // namespace pelorus::graph
