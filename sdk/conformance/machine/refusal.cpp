#include "refusal.hpp"

#include <algorithm>
#include <cstring>
#include <set>

#include <fmt/format.h>

#include "library.hpp"

namespace pelorus::conformance {

namespace {

std::set<std::string> names_of(const plr_description& description) {
    std::set<std::string> names;
    for (std::uint32_t i = 0; i < description.parameter_count; ++i)
        names.insert(element_of(description.parameters, i).name);
    for (std::uint32_t i = 0; i < description.slot_count; ++i) names.insert(element_of(description.slots, i).name);
    for (std::uint32_t i = 0; i < description.in_port_count; ++i)
        names.insert(element_of(description.in_ports, i).name);
    for (std::uint32_t i = 0; i < description.out_port_count; ++i)
        names.insert(element_of(description.out_ports, i).name);
    return names;
}

template <std::size_t Capacity> bool is_terminated(const char (&text)[Capacity]) {
    return std::memchr(text, 0, Capacity) != nullptr;
}

std::string text_problem(const plr_error& error) {
    if (!is_terminated(error.message) || !is_terminated(error.where)) return "its text is not zero-terminated";
    const std::string message = error.message;
    if (message.empty()) return "it tells no reason (error.message is empty)";
    if (message.find('\n') != std::string::npos) return "its text has more than one line: " + message;
    return {};
}

}  // namespace

std::string refusal_problem(const Creation& refused, const plr_description& description, bool are_described) {
    if (!refused.left_by().empty()) return refused.told();
    const plr_status status = refused.status();
    const plr_error& error = refused.error();
    if (status >= 0) return fmt::format("create answered {} and no instance", refused.told());
    if (status_name(status) == nullptr) return fmt::format("create answered {}, which is no status", status);
    if (error.code != status)
        return fmt::format("create answered {} and set error.code to {}", status_name(status), error.code);
    const std::string problem = text_problem(error);
    if (!problem.empty()) return fmt::format("create answered {}: {}", status_name(status), problem);
    if (error.item != -1) return fmt::format("create set error.item to {}; it has no items (-1)", error.item);
    if (are_described && (status == PLR_E_EXCEPTION || status == PLR_E_ARGUMENT))
        return fmt::format(
            "create answered {}; a value that it cannot take is PLR_E_PARAMETER, and error.where names it",
            refused.told());
    if (status != PLR_E_PARAMETER && status != PLR_E_PART) return {};
    const std::string where = error.where, head = where.substr(0, where.find_first_of(".["));
    const std::set<std::string> names = names_of(description);
    if (names.count(head) == 0)
        return fmt::format("create answered {}, and error.where is `{}`, which is none of {}", refused.told(), where,
                           fmt::join(names, ", "));
    return {};
}

}  // namespace pelorus::conformance
