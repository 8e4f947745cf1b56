/// A call of a model, taken apart: its arguments as arrays, so that what every call promises can be tried on all of them alike
/// (inputs unmodified, nothing written outside the views, batch equals singles, and so on).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <pelorus/abi/abi.h>

#include "instance.hpp"
#include "sample.hpp"
#include "watch.hpp"

namespace pelorus::conformance {

/// What an output promises.
enum class Content {
    finite,
    covariance,  ///< symmetric, no negative eigenvalues
    number,      ///< not NaN, but infinity is an answer
    opaque       ///< a record or an index: nobody's business but the plugin's; elements may be left unwritten
};

/// One array of a batch: an item's matrix is rows x cols, packed, items behind one another.
struct Argument {
    std::string name;
    std::int64_t rows = 0, cols = 0;
    std::vector<double> values;  ///< inputs: rows * cols doubles an item, or one matrix where it is common
    bool is_common = false;      ///< inputs: one matrix for all items (item_stride 0)
    std::vector<std::int64_t>
        offsets;  ///< ragged: item i owns the matrices offsets[i] .. offsets[i + 1] - 1; else empty
    Content content = Content::finite;  ///< outputs; inputs: finite or covariance
    bool is_absent = false;             ///< data NULL
    bool is_weightless = false;         ///< inputs: outputs need not depend on it (a dt of a call that ignores it)
};

/// What invoke is handed: views in the order of the arguments. Ragged inputs have their offsets beside them.
struct Views {
    std::vector<plr_const_view> in;
    std::vector<plr_view> out;
    std::vector<const std::int64_t*> offsets;  ///< by input, nullptr where not ragged
};

struct HotCall {
    std::string function;  ///< `propagate`, or `propagate (sigma points)`
    std::int64_t count = 0;
    std::vector<Argument> in, out;
    std::function<plr_status(const plr_call& call, const Views& views)> invoke;
    bool is_per_item = true;           ///< false: one item by nature (a partitioner's scan): no batches to compare
    std::uint64_t scratch_beyond = 0;  ///< bytes that this call may need beyond what info() asks for any call
    bool takes_pointers = false;       ///< bare ones, which tell no shape
    bool may_refuse = false;           ///< an item may fail on plausible arguments (no inverse there)

    /// The same call for some of its items, in that order.
    HotCall of_items(const std::vector<std::int64_t>& items) const;
    /// Item i's matrices of an argument, as they lie in `values`.
    static std::vector<double> item_of(const Argument& argument, const std::vector<double>& values, std::int64_t item);
};

struct ExecuteOptions {
    std::int64_t gap = 0;     ///< doubles between the items of every array
    bool transposed = false;  ///< arrays stored row by row (row and column strides swapped)
    unsigned watch = 0;       ///< watch::Concern
    bool without_item_status = false;
    bool is_guarded = true;  ///< false: plain memory, for speed
    bool has_slack = false;  ///< room behind outputs and scratch memory: what is written past their end is let pass
    bool is_null_if_empty = false;          ///< arrays of no items have data NULL
    std::int64_t item_offset = 0;           ///< plr_call.item_offset
    std::uint32_t extra_struct_bytes = 0;   ///< of plr_call and plr_error; a multiple of 8, at most 64
    std::vector<double> inputs;             ///< plr_call.inputs; empty: the instance's defaults
    std::int64_t input_stride = 0;          ///< plr_call.input_stride
    bool without_inputs = false;            ///< plr_call.inputs NULL
    std::vector<std::uint64_t> item_ids;    ///< empty: NULL
    std::optional<unsigned char> stack_of;  ///< fills the stack that the call will use with this byte
};

struct Execution {
    plr_status status = PLR_OK;
    std::vector<plr_status> items;
    plr_error error{};
    std::vector<std::vector<double>> out;  ///< by output, packed; GuardedMemory::pattern() where nothing was written
    std::string left_by;                   ///< what an exception said that left the call; "" if none did
    std::vector<std::string> stray;        ///< writes between items or before an array, in words
    std::uint64_t scratch_left_used = 0;   ///< of the scratch memory after the call; has to be 0
    watch::Offence offence;
    double seconds = 0;  ///< of the call itself

    bool failed(std::int64_t item) const { return !items.empty() && items[static_cast<std::size_t>(item)] != PLR_OK; }
    std::string told() const;
};

/// Makes the call once, with guarded memory and scratch memory of just the size that info() asks for.
Execution execute(const Instance& instance, const HotCall& call, const ExecuteOptions& options = {});
/// Fails the check unless the call went well for every item (or, where it may refuse, for those it did not refuse).
Execution execute_well(const Instance& instance, const HotCall& call, const ExecuteOptions& options = {});

/// Makes the call for the sake of its outputs, as arguments of others: whether it keeps its promises is for the checks to say.
Execution execute_leniently(const Instance& instance, const HotCall& call);

/// Whether two executions answered the same bits for item i of the first and item k of the second; else says where not.
bool same_item(const HotCall& one_call, const Execution& one, std::int64_t i, const HotCall& other_call,
               const Execution& other, std::int64_t k, std::string& difference);
/// Likewise for all items, and the status of the call.
bool same_answer(const HotCall& call, const Execution& one, const Execution& other, std::string& difference);
/// `out[2, 1] of item 3`
std::string element_name(const Argument& argument, std::int64_t item, std::int64_t row, std::int64_t col);

/// The calls of a model of any kind, with plausible arguments for `count` items. Fails the check where they cannot be prepared.
std::vector<HotCall> hot_calls(const Instance& instance, Sample sample, std::int64_t count);
/// What info() asks for.
std::uint64_t scratch_bytes(const Instance& instance);
/// PLR_FLAG_... of info().
std::uint32_t model_flags(const Instance& instance);

namespace detail {
/// Each kind tells its calls once.
using HotCallMaker = std::vector<HotCall> (*)(const Instance&, Sample, std::int64_t count);
using ScratchTeller = std::uint64_t (*)(const Instance&);
struct KindRegistration {
    KindRegistration(const char* table_id, HotCallMaker maker, ScratchTeller teller);
};
}  // namespace detail

}  // namespace pelorus::conformance
