#include "subjects.hpp"

#include <cmath>

#include "apart.hpp"

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

/// Some values need another parameter beside them.
bool can_be_made(const Task& task, const plr_plugin& plugin, const Subject& subject) {
    try {
        const Instance tried(*task.host, plugin, subject.node, {});
        return true;
    } catch (const std::exception&) {
        return false;
    }
}

}  // namespace

std::vector<Subject> subjects_of(const Task& task) {
    Subject plain;
    plain.plugin = task.plugin;
    std::vector<Subject> subjects{plain};
    if (task.plugin.empty()) return subjects;
    const plr_plugin& plugin = Library::load(task.library).plugin(task.plugin);
    const plr_description& description = *plugin.description;
    std::vector<Subject> others;
    const auto* at = reinterpret_cast<const unsigned char*>(description.parameters);
    for (std::uint32_t i = 0; i < description.parameter_count; ++i) {
        const auto& parameter = *reinterpret_cast<const plr_parameter*>(at);
        at += parameter.struct_size;
        for (const std::string& value : alternatives(parameter)) {
            Subject other = plain;
            other.title = std::string(parameter.name) + ": " + value;
            try {
                other.node.with = task.host->settings("{" + other.title + "}", nullptr);
                others.push_back(other);
            } catch (const Refused&) {
                // Cannot be written like that; values-can-be-written tells it.
            }
        }
    }
    if (others.empty()) return subjects;
    // Tried in another process: a plugin that keeps something from one instance to the next must not have made any before its
    // check begins.
    const Apart tried = apart([&] {
        std::string accepted;
        for (const Subject& other : others) accepted += can_be_made(task, plugin, other) ? '1' : '0';
        return accepted;
    });
    // Where that process came to no end, so will the checks of these subjects, and tell it.
    const std::string accepted = tried.problem.empty() ? tried.written : std::string(others.size(), '1');
    for (std::size_t i = 0; i < accepted.size() && subjects.size() < most_subjects; ++i)
        if (accepted[i] == '1') subjects.push_back(others[i]);
    return subjects;
}

}  // namespace pelorus::conformance
