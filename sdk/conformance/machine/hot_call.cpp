#include "hot_call.hpp"

#include <cstring>
#include <map>

#include "check.hpp"
#include "guarded_memory.hpp"
#include "library.hpp"

namespace pelorus::conformance {

namespace {

struct KindEntry {
    detail::HotCallMaker maker;
    detail::ScratchTeller teller;
};
std::map<std::string, KindEntry>& kinds() {
    static std::map<std::string, KindEntry> all;
    return all;
}
const KindEntry& kind_of(const Instance& instance) {
    const auto found = kinds().find(instance.plugin().table_id);
    if (found == kinds().end()) skip(std::string("no calls are known of ") + instance.plugin().table_id);
    return found->second;
}

std::size_t at(std::int64_t index) noexcept { return static_cast<std::size_t>(index); }

}  // namespace

namespace detail {
KindRegistration::KindRegistration(const char* table_id, HotCallMaker maker, ScratchTeller teller) {
    kinds()[table_id] = {maker, teller};
}
}  // namespace detail

std::vector<HotCall> hot_calls(const Instance& instance, Sample sample, std::int64_t count) {
    return kind_of(instance).maker(instance, sample, count);
}
std::uint64_t scratch_bytes(const Instance& instance) { return kind_of(instance).teller(instance); }

std::uint32_t model_flags(const Instance& instance) {
    // Tables of models begin alike, and so do their infos.
    struct Info {
        std::uint32_t struct_size, flags;
    };
    struct Table {
        plr_table_head head;
        const Info* (*info)(const void* self);
    };
    static_assert(offsetof(Table, info) == offsetof(plr_motion, info) &&
                  offsetof(Info, flags) == offsetof(plr_motion_info, flags));
    return instance.table<Table>().info(instance.self())->flags;
}

std::vector<double> HotCall::item_of(const Argument& argument, const std::vector<double>& values, std::int64_t item) {
    const std::int64_t size = argument.rows * argument.cols;
    std::int64_t first = argument.is_common ? 0 : item, end = first + 1;
    if (!argument.offsets.empty()) {
        first = argument.offsets[at(item)];
        end = argument.offsets[at(item + 1)];
    }
    return {values.begin() + first * size, values.begin() + end * size};
}

HotCall HotCall::of_items(const std::vector<std::int64_t>& items) const {
    HotCall some = *this;
    some.count = static_cast<std::int64_t>(items.size());
    const auto pick = [&](Argument& argument) {
        if (argument.is_common || argument.is_absent) return;
        std::vector<double> values;
        std::vector<std::int64_t> offsets{0};
        for (const std::int64_t item : items) {
            if (!argument.values.empty()) {
                const std::vector<double> own = item_of(argument, argument.values, item);
                values.insert(values.end(), own.begin(), own.end());
            }
            if (!argument.offsets.empty())
                offsets.push_back(offsets.back() + argument.offsets[at(item + 1)] - argument.offsets[at(item)]);
        }
        argument.values = std::move(values);
        if (!argument.offsets.empty()) argument.offsets = std::move(offsets);
    };
    for (Argument& argument : some.in) pick(argument);
    for (Argument& argument : some.out) pick(argument);
    return some;
}

std::string element_name(const Argument& argument, std::int64_t item, std::int64_t row, std::int64_t col) {
    std::string place = argument.cols == 1 ? "[" + std::to_string(row) + "]"
                                           : "[" + std::to_string(row) + ", " + std::to_string(col) + "]";
    return argument.name + place + " of item " + std::to_string(item);
}

bool same_item(const HotCall& one_call, const Execution& one, std::int64_t i, const HotCall& other_call,
               const Execution& other, std::int64_t k, std::string& difference) {
    if (one.failed(i) != other.failed(k)) {
        difference =
            "item " + std::to_string(i) + (one.failed(i) ? " failed here and not there" : " failed there and not here");
        return false;
    }
    if (one.failed(i)) return true;
    for (std::size_t a = 0; a < one_call.out.size(); ++a) {
        const Argument &mine = one_call.out[a], &theirs = other_call.out[a];
        if (mine.is_absent || theirs.is_absent) continue;
        const auto x = HotCall::item_of(mine, one.out[a], i), y = HotCall::item_of(theirs, other.out[a], k);
        for (std::size_t e = 0; e < std::min(x.size(), y.size()); ++e) {
            if (std::memcmp(&x[e], &y[e], sizeof(double)) == 0) continue;
            const auto in_matrix = static_cast<std::int64_t>(e) % (mine.rows * mine.cols);
            char values[80];
            std::snprintf(values, sizeof values, ": %.17g against %.17g", x[e], y[e]);
            difference = element_name(mine, i, in_matrix % mine.rows, in_matrix / mine.rows) + values;
            return false;
        }
    }
    return true;
}

bool same_answer(const HotCall& call, const Execution& one, const Execution& other, std::string& difference) {
    if (one.status != other.status) {
        difference = std::string(status_name(one.status)) + " against " + status_name(other.status);
        return false;
    }
    if (one.status < 0) return true;
    for (std::int64_t i = 0; i < call.count; ++i)
        if (!same_item(call, one, i, call, other, i, difference)) return false;
    return true;
}

std::string Execution::told() const { return conformance::told(status, error); }

}  // namespace pelorus::conformance
