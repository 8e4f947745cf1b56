/// The functions of guard tables: find the record, check, forward, check again.
#pragma once

#include <cstddef>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "host/breadcrumb.hpp"
#include "host/first_size.hpp"
#include "host/guard/checked_call.hpp"
#include "host/guard/registry.hpp"
#include "host/plugin_error.hpp"

namespace pelorus::host {

/// What the guard has to know of a function of a model's table. Specialised for each:
///
///     static constexpr const char* name;
///     static constexpr std::size_t index;  // within its kind, below GuardRecord::most_functions
///     static void declare(CheckedCall& checks, const GuardSizes& sizes, Args& args);
///
/// Where more than views is to be looked at, `struct Kept`, made from the holder's arguments and the guard's own copy of them, sees the call
/// come back (`returned`, before outputs are handed over) and its outputs (`look`, after they were found well-formed).
template <auto Function> struct GuardedFunction;

/// For functions of which views tell everything.
struct PlainFunction {
    struct Kept {
        template <class Args> Kept(const GuardRecord&, const Args&, Args&, CheckedCall&) {}
        void returned(plr_status) const noexcept {}
        void look() const noexcept {}
    };
};

template <class Table, class Arguments>
using ModelFunction = plr_status (*Table::*)(const void*, const plr_call*, const Arguments*);

std::string text_of_current_exception() noexcept;

/// Makes the real call; an exception becomes a fault of the part. `threw` says so.
template <class Call>
plr_status forward(const GuardRecord& record, const char* function, const plr_call* call, bool& threw,
                   Call&& real) noexcept {
    CallMark mark{};
    mark.subject = record.address.c_str();
    mark.plugin = record.plugin.c_str();
    mark.call = function;
    const Breadcrumb crumb(mark);
    try {
        return real();
    } catch (...) {
        threw = true;
        return record.fail(call == nullptr ? nullptr : call->error, PLR_E_EXCEPTION, -1,
                           record.call_name(function) + ": " + text_of_current_exception());
    }
}

plr_status tell_broken_contract(const GuardRecord& record, const char* function, const plr_call& call,
                                const BrokenContract& broken) noexcept;

/// Puts the part's address, plugin and function before what it told of a failure, unless a part below has told it. What reaches the
/// user by way of holders then says where it comes from.
void name_failure(const GuardRecord& record, const char* function, const plr_call* call, plr_status status) noexcept;

/// Bytes of an argument struct as its maker knows it.
template <class Args> std::size_t size_of(const Args& args) noexcept { return args.struct_size; }
inline std::size_t size_of(const plr_view&) noexcept { return sizeof(plr_view); }

template <auto Function, class Args, class Real>
plr_status checked(const GuardRecord& record, const plr_call& call, const Args& given, Real&& real) noexcept {
    using Guarded = GuardedFunction<Function>;
    Args args{};
    std::memcpy(&args, &given, size_of(given));
    bool threw = false, called = false;
    plr_status status = PLR_OK;
    try {
        CheckedCall checks(record, call);
        Guarded::declare(checks, record.sizes, args);
        typename Guarded::Kept kept(record, given, args, checks);
        checks.begin();
        called = true;
        status = forward(record, Guarded::name, &call, threw, [&] { return real(args); });
        if (!threw) kept.returned(status);
        checks.end(status, threw);
        if (!threw && status >= 0) kept.look();
        return status;
    } catch (const BrokenContract& broken) {
        return threw ? status : tell_broken_contract(record, Guarded::name, call, broken);
    } catch (const std::bad_alloc&) {  // the guard's: forward lets none of the plugin's through
        // The guard has no memory for its stand-ins; the call itself need not suffer.
        return called ? status : forward(record, Guarded::name, &call, threw, [&] { return real(given); });
    } catch (...) {
        return record.fail(call.error, PLR_E_EXCEPTION, -1,
                           record.call_name("info") + ": " + text_of_current_exception());
    }
}

template <class Table> const Table& real_table(const GuardRecord& record) noexcept {
    return *reinterpret_cast<const Table*>(record.real.table);
}

/// An entry of a guard table.
template <auto Function, class Table, class Args>
plr_status guarded_entry(const void* self, const plr_call* call, const Args* args) noexcept {
    using Guarded = GuardedFunction<Function>;
    const GuardRecord* const record = GuardRegistry::of_process().find(self);
    if (record == nullptr)
        return tell(call == nullptr ? nullptr : call->error, PLR_E_ARGUMENT,
                    std::string(Guarded::name) + " was called on an instance that does not live");
    const auto real = [&](const auto& given) { return (real_table<Table>(*record).*Function)(self, call, &given); };
    // Arguments of a holder that was built with later headers than this host may hold what the guard cannot follow.
    const bool is_known = call != nullptr && args != nullptr && call->struct_size >= first_size<plr_call> &&
                          size_of(*args) >= sizeof(std::uint64_t) && size_of(*args) <= sizeof(Args);
    bool threw = false;
    const plr_status status = is_known && record->is_to_check(Guarded::index)
                                  ? checked<Function>(*record, *call, *args, real)
                                  : forward(*record, Guarded::name, call, threw,
                                            [&] { return (real_table<Table>(*record).*Function)(self, call, args); });
    if (status != PLR_OK) name_failure(*record, Guarded::name, call, status);
    return status;
}

/// Puts the guard's entry into the place of a function that the real table has.
template <auto Function, class Table, class Args>
void guard_function(unsigned char* table, ModelFunction<Table, Args>) noexcept {
    auto& copy = *reinterpret_cast<Table*>(table);
    const auto end = static_cast<std::size_t>(reinterpret_cast<unsigned char*>(&(copy.*Function) + 1) - table);
    if (end <= copy.head.struct_size && copy.*Function != nullptr)
        copy.*Function = &guarded_entry<Function, Table, Args>;
}

template <auto... Functions> void guard_functions(unsigned char* table) noexcept {
    (guard_function<Functions>(table, Functions), ...);
}

}  // namespace pelorus::host
