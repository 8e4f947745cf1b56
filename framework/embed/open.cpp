// Versions, log, opening and closing.
#include <chrono>
#include <string_view>
#include <thread>

#include "embed/boundary.hpp"
#include "embed/handles.hpp"
#include "graph/document.hpp"
#include "host/log.hpp"
#include "host/services.hpp"

namespace {

using namespace pelorus::embed;

const char* text_or_refuse(const char* text, const std::string& name) {
    if (text == nullptr) refuse(name + " is NULL");
    return text;
}

template <class Entry> void require_list(const Entry* first, std::uint32_t count, const char* name) {
    if (count > 0 && first == nullptr)
        refuse(std::string(name) + " is NULL, expected " + std::to_string(count) + " entries");
}

Options read_options(const pelorus_options* from) {
    const pelorus_options raw = given(from, "options");
    Options options;
    options.threads = raw.threads == 0 ? 1 : raw.threads == PELORUS_ALL_CORES ? 0 : raw.threads;
    if (options.threads > 1024)
        refuse("options.threads is " + std::to_string(raw.threads) + ", expected at most 1024 or PELORUS_ALL_CORES");
    require_list(raw.plugin_folders, raw.plugin_folder_count, "options.plugin_folders");
    require_list(raw.overrides, raw.override_count, "options.overrides");
    require_list(raw.variables, raw.variable_count, "options.variables");
    for (std::uint32_t i = 0; i < raw.plugin_folder_count; ++i)
        options.plugin_folders.emplace_back(text_or_refuse(raw.plugin_folders[i], "options.plugin_folders"));
    for (std::uint32_t i = 0; i < raw.override_count; ++i)
        options.overrides.push_back({text_or_refuse(raw.overrides[i].name, "options.overrides"),
                                     text_or_refuse(raw.overrides[i].value, "options.overrides")});
    for (std::uint32_t i = 0; i < raw.variable_count; ++i)
        options.variables[text_or_refuse(raw.variables[i].name, "options.variables")] =
            text_or_refuse(raw.variables[i].value, "options.variables");
    if (raw.seed != nullptr) options.overrides.push_back({"run.seed", std::to_string(*raw.seed)});
    if (raw.result_folder != nullptr) {
        if (*raw.result_folder == '\0') refuse("options.result_folder is empty, expected a folder or NULL");
        options.result_folder = raw.result_folder;
    }
    return options;
}

/// `load` reads the document with the overrides that the options have.
template <class Load>
plr_status open(const pelorus_options* given_options, pelorus_pipeline** out, plr_error* error, Load load) noexcept {
    if (out != nullptr) *out = nullptr;
    return call(error, [&] {
        require(out, "out");
        const Options options = read_options(given_options);
        *out = new pelorus_pipeline(load(options), options);
    });
}

const char* level_name(std::int32_t level) {
    static const char* const names[] = {"trace", "debug", "info", "warning", "error"};
    if (level < PLR_LOG_TRACE || level > PLR_LOG_ERROR)
        refuse("level is " + std::to_string(level) + ", expected PLR_LOG_TRACE to PLR_LOG_ERROR (0 to 4)");
    return names[level];
}

}  // namespace

extern "C" {

uint32_t pelorus_api_version(void) { return PELORUS_API_MAJOR * 65536u + PELORUS_API_MINOR; }
const char* pelorus_version(void) { return PELORUS_VERSION; }
const char* pelorus_messages_id(void) { return PLR_MESSAGES; }

int32_t pelorus_serves(uint32_t api_major, uint32_t api_minor, const char* messages_id) {
    const bool same_minor = api_minor == PELORUS_API_MINOR;
    const bool new_enough = PELORUS_API_MAJOR > 0 && api_minor < PELORUS_API_MINOR;
    const bool same_messages = messages_id != nullptr && std::string_view(messages_id) == PLR_MESSAGES;
    return api_major == PELORUS_API_MAJOR && (same_minor || new_enough) && same_messages;
}

const char* pelorus_error_text(void) { return text_of_last_error(); }

plr_status pelorus_set_log(int32_t level, pelorus_log_function write, void* context, plr_error* error) {
    return call(error, [&] {
        pelorus::host::set_log_level(level_name(level));
        if (write == nullptr) return pelorus::host::set_log_target(nullptr);
        pelorus::host::set_log_target(
            [write, context](std::int32_t at, const std::string& name, const std::string& line) {
                const WithinLog within;
                write(context, at, name.c_str(), line.c_str());
            });
    });
}

plr_status pelorus_open(const char* file, const pelorus_options* options, pelorus_pipeline** out, plr_error* error) {
    return open(options, out, error, [&](const Options& read) {
        return pelorus::graph::Document::load(text_or_refuse(file, "file"), read.overrides);
    });
}

plr_status pelorus_open_text(const char* text, const char* name, const char* base, const pelorus_options* options,
                             pelorus_pipeline** out, plr_error* error) {
    return open(options, out, error, [&](const Options& read) {
        return pelorus::graph::Document::parse(text_or_refuse(text, "text"), text_or_refuse(name, "name"),
                                               text_or_refuse(base, "base"), read.overrides);
    });
}

void pelorus_close(pelorus_pipeline* pipeline) {
    if (pipeline == nullptr) return;
    // Whoever is within a call, perhaps waiting for a live source, is asked out first.
    while (pipeline->busy.exchange(true, std::memory_order_acquire)) {
        pipeline->own.stop();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    delete pipeline;
}

}  // extern "C"
