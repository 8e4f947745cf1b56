#include "host/guard/guarded_call.hpp"

#include "host/guard/info.hpp"

namespace pelorus::host {

std::string text_of_current_exception() noexcept {
    try {
        throw;
    } catch (const std::exception& exception) {
        return "an exception came through the C table: " + one_line(exception.what(), sizeof plr_error{}.message);
    } catch (...) {
        return "an exception came through the C table, of a type that is no std::exception";
    }
}

void tell_fault(const GuardRecord& record, const char* function, const std::string& text) noexcept {
    record.fail(nullptr, PLR_E_EXCEPTION, -1, record.call_name(function) + ": " + text);
}

void tell_exception(const GuardRecord& record, const char* function) noexcept {
    tell_fault(record, function, text_of_current_exception());
}

plr_status tell_broken_contract(const GuardRecord& record, const char* function, const plr_call& call,
                                const BrokenContract& broken) noexcept {
    plr_error unused = empty_error();
    return guarded(unused, [&] {
        const std::int64_t item = broken.item < 0 ? -1 : call.item_offset + broken.item;
        const std::string where =
            record.call_name(function) + (item < 0 ? "" : ", item " + std::to_string(item)) + ": ";
        if (broken.by_holder)
            return record.fail(call.error, PLR_E_ARGUMENT, -1,
                               where + "its holder " + record.holder + " called it wrongly: " + broken.what());
        return record.fail(call.error, PLR_E_PART, -1, where + broken.what());
    });
}

}  // namespace pelorus::host
