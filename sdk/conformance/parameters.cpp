// What a plugin says of itself. What becomes of its values: values.cpp.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "machine/bench.hpp"
#include "machine/creation.hpp"
#include "machine/variation.hpp"

namespace pelorus::conformance {

namespace {

/// All parameters of a description with what they belong to: its own, columns of tables, those of slots.
template <class Visit> void for_parameters(const plr_description& description, Visit&& visit) {
    const auto all = [&](const plr_parameter* first, std::uint32_t count, const std::string& holder) {
        for (std::uint32_t i = 0; i < count; ++i) {
            const plr_parameter& parameter = element_of(first, i);
            visit(parameter, holder + parameter.name, false);
            for (std::uint32_t c = 0; c < parameter.column_count; ++c) {
                const plr_parameter& column = element_of(parameter.columns, c);
                visit(column, holder + parameter.name + "." + column.name, true);
            }
        }
    };
    all(description.parameters, description.parameter_count, "");
    for (std::uint32_t s = 0; s < description.slot_count; ++s) {
        const plr_slot& slot = element_of(description.slots, s);
        all(slot.parameters, slot.parameter_count, std::string(slot.name) + ": ");
    }
}

/// `1.2.3`, and perhaps `-beta.1` or `+build` behind it.
bool is_semantic_version(const char* text) {
    for (int part = 0; part < 3; ++part) {
        if (part > 0 && *text++ != '.') return false;
        const char* const first = text;
        while (std::isdigit(static_cast<unsigned char>(*text)) != 0) ++text;
        if (text == first || (*first == '0' && text - first > 1)) return false;
    }
    return *text == 0 || ((*text == '-' || *text == '+') && text[1] != 0);
}

bool is_text(const char* text) { return text != nullptr && std::strspn(text, " \t\n") < std::strlen(text); }

/// Whether the host can read a value in that unit. Answers its words if not.
std::string unit_problem(const Bench& bench, const char* unit, std::int32_t elements) {
    plr_parameter probe{};
    probe.struct_size = sizeof probe;
    probe.type = elements < 0 ? PLR_TYPE_DOUBLE : PLR_TYPE_VECTOR;
    probe.flags = PLR_PARAMETER_REQUIRED;
    probe.name = "probe";
    probe.doc = "";
    probe.unit = unit;
    probe.min = -HUGE_VAL;
    probe.max = HUGE_VAL;
    probe.rows_min = elements;
    probe.rows_max = elements;
    const auto with = bench.host().settings("{probe: 1}", nullptr);
    try {
        bench.host().values(&probe, 1, with.get(), bench.task().plugin);
        return {};
    } catch (const Refused& refused) {
        return refused.what();
    }
}

}  // namespace

PELORUS_CHECK(
    every, "description-is-accepted", 1,
    "The description is whole: no missing text or array, no name taken twice, no bounds that nothing satisfies; a host "
    "refuses any other.",
    {"library-answers-its-plugins"}) {
    bench.once_a_plugin();
    const std::string problem = bench.host().description_problem(bench.description());
    if (!problem.empty()) FAIL(problem);
}

PELORUS_CHECK(
    every, "defaults-are-read", 1,
    "Each default can be read as a config's value would be, and lies within the bounds that the parameter declares; "
    "otherwise the plugin cannot be used without naming that parameter.",
    {"description-is-accepted"}) {
    bench.once_a_plugin();
    const plr_description& description = bench.description();
    const auto try_default = [&](const plr_parameter& parameter, const std::string& name, bool is_column) {
        if (parameter.default_text == nullptr || is_column || parameter.type == PLR_TYPE_PATH) return;
        try {
            bench.host().values(&parameter, 1, nullptr, description.id);
        } catch (const Refused& refused) {
            FAIL_CHECK(name << ": " << refused.what());
        }
    };
    for_parameters(description, try_default);
}

PELORUS_CHECK(
    every, "description-is-complete", 2,
    "Title, purpose, licence and a semantic version are there, and a sentence for each parameter, slot, port and "
    "input; the reference page and `pelorus inspect` are made of nothing else.",
    {"description-is-accepted"}) {
    bench.once_a_plugin();
    const plr_description& d = bench.description();
    const auto need = [&](const char* text, const std::string& what) {
        if (!is_text(text)) FAIL_CHECK(what << " is empty");
    };
    need(d.title, "title");
    need(d.purpose, "purpose");
    need(d.license, "license");
    if (d.version == nullptr || !is_semantic_version(d.version))
        FAIL_CHECK("version is `" << (d.version == nullptr ? "NULL" : d.version) << "`, expected three numbers: 1.0.0");
    for_parameters(d, [&](const plr_parameter& parameter, const std::string& name, bool) {
        need(parameter.doc, "the doc of parameter " + name);
        for (std::uint32_t c = 0; parameter.choice_docs != nullptr && c < parameter.choice_count; ++c)
            if (parameter.choice_docs[c] == nullptr)  // empty where the word says it all
                FAIL_CHECK("the doc of choice " << parameter.choices[c] << " of " << name << " is NULL");
    });
    for (std::uint32_t i = 0; i < d.slot_count; ++i) {
        const plr_slot& slot = element_of(d.slots, i);
        need(slot.doc, "the doc of slot " + std::string(slot.name));
    }
    for (std::uint32_t i = 0; i < d.input_count; ++i) {
        const plr_input& input = element_of(d.inputs, i);
        need(input.doc, "the doc of input " + std::string(input.name));
    }
    for (std::uint32_t i = 0; i < d.in_port_count; ++i) {
        const plr_port& port = element_of(d.in_ports, i);
        need(port.doc, "the doc of in port " + std::string(port.name));
    }
    for (std::uint32_t i = 0; i < d.out_port_count; ++i) {
        const plr_port& port = element_of(d.out_ports, i);
        need(port.doc, "the doc of out port " + std::string(port.name));
    }
}

PELORUS_CHECK(
    every, "units-are-read", 2,
    "Each unit is one that configs are written in, and an SI one: parameters, columns and inputs reach the plugin in "
    "the unit that it declares.",
    {"description-is-accepted"}) {
    bench.once_a_plugin();
    const plr_description& d = bench.description();
    const auto need = [&](const char* unit, std::int32_t elements, const std::string& name) {
        const std::string problem = unit_problem(bench, unit, elements);
        if (!problem.empty()) FAIL_CHECK(name << ": the unit `" << unit << "`: " << problem);
    };
    for_parameters(d, [&](const plr_parameter& parameter, const std::string& name, bool) {
        const bool is_many = parameter.type == PLR_TYPE_VECTOR || parameter.type == PLR_TYPE_MATRIX;
        need(parameter.unit, is_many ? std::max(parameter.rows_min, 1) : -1, "parameter " + name);
    });
    for (std::uint32_t i = 0; i < d.input_count; ++i) {
        const plr_input& input = element_of(d.inputs, i);
        need(input.unit, static_cast<std::int32_t>(input.size), "input " + std::string(input.name));
    }
}

PELORUS_CHECK(
    every, "values-can-be-written", 2,
    "Each default, each value of the subject and each word of a choice, written into a config as it stands, is read as "
    "itself again; what a report or the resolved config shows must be what one can write.",
    {"defaults-are-read", "instance-is-made"}) {
    const plr_description& description = bench.description();
    const auto read = [&](const plr_parameter& parameter, const std::string& yaml) {
        const auto with = bench.host().settings(fmt::format("{{{}: {}}}", parameter.name, yaml), nullptr);
        return bench.host().values(&parameter, 1, with.get(), description.id);
    };
    const auto attempt = [&](const plr_parameter& parameter, const std::string& name, const plr_value& value) {
        if (value.present == 0) return;
        const std::string yaml = yaml_of(parameter, value);
        try {
            const auto again = read(parameter, yaml);
            const std::string text = yaml_of(parameter, again->data()[0]);
            if (text != yaml)
                FAIL_CHECK(name << ": `" << yaml << "`, written into a config, is read as `" << text << "`");
        } catch (const Refused& refused) {
            FAIL_CHECK(name << ": `" << yaml << "` cannot be written into a config: " << refused.what());
        }
    };
    for_parameters(description, [&](const plr_parameter& parameter, const std::string& name, bool is_column) {
        if (is_column) return;
        if (parameter.default_text != nullptr && parameter.type != PLR_TYPE_PATH)
            attempt(parameter, name, bench.host().values(&parameter, 1, nullptr, description.id)->data()[0]);
        for (std::uint32_t c = 0; c < parameter.choice_count; ++c) {
            plr_value word{};
            word.present = 1;
            word.text = parameter.choices[c];
            attempt(parameter, name, word);
        }
    });
    const auto instance = bench.make();
    const plr_config& config = instance->config();
    for (std::uint32_t p = 0; p < config.value_count; ++p) {
        const plr_parameter& parameter = element_of(description.parameters, p);
        attempt(parameter, parameter.name, element_of(config.values, p));
    }
}

}  // namespace pelorus::conformance
