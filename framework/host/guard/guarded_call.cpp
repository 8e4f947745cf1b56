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

void name_failure(const GuardRecord& record, const char* function, const plr_call* call, plr_status status) noexcept {
    if (call == nullptr || call->error == nullptr) return;
    plr_error& error = *call->error;
    plr_error unused = empty_error();  // without memory for it, the message stays as it was told
    guarded(unused, [&]() -> plr_status {
        std::string text = one_line(error.message, sizeof error.message);
        const std::string tree = record.address.substr(0, record.address.find('.') + 1);
        if (text.compare(0, tree.size(), tree) == 0) return PLR_OK;
        if (text.empty()) text = "failed without telling why";
        const plr_status silent = status < 0 ? status : plr_status{PLR_E_NUMERIC};
        const plr_status code = error.code != PLR_OK ? error.code : silent;
        error.code = PLR_OK;  // tell() keeps what was told first
        return tell(&error, code, record.call_name(function) + ": " + text, one_line(error.where, sizeof error.where));
    });
}

}  // namespace pelorus::host
