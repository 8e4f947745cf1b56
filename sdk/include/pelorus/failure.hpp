/// Exceptions of the C++ author layer, and the boundary at which they become status and message.
///
/// Inside a plugin, throw: a `ParameterError` names its parameter, a `NumericError` thrown while item 7 of a batch is worked
/// on fails item 7 alone. No exception crosses the ABI: every entry point runs inside `guarded` or `for_items`.
#pragma once

#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <type_traits>
#include <utility>

#include <pelorus/abi/call.h>

namespace pelorus {

class Failure : public std::exception {
public:
    Failure(plr_status code, std::string message, std::string where = {})
        : code_(code), message_(std::move(message)), where_(std::move(where)) {}
    const char* what() const noexcept override { return message_.c_str(); }
    plr_status code() const noexcept { return code_; }
    const std::string& where() const noexcept { return where_; }

private:
    plr_status code_;
    std::string message_, where_;
};

/// The value of a parameter cannot be accepted. `parameter` may point inside: `legs[2].duration`.
struct ParameterError : Failure {
    ParameterError(std::string parameter, std::string message)
        : Failure(PLR_E_PARAMETER, std::move(message), std::move(parameter)) {}
};
/// What stands in a slot does not fit.
struct PartError : Failure {
    PartError(std::string slot, std::string message) : Failure(PLR_E_PART, std::move(message), std::move(slot)) {}
};
/// Not finite, not positive definite, did not converge.
struct NumericError : Failure {
    explicit NumericError(std::string message) : Failure(PLR_E_NUMERIC, std::move(message)) {}
};
/// Input from outside is malformed.
struct DataError : Failure {
    explicit DataError(std::string message) : Failure(PLR_E_DATA, std::move(message)) {}
};
struct UnsupportedError : Failure {
    explicit UnsupportedError(std::string message) : Failure(PLR_E_UNSUPPORTED, std::move(message)) {}
};
/// The operating system refused.
struct IoError : Failure {
    explicit IoError(std::string message) : Failure(PLR_E_IO, std::move(message)) {}
};
/// The caller broke the contract.
struct ArgumentError : Failure {
    explicit ArgumentError(std::string message) : Failure(PLR_E_ARGUMENT, std::move(message)) {}
};
/// A part that was called has failed and has told why in call.error already.
struct PartFailed : Failure {
    explicit PartFailed(plr_status code) : Failure(code, {}) {}
};

namespace detail {

/// Keeps the first error of a call.
inline void tell(plr_error* error, plr_status code, const char* message, const char* where,
                 std::int64_t item) noexcept {
    if (error == nullptr || error->struct_size < PLR_ERROR_LEAST_SIZE || error->code != PLR_OK) return;
    error->code = code;
    error->item = item;
    std::snprintf(error->where, sizeof error->where, "%s", where);
    std::snprintf(error->message, sizeof error->message, "%s", message);
    for (char* c = error->message; *c != 0; ++c)
        if (*c == '\n') *c = ' ';
}

/// Turns the exception being handled into status and message.
inline plr_status tell_current_exception(plr_error* error, std::int64_t item) noexcept {
    try {
        throw;
    } catch (const PartFailed& failure) {
        return failure.code();
    } catch (const Failure& failure) {
        tell(error, failure.code(), failure.what(), failure.where().c_str(), item);
        return failure.code();
    } catch (const std::bad_alloc&) {
        tell(error, PLR_E_MEMORY, "out of memory", "", item);
        return PLR_E_MEMORY;
    } catch (const std::exception& exception) {
        tell(error, PLR_E_EXCEPTION, exception.what(), "", item);
        return PLR_E_EXCEPTION;
    } catch (...) {
        tell(error, PLR_E_EXCEPTION, "an exception that is no std::exception", "", item);
        return PLR_E_EXCEPTION;
    }
}

}  // namespace detail

/// Runs an entry point: `body()` returns plr_status or nothing.
template <class Body> plr_status guarded(plr_error* error, Body&& body) noexcept {
    try {
        if constexpr (std::is_same_v<decltype(body()), plr_status>) {
            return body();
        } else {
            body();
            return PLR_OK;
        }
    } catch (...) {
        return detail::tell_current_exception(error, -1);
    }
}

/// Runs `body(i)` for every item of a batch; an exception fails its item alone. Answers PLR_OK, PLR_ITEMS_FAILED, or, where
/// the caller keeps no item statuses, the code of the first failure.
template <class Body> plr_status for_items(const plr_call& call, std::int64_t count, Body&& body) noexcept {
    plr_status result = PLR_OK;
    for (std::int64_t i = 0; i < count; ++i) {
        plr_status status = PLR_OK;
        try {
            body(i);
        } catch (...) {
            status = detail::tell_current_exception(call.error, call.item_offset + i);
        }
        if (status == PLR_OK) continue;
        if (call.item_status == nullptr) return status;
        call.item_status[i] = status;
        result = PLR_ITEMS_FAILED;
    }
    return result;
}

/// Throws PartFailed unless a part's call went well for every item.
inline void require(plr_status status) {
    if (status != PLR_OK) throw PartFailed(status);
}

}  // namespace pelorus
