#include "answers.hpp"

#include <cstring>
#include <sstream>

#include <fmt/format.h>

#include "check.hpp"
#include "creation.hpp"
#include "hot_call.hpp"

namespace pelorus::conformance {

namespace {

std::string call_text(const Instance& instance, const HotCall& call) {
    ExecuteOptions options;
    options.is_guarded = false;
    const Execution done = execute(instance, call, options);
    std::string text = fmt::format("{}: {}\n", call.function, done.status);
    for (std::size_t a = 0; a < call.out.size(); ++a) {
        const Argument& argument = call.out[a];
        if (argument.is_absent || argument.content == Content::opaque) continue;
        for (std::int64_t i = 0; i < call.count; ++i) {
            if (done.failed(i)) continue;
            const auto values = HotCall::item_of(argument, done.out[a], i);
            for (std::size_t e = 0; e < values.size(); ++e) {
                const auto in_matrix = static_cast<std::int64_t>(e) % (argument.rows * argument.cols);
                text += fmt::format("{}: {}: {:.17g}\n", call.function,
                                    element_name(argument, i, in_matrix % argument.rows, in_matrix / argument.rows),
                                    values[e]);
            }
        }
    }
    return text;
}

std::string ports_text(const Instance& instance) {
    const plr_stage& table = instance.table<plr_stage>();
    if (table.port_type == nullptr) return {};
    std::string text;
    const plr_description& description = instance.description();
    for (const std::uint32_t is_output : {0u, 1u})
        for (std::uint32_t p = 0; p < (is_output != 0 ? description.out_port_count : description.in_port_count); ++p) {
            plr_port_type type{};
            type.struct_size = sizeof type;
            plr_error error{};
            error.struct_size = sizeof error;
            const plr_status status = table.port_type(instance.self(), is_output, p, &type, &error);
            text += fmt::format("port_type of {} port {}: status: {}\n", is_output != 0 ? "out" : "in", p, status);
            for (std::uint32_t s = 0; s < type.stream_count; ++s) {
                const plr_stream& stream = element_of(type.streams, s);
                text += fmt::format("port_type: stream {}: sensor {}, frame {}, {} components\n", s,
                                    stream.sensor == nullptr ? "any" : stream.sensor,
                                    stream.frame == nullptr ? "any" : stream.frame,
                                    stream.space == nullptr ? 0 : stream.space->size);
            }
        }
    return text;
}

}  // namespace

std::string answers_of(const Instance& instance, const Sample& sample) {
    if (std::strcmp(instance.plugin().table_id, PLR_STAGE) == 0) return ports_text(instance);
    std::string text;
    try {
        for (const HotCall& call : hot_calls(instance, sample, 2)) text += call_text(instance, call);
    } catch (const Skipped&) {
        // A kind whose calls the suites do not know.
    }
    return text;
}

std::string first_difference(const std::string& one, const std::string& other) {
    std::istringstream mine(one), theirs(other);
    std::string x, y;
    while (true) {
        const bool has_mine = !!std::getline(mine, x), has_theirs = !!std::getline(theirs, y);
        if (!has_mine && !has_theirs) return {};
        if (!has_mine || !has_theirs) return "one of them answers more than the other: " + (has_mine ? x : y);
        if (x != y) return x + " against " + y.substr(y.rfind(": ") + 2);
    }
}

}  // namespace pelorus::conformance
