#include "check.hpp"

#include <algorithm>
#include <cstring>

namespace pelorus::conformance {

namespace {

/// Whom checks concern, in the order in which they are told.
constexpr const char* groups[] = {"library",      "every",  "model",       "stage",     "motion",     "sensor",
                                  "estimator",    "extent", "partitioner", "waveform",  "trajectory", "source",
                                  "registration", "fusion", "tracker",     "scheduler", "analyzer",   "sink"};

std::size_t rank(const char* group) noexcept {
    const auto* const found = std::find_if(std::begin(groups), std::end(groups),
                                           [&](const char* each) { return std::strcmp(each, group) == 0; });
    return static_cast<std::size_t>(found - std::begin(groups));
}

std::vector<Check>& registered() {
    static std::vector<Check> all;
    return all;
}

}  // namespace

namespace detail {
Registration::Registration(Check check) { registered().push_back(std::move(check)); }
}  // namespace detail

const std::vector<Check>& checks() {
    static const std::vector<Check> sorted = [] {
        std::vector<Check> all = registered();
        std::stable_sort(all.begin(), all.end(), [](const Check& one, const Check& other) {
            const std::size_t mine = rank(one.group), theirs = rank(other.group);
            if (mine != theirs) return mine < theirs;
            if (one.level != other.level) return one.level < other.level;
            const int files = std::strcmp(one.file, other.file);
            return files != 0 ? files < 0 : one.line < other.line;
        });
        return all;
    }();
    return sorted;
}

const Check* find_check(const std::string& name) {
    for (const Check& check : checks())
        if (name == check.name) return &check;
    return nullptr;
}

}  // namespace pelorus::conformance
