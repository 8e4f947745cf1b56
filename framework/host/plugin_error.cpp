#include "host/plugin_error.hpp"

#include <algorithm>
#include <cstring>

namespace pelorus::host {

namespace {

template <std::size_t Capacity> void assign(char (&field)[Capacity], std::string_view text) noexcept {
    std::size_t size = std::min(text.size(), Capacity - 1);
    // Never cut through a character: UTF-8 continuation bytes are 10xxxxxx.
    if (size < text.size())
        while (size > 0 && (static_cast<unsigned char>(text[size]) & 0xC0u) == 0x80u) --size;
    field[text.copy(field, size)] = '\0';
}

}  // namespace

plr_error empty_error() noexcept {
    plr_error error{};
    error.struct_size = sizeof error;
    error.item = -1;
    return error;
}

plr_status tell(plr_error* error, plr_status code, std::string_view message, std::string_view where) noexcept {
    if (error == nullptr || error->code != PLR_OK) return code;
    error->code = code;
    assign(error->where, where);
    assign(error->message, message);
    return code;
}

std::string status_name(plr_status status) {
    switch (status) {
        case PLR_OK:
            return "PLR_OK";
        case PLR_ITEMS_FAILED:
            return "PLR_ITEMS_FAILED";
        case PLR_E_ARGUMENT:
            return "PLR_E_ARGUMENT";
        case PLR_E_PARAMETER:
            return "PLR_E_PARAMETER";
        case PLR_E_PART:
            return "PLR_E_PART";
        case PLR_E_CAPACITY:
            return "PLR_E_CAPACITY";
        case PLR_E_SCRATCH:
            return "PLR_E_SCRATCH";
        case PLR_E_UNSUPPORTED:
            return "PLR_E_UNSUPPORTED";
        case PLR_E_NUMERIC:
            return "PLR_E_NUMERIC";
        case PLR_E_DATA:
            return "PLR_E_DATA";
        case PLR_E_STATE_VERSION:
            return "PLR_E_STATE_VERSION";
        case PLR_E_IO:
            return "PLR_E_IO";
        case PLR_E_MEMORY:
            return "PLR_E_MEMORY";
        case PLR_E_CANCELLED:
            return "PLR_E_CANCELLED";
        case PLR_E_EXCEPTION:
            return "PLR_E_EXCEPTION";
        default:
            return "status " + std::to_string(status);
    }
}

std::string one_line(const char* text, std::size_t capacity) {
    if (text == nullptr) return {};
    std::string line(text, ::strnlen(text, capacity));
    for (char& character : line) {
        const auto byte = static_cast<unsigned char>(character);
        if (byte < 0x20 || byte == 0x7F) character = ' ';
    }
    return line;
}

std::string error_text(plr_status status, const plr_error& error) {
    std::string text = one_line(error.message, sizeof error.message);
    if (text.empty())
        text = "it answered " + status_name(error.code != PLR_OK ? error.code : status) + " and told no reason";
    const std::string where = one_line(error.where, sizeof error.where);
    return where.empty() ? text : where + ": " + text;
}

}  // namespace pelorus::host
