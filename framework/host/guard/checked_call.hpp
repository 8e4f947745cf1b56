/// One checked call: what goes in is fingerprinted, what comes out goes to stand-ins, and afterwards both are looked at.
///
///     CheckedCall checks(record, call);
///     checks.items(args.out.count);
///     checks.input("state", args.state, n, p);
///     checks.output("out", args.out, n, p);      // args.out.data now is the stand-in's
///     checks.begin();
///     const plr_status status = real(self, &call, &args);
///     checks.end(status);
///
/// Every function throws BrokenContract for what it finds.
#pragma once

#include <cstdint>
#include <deque>
#include <stdexcept>
#include <string>
#include <vector>

#include <pelorus/abi/call.h>

#include "host/guard/memory.hpp"
#include "host/guard/record.hpp"

namespace pelorus::host {

struct BrokenContract : std::runtime_error {
    explicit BrokenContract(const std::string& text, std::int64_t in_item = -1, bool is_holders = false)
        : std::runtime_error(text), item(in_item), by_holder(is_holders) {}
    std::int64_t item;  ///< within the call, or -1
    bool by_holder;
};

/// What an output promises.
enum class Content {
    finite,      ///< where the item's inputs are finite and the item has not failed
    not_nan,     ///< likewise, but infinity is an answer
    covariance,  ///< finite, symmetric, no negative variances
    any,         ///< every element is written, whatever it is
    opaque       ///< a record: nobody's business but the plugin's; elements may be left alone
};

class CheckedCall {
public:
    static constexpr std::int64_t any_size = -1;

    CheckedCall(const GuardRecord& record, const plr_call& call) : record_(record), call_(call) {}

    // What the call is given. Views whose data are NULL are not given and are passed over.

    /// How many items; first of all.
    void items(std::int64_t count);
    void input(const char* name, const plr_const_view& view, std::int64_t rows, std::int64_t cols);
    /// A record: non-finite elements of it are no excuse for the outputs.
    void record(const char* name, const plr_const_view& view, std::int64_t rows);
    /// A view of another count than the items' (points of all items together).
    void shared_input(const char* name, const plr_const_view& view, std::int64_t rows, std::int64_t cols,
                      std::int64_t count);
    void bytes(const char* name, const void* data, std::size_t size);

    void output(const char* name, plr_view& view, std::int64_t rows, std::int64_t cols,
                Content content = Content::finite);
    /// Of another count than the items'.
    void shared_output(const char* name, plr_view& view, std::int64_t rows, std::int64_t cols, std::int64_t count,
                       Content content);
    /// A record that comes out; `in` may be the very same memory, and remains so.
    void record_output(const char* name, plr_view& view, std::int64_t rows, const char* in_name, plr_const_view& in);
    /// An array of 8-byte elements.
    template <class Element> void output_array(const char* name, Element*& data, std::int64_t size, Content content) {
        static_assert(sizeof(Element) == sizeof(double), "arrays are watched as views of doubles");
        plr_view view{reinterpret_cast<double*>(data), size, 1, 1, 1, size, size};
        add_output(name, view, content, false);
        data = reinterpret_cast<Element*>(view.data);
    }

    /// Call context and info; after all inputs and outputs.
    void begin();
    /// The call has come back. `threw`: it has, with an exception; then only memory is looked at.
    void end(plr_status status, bool threw = false);

    /// Whether the item is to be held to what outputs promise.
    bool item_counts(std::int64_t item) const noexcept;
    /// Whether all that the item depends on is finite; records apart, which are the plugin's own making.
    bool inputs_are_finite(std::int64_t item) const noexcept;

private:
    struct Input {
        const char* name;
        plr_const_view view;
        std::uint64_t before;
        bool per_item, excuses;
    };
    struct Bytes {
        const char* name;
        const void* data;
        std::size_t size;
        std::uint64_t before;
    };
    struct Output {
        const char* name;
        StandIn memory;
        Content content;
        bool per_item;
    };

    void expect(const char* name, std::int64_t rows, std::int64_t cols, std::int64_t count, std::int64_t wanted_rows,
                std::int64_t wanted_cols, std::int64_t wanted_count) const;
    void add_input(const char* name, const plr_const_view& view, bool per_item, bool excuses);
    void add_output(const char* name, plr_view& view, Content content, bool per_item, bool keeps_content = false);
    void check_memory();
    void check_status(plr_status status) const;
    void check_output(const Output& output) const;
    void check_covariance(const Output& output, std::int64_t item) const;

    const GuardRecord& record_;
    const plr_call& call_;
    std::int64_t items_ = 0;
    std::uint64_t scratch_used_ = 0;
    std::vector<plr_status> status_before_;
    std::vector<Input> inputs_;
    std::vector<Bytes> bytes_;
    std::deque<Output> outputs_;
};

}  // namespace pelorus::host
