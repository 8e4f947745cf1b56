/// The boundary at which what the host throws becomes status, line and text. Nothing gets through.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstring>
#include <string>
#include <utility>

#include <pelorus/embed.h>

#include "embed/failure.hpp"

namespace pelorus::embed {

/// Tells the exception that is being handled: fills `error` (which may be NULL) and the thread's text; answers the status.
plr_status tell_current_exception(plr_error* error) noexcept;

/// While it lives, this thread is within the application's log function, where the log is locked: calls are refused.
class WithinLog {
public:
    WithinLog();
    ~WithinLog();
    WithinLog(const WithinLog&) = delete;
    WithinLog& operator=(const WithinLog&) = delete;
};

/// Empties `error` and the thread's text. Throws Failure if `error` is too small, or within the log function.
void begin_call(plr_error* error);

/// The text of this thread's last failed call.
const char* text_of_last_error() noexcept;

[[noreturn]] inline void refuse(const std::string& text) { throw Failure(PLR_E_ARGUMENT, text); }

template <class Pointer> void require(Pointer* pointer, const char* name) {
    if (pointer == nullptr) refuse(std::string(name) + " is NULL");
}

/// A call of the API: `work` does it, by throwing or not.
template <class Work> plr_status call(plr_error* error, Work&& work) noexcept {
    try {
        begin_call(error);
        work();
        return PLR_OK;
    } catch (...) {
        return tell_current_exception(error);
    }
}

/// One thread at a time within a pipeline.
class Occupied {
public:
    explicit Occupied(std::atomic<bool>& busy) : busy_(busy) {
        if (busy_.exchange(true, std::memory_order_acquire))
            throw Failure(PELORUS_E_BUSY, "another call on this pipeline is under way");
    }
    ~Occupied() { busy_.store(false, std::memory_order_release); }
    Occupied(const Occupied&) = delete;
    Occupied& operator=(const Occupied&) = delete;

private:
    std::atomic<bool>& busy_;
};

/// A struct that the application gives: what it knows of it, the rest zero.
template <class Struct> Struct given(const Struct* from, const char* name) {
    Struct known{};
    known.struct_size = sizeof known;
    if (from == nullptr) return known;
    if (from->struct_size < sizeof known)  // the first version of every struct is the present one
        refuse(std::string(name) + ".struct_size is " + std::to_string(from->struct_size) + ", expected at least " +
               std::to_string(sizeof known));
    std::memcpy(&known, from, sizeof known);
    known.struct_size = sizeof known;
    return known;
}

/// A struct that the application wants filled in; what it has beyond ours becomes zero.
template <class Struct> void answer(Struct* to, const Struct& from, const char* name) {
    require(to, name);
    const std::uint32_t size = to->struct_size;
    if (size < sizeof from)
        refuse(std::string(name) + ".struct_size is " + std::to_string(size) + ", expected at least " +
               std::to_string(sizeof from));
    std::memset(static_cast<void*>(to), 0, size);
    std::memcpy(static_cast<void*>(to), &from, sizeof from);
    to->struct_size = size;
}

}  // namespace pelorus::embed
