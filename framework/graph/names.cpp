#include "graph/names.hpp"

#include <algorithm>
#include <array>

namespace pelorus::graph {

namespace {
constexpr std::array reserved{"use", "like", "with", "parts", "in", "frame", "run", "previous"};
}

bool is_name(const std::string& text) {
    const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    return !text.empty() && is_letter(text.front()) &&
           std::all_of(text.begin(), text.end(), [&](char c) { return is_letter(c) || is_digit(c); });
}

bool is_reserved(const std::string& name) {
    return std::find(reserved.begin(), reserved.end(), name) != reserved.end();
}

std::string name_problem(const std::string& name, const std::string& what) {
    if (!is_name(name))
        return "'" + name + "' cannot name a " + what + ": letters, digits and _ only, and no digit first";
    if (is_reserved(name)) return "'" + name + "' cannot name a " + what + ": it is a word of the config itself";
    return {};
}

std::vector<std::string> split_address(const std::string& address) {
    std::vector<std::string> segments(1);
    for (const char c : address) {
        if (c == '.')
            segments.emplace_back();
        else
            segments.back() += c;
    }
    return segments;
}

}  // namespace pelorus::graph
