/// Calls across the ABI as C++ sees them: plr_error filled in and read, exceptions kept from crossing.
#pragma once

#include <cstddef>
#include <exception>
#include <string>
#include <string_view>

#include <pelorus/abi/status.h>

namespace pelorus::host {

/// A plr_error in which nothing has been told yet.
plr_error empty_error() noexcept;

/// Tells an error (cut to what the struct holds) unless one was told before; `error` may be nullptr. Answers `code`.
plr_status tell(plr_error* error, plr_status code, std::string_view message, std::string_view where = {}) noexcept;

/// `PLR_E_DATA` and so on; `status -99` for a number that is not a status.
std::string status_name(plr_status status);

/// A C string of at most `capacity` bytes, from somebody else's memory, as one printable line. nullptr gives "".
std::string one_line(const char* text, std::size_t capacity);

/// What went wrong, as one line: the callee's message and where, or the status's name if it told nothing.
std::string error_text(plr_status status, const plr_error& error);

/// Makes a call into a plugin. C++ promises nothing about exceptions that leave a C function, but where one arrives it
/// becomes PLR_E_EXCEPTION with its text; a failure about which nothing was told gets its code filled in.
template <class Call> plr_status guarded(plr_error& error, Call&& call) noexcept {
    plr_status status = PLR_OK;
    try {
        status = call();
    } catch (const std::exception& exception) {
        error.code = PLR_OK;  // the exception is what ended the call
        return tell(&error, PLR_E_EXCEPTION, exception.what());
    } catch (...) {
        error.code = PLR_OK;
        return tell(&error, PLR_E_EXCEPTION, "an exception of unknown type");
    }
    if (status < 0 && error.code == PLR_OK) error.code = status;
    return status;
}

/// Answers a call from a plugin: `work` gets an error of its own, which goes to the caller's (who may have given nullptr)
/// unless one was told there before. No exception leaves.
template <class Work> plr_status answer(plr_error* error, Work&& work) noexcept {
    plr_error own = empty_error();
    const plr_status status = guarded(own, [&] { return work(own); });
    if (own.code != PLR_OK && error != nullptr && error->code == PLR_OK) {
        const std::uint32_t struct_size = error->struct_size;
        *error = own;
        error->struct_size = struct_size;
    }
    return status;
}

}  // namespace pelorus::host
