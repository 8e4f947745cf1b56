// What the plugins of the zoo have in common: each does its work well, but in the function that its parameter `call` names, where it
// commits the misdeed that its parameter `fault` names. They go through raw C tables, as a plugin without the author layer
// would: nothing catches what they throw.
#pragma once

#include <csignal>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>

#include <pelorus/pelorus.hpp>

namespace zoo {

enum class Fault {
    none,
    throws,
    throws_number,
    segfault,
    overflow,
    abort,
    terminate,
    hangs,
    nan,
    infinite,
    beyond,
    between,
    input,
    inputs_of_call,
    scratch,
    status,
    unflagged,
    flagged,
    unwritten,
    asymmetric,
    negative,
    size,
    fails_one
};

template <class T> void describe(pelorus::Describe<T>& plugin) {
    plugin.parameter("fault", &T::fault)
        .initially("none")
        .choices({{"none", "works well"},
                  {"throws", "a std::exception"},
                  {"throws_number", "an exception that is no std::exception"},
                  {"segfault", "reads address 8"},
                  {"overflow", "of the stack"},
                  {"abort", "as assert does"},
                  {"terminate", "an exception leaves a noexcept function"},
                  {"hangs", "never comes back"},
                  {"nan", "in the first element of the output"},
                  {"infinite", "likewise"},
                  {"beyond", "writes one element after the output"},
                  {"between", "writes one element before the output"},
                  {"input", "changes what it was given"},
                  {"inputs_of_call", "changes the inputs in the call's context"},
                  {"scratch", "keeps scratch memory"},
                  {"status", "answers a status that is none"},
                  {"unflagged", "answers PLR_ITEMS_FAILED without a failed item"},
                  {"flagged", "answers PLR_OK with a failed item"},
                  {"unwritten", "leaves its output as it was"},
                  {"asymmetric", "a covariance that is not symmetric"},
                  {"negative", "a covariance with a negative variance"},
                  {"size", "info tells another size once work has begun"},
                  {"fails_one", "no misdeed: the first item has no result, and is flagged"}})
        .doc("the misdeed");
    plugin.parameter("call", &T::in).initially("").doc("the function that commits it");
}

// Not inlined, and with an array that is used: the compiler must not make a loop of it.
__attribute__((noinline)) inline int recurse(int depth) {
    volatile char frame[4096];
    frame[0] = static_cast<char>(depth);
    return depth < 0 ? 0 : recurse(depth + 1) + frame[0];
}

// In two steps, as the compiler sees through one.
__attribute__((noinline)) inline void throw_something() { throw std::runtime_error("nobody caught this"); }
__attribute__((noinline)) inline void throw_through_noexcept() noexcept { throw_something(); }

/// Misdeeds that need no arguments.
inline void misbehave(Fault fault) {
    switch (fault) {
        case Fault::throws:
            throw std::runtime_error("boom");
        case Fault::throws_number:
            throw 42;
        case Fault::segfault: {
            volatile std::uintptr_t address = 8;
            static_cast<void>(*reinterpret_cast<volatile int*>(address));
            break;
        }
        case Fault::overflow:
            static_cast<void>(recurse(0));
            break;
        case Fault::abort:
            std::abort();
        case Fault::terminate:
            throw_through_noexcept();
            break;
        case Fault::hangs:
            for (volatile bool goes_on = true; goes_on;) {
            }
            break;
        default:
            break;
    }
}

/// The work and, where this is the function for it, the misdeed.
template <class Zoo, class Work>
plr_status act(const Zoo& zoo, const char* function, const plr_call* call, const plr_const_view& in,
               const plr_view& out, Work&& work) {
    if (zoo.in != function) return work();
    misbehave(zoo.fault);
    if (zoo.fault == Fault::unwritten) return PLR_OK;
    const plr_status status = work();
    const std::int64_t last = (out.count - 1) * out.item_stride + (out.cols - 1) * out.col_stride + out.rows - 1;
    switch (zoo.fault) {
        case Fault::nan:
            out.data[0] = std::numeric_limits<double>::quiet_NaN();
            break;
        case Fault::infinite:
            out.data[0] = std::numeric_limits<double>::infinity();
            break;
        case Fault::beyond:
            out.data[last + 1] = 1;
            break;
        case Fault::between:
            out.data[-1] = 1;
            break;
        case Fault::input:
            const_cast<double*>(in.data)[0] += 1;
            break;
        case Fault::inputs_of_call:
            const_cast<double*>(call->inputs)[0] += 1;
            break;
        case Fault::scratch:
            call->scratch->used += 64;
            break;
        case Fault::status:
            return 7;
        case Fault::unflagged:
            return PLR_ITEMS_FAILED;
        case Fault::flagged:
            call->item_status[0] = PLR_E_NUMERIC;
            break;
        case Fault::asymmetric:
            out.data[out.col_stride] += 1;
            break;
        case Fault::negative:
            out.data[0] = -1;
            break;
        case Fault::fails_one:
            out.data[0] = std::numeric_limits<double>::quiet_NaN();
            call->item_status[0] = PLR_E_NUMERIC;
            return PLR_ITEMS_FAILED;
        default:
            break;
    }
    return status;
}

/// As the author layer makes an instance, and then the misdeed of `create`, with nothing left behind.
template <class T> plr_status create(const plr_config* config, plr_instance* out, plr_error* error) {
    const plr_status status = pelorus::detail::create<T>(config, out, error);
    if (status != PLR_OK) return status;
    const auto* made = static_cast<T*>(out->self);
    if (made->in != "create") return status;
    const Fault fault = made->fault;
    delete made;
    misbehave(fault);
    return PLR_OK;
}

template <class T> void destroy(void* self) {
    const auto* dying = static_cast<T*>(self);
    const Fault fault = dying->in == "destroy" ? dying->fault : Fault::none;
    delete dying;
    misbehave(fault);
}

template <class T> const plr_plugin* plugin(const char* id, const char* wanted) {
    const plr_plugin* well_made = pelorus::detail::plugin<T>(id, wanted);
    if (well_made == nullptr) return nullptr;
    static const plr_plugin own{sizeof own, 0, well_made->description, well_made->table_id, &create<T>};
    return &own;
}

}  // namespace zoo

#define ZOO_PLUGIN(Class, id_)                                                                             \
    __attribute__((section(PLR_MANIFEST_SECTION), used)) static constexpr plr_manifest zoo_manifest =      \
        ::pelorus::detail::manifest<Class>(id_);                                                           \
    extern "C" {                                                                                           \
    static const plr_plugin* zoo_factory(const char* wanted) { return ::zoo::plugin<Class>(id_, wanted); } \
    extern PLR_EXPORT const plr_entry_point plr_entry;                                                     \
    const plr_entry_point plr_entry = {                                                                    \
        sizeof(plr_entry_point), PLR_ABI_MAJOR, PLR_ABI_MINOR, nullptr, nullptr, &zoo_factory};            \
    }                                                                                                      \
    static_assert(sizeof(zoo_manifest) == sizeof(plr_manifest), "one ZOO_PLUGIN a library")
