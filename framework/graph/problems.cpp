#include "graph/problems.hpp"

#include <utility>

#include "host/plugin_error.hpp"

namespace pelorus::graph {

namespace {

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

std::string suggestion(const std::string& word, const std::vector<std::string>& candidates, const std::string& plural) {
    constexpr std::size_t few = 12;
    std::string text;
    std::string near = nearest(word, candidates);
    const std::size_t colon = word.find(':');
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
