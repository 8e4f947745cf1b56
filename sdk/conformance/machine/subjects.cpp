#include "subjects.hpp"

#include <cmath>
#include <set>

namespace pelorus::conformance {

namespace {

constexpr std::size_t most_subjects = 12;
constexpr double few_values = 4;

/// The values of a parameter that are tried by themselves, as a config writes them.
std::vector<std::string> alternatives(const plr_parameter& parameter) {
    std::vector<std::string> values;
    const std::string initial = parameter.default_text == nullptr ? "" : parameter.default_text;
    if (parameter.type == PLR_TYPE_CHOICE) {
        for (std::uint32_t c = 0; c < parameter.choice_count; ++c)
            if (initial != parameter.choices[c]) values.emplace_back(parameter.choices[c]);
    } else if (parameter.type == PLR_TYPE_BOOL && !initial.empty()) {
        values.emplace_back(initial == "true" ? "false" : "true");
    } else if (parameter.type == PLR_TYPE_INT && parameter.max - parameter.min <= few_values) {
        for (double v = parameter.min; v <= parameter.max; ++v) {
            const std::string text = std::to_string(static_cast<long long>(v));
            if (text != initial) values.push_back(text);
        }
    }
    return values;
}

}  // namespace

std::vector<Subject> subjects_of(const Task& task) {
    Subject plain;
    plain.plugin = task.plugin;
    std::vector<Subject> subjects{plain};
    if (task.plugin.empty()) return subjects;
    const plr_plugin& plugin = Library::load(task.library).plugin(task.plugin);
    const plr_description& description = *plugin.description;
    const auto* at = reinterpret_cast<const unsigned char*>(description.parameters);
    for (std::uint32_t i = 0; i < description.parameter_count; ++i) {
        const auto& parameter = *reinterpret_cast<const plr_parameter*>(at);
        at += parameter.struct_size;
        for (const std::string& value : alternatives(parameter)) {
            if (subjects.size() >= most_subjects) return subjects;
            Subject other = plain;
            other.title = std::string(parameter.name) + ": " + value;
            other.node.with = task.host->settings("{" + other.title + "}", nullptr);
            try {
                const Instance tried(*task.host, plugin, other.node, {});
                subjects.push_back(other);
            } catch (const std::exception&) {
                // Not by itself: it needs another parameter beside it.
            }
        }
    }
    return subjects;
}

}  // namespace pelorus::conformance
