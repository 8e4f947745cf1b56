#include "host/error.hpp"

#include <algorithm>

namespace pelorus {

namespace {

std::string join(const std::vector<ConfigError::Item>& items) {
    std::string lines;
    for (const ConfigError::Item& item : items) {
        if (!lines.empty()) lines += '\n';
        const std::string where = item.where.text();
        lines += where.empty() ? item.text : where + ": " + item.text;
    }
    return lines;
}

/// Insertions, deletions, substitutions and swaps of neighbours that turn one word into the other (optimal string alignment).
std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::size_t> before_previous(b.size() + 1), previous(b.size() + 1), current(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) previous[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        current[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t substitution = previous[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            current[j] = std::min({previous[j] + 1, current[j - 1] + 1, substitution});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                current[j] = std::min(current[j], before_previous[j - 2] + 1);
        }
        before_previous.swap(previous);
        previous.swap(current);
    }
    return previous[b.size()];
}

}  // namespace

std::string Location::text() const {
    if (file.empty() || line <= 0) return file;
    std::string text = file + ":" + std::to_string(line);
    if (column > 0) text += ":" + std::to_string(column);
    return text;
}

ConfigError::ConfigError(std::vector<Item> items) : Error(Exit::misuse, join(items)), items_(std::move(items)) {}

std::string nearest(const std::string& word, const std::vector<std::string>& candidates) {
    const std::string* best = nullptr;
    std::size_t best_distance = 0;
    for (const std::string& candidate : candidates) {
        const std::size_t distance = edit_distance(word, candidate);
        if (3 * distance > std::max(word.size(), candidate.size())) continue;
        if (best == nullptr || distance < best_distance) {
            best = &candidate;
            best_distance = distance;
        }
    }
    if (best != nullptr) return *best;
    // A word that was cut short, if one candidate alone begins so.
    constexpr std::size_t shortest = 3;
    for (const std::string& candidate : candidates) {
        if (word.size() < shortest || candidate.compare(0, word.size(), word) != 0) continue;
        if (best != nullptr) return {};
        best = &candidate;
    }
    return best == nullptr ? std::string() : *best;
}

}  // namespace pelorus
