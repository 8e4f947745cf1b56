#include "embed/boundary.hpp"

#include <new>

#include "host/error.hpp"
#include "host/plugin_error.hpp"
#include "runtime/message_check.hpp"
#include "runtime/runtime.hpp"

namespace pelorus::embed {
namespace {

struct Told {
    plr_status code;
    std::int64_t item;
    std::string text;
};

/// Of the exception that is being handled.
Told told() {
    try {
        throw;
    } catch (const Failure& failure) {
        return {failure.code(), failure.item(), failure.what()};
    } catch (const runtime::LateMessage& late) {
        return {PELORUS_E_LATE, late.item(), late.what()};
    } catch (const runtime::BadMessage& bad) {
        return {PLR_E_ARGUMENT, bad.item(), bad.what()};
    } catch (const Error& error) {
        return {error.exit() == Exit::misuse ? plr_status{PELORUS_E_CONFIG} : plr_status{PELORUS_E_FAILED}, -1,
                error.what()};
    } catch (const std::bad_alloc&) {
        return {PLR_E_MEMORY, -1, "out of memory"};
    } catch (const std::exception& exception) {
        return {PLR_E_EXCEPTION, -1, exception.what()};
    } catch (...) {
        return {PLR_E_EXCEPTION, -1, "an exception of unknown type"};
    }
}

std::string& thread_text() {
    thread_local std::string text;
    return text;
}

bool& is_within_log() {
    thread_local bool within = false;
    return within;
}

bool has_room(const plr_error* error) { return error != nullptr && error->struct_size >= sizeof(plr_error); }

}  // namespace

WithinLog::WithinLog() { is_within_log() = true; }
WithinLog::~WithinLog() { is_within_log() = false; }

void begin_call(plr_error* error) {
    thread_text().clear();
    if (error != nullptr) {
        if (!has_room(error))
            refuse("error.struct_size is " + std::to_string(error->struct_size) + ", expected at least " +
                   std::to_string(sizeof(plr_error)));
        const std::uint32_t size = error->struct_size;
        *error = host::empty_error();
        error->struct_size = size;
    }
    if (is_within_log())
        throw Failure(PELORUS_E_BUSY, "a log function may call nothing of this library but pelorus_stop");
}

plr_status tell_current_exception(plr_error* error) noexcept {
    try {
        Told all = told();
        const std::size_t end = all.text.find('\n');
        if (has_room(error)) {
            host::tell(error, all.code, std::string_view(all.text).substr(0, end));
            error->item = all.item;
        }
        thread_text() = std::move(all.text);
        return all.code;
    } catch (...) {  // not even the text could be made
        if (has_room(error)) host::tell(error, PLR_E_MEMORY, "out of memory");
        return PLR_E_MEMORY;
    }
}

const char* text_of_last_error() noexcept { return thread_text().c_str(); }

}  // namespace pelorus::embed
