/// How a stage calls the models in its slots: one object that holds the call context, the scratch memory and the values of the
/// models' inputs.
///
///     Caller caller_;                                   // member
///     caller_.setup(setup);                             // in setup()
///     const plr_call& call = caller_.begin(event.time, tracks.size());
///     caller_.require(motion.call(&plr_motion::propagate, call, args), "propagate");
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <pelorus/abi/message.h>
#include <pelorus/matrix.hpp>
#include <pelorus/setup.hpp>
#include <pelorus/space.hpp>

namespace pelorus {

class Caller {
public:
    /// Takes what the models may need: inputs of the whole tree at their defaults, scratch memory.
    void setup(const Setup& setup, std::size_t scratch_bytes = std::size_t{1} << 20) {
        const plr_config& config = setup.raw();
        inputs_.assign(static_cast<std::size_t>(config.input_size), 0.0);
        const char* at = reinterpret_cast<const char*>(config.inputs);
        for (std::uint32_t i = 0; i < config.input_count; ++i) {
            const auto& place = *reinterpret_cast<const plr_input_place*>(at);
            places_.push_back(
                {place.name, place.unit, place.offset, {place.defaults, place.defaults + place.size}, {}});
            at += place.struct_size;
        }
        storage_.reset(new unsigned char[scratch_bytes + 64]);
        const auto address = reinterpret_cast<std::uintptr_t>(storage_.get());
        scratch_ = {storage_.get() + (64 - address % 64) % 64, scratch_bytes, 0};
        error_.struct_size = sizeof error_;
        log_ = setup.optional_service<plr_log>();
    }

    /// Takes a `values` message: quantities named like an input of the tree (address and name joined by a dot, relative to this
    /// stage). Throws DataError for a wrong size or unit; answers how many were known.
    int take(const plr_values& values) {
        int known = 0;
        const char* at = reinterpret_cast<const char*>(values.quantities);
        for (std::uint32_t i = 0; i < values.count; ++i) {
            const auto& quantity = *reinterpret_cast<const plr_quantity*>(at);
            const std::string address = quantity.address;
            const std::string name = address.empty() ? quantity.name : address + "." + quantity.name;
            for (Place& place : places_) {
                const bool meant = place.name == name || (address.empty() && ends_with(place.name, "." + name));
                if (!meant) continue;
                place.accept(quantity);
                ++known;
            }
            at += quantity.struct_size;
        }
        return known;
    }

    /// The context for a batch of `count` items at `time` (ns). Item statuses are cleared; inputs are those valid at `time`.
    const plr_call& begin(std::int64_t time, std::int64_t count, const std::uint64_t* item_ids = nullptr,
                          const plr_key* keys = nullptr) {
        for (const Place& place : places_) {
            const std::vector<double>& now = place.valid_at(time) ? place.given.numbers : place.defaults;
            std::copy(now.begin(), now.end(), inputs_.begin() + place.offset);
        }
        status_.assign(static_cast<std::size_t>(count), PLR_OK);
        error_.code = PLR_OK;
        error_.item = -1;
        error_.where[0] = error_.message[0] = 0;
        scratch_.used = 0;
        call_ = {sizeof(plr_call),
                 0,
                 time,
                 0,
                 item_ids,
                 keys,
                 inputs_.empty() ? nullptr : inputs_.data(),
                 0,
                 &scratch_,
                 &error_,
                 status_.data(),
                 log_};
        return call_;
    }
    const plr_call& call() const noexcept { return call_; }

    /// Throws Failure with what the part told, unless the call went well for every item.
    void require(plr_status status, const std::string& what) const {
        if (status != PLR_OK) throw Failure(error_.code != PLR_OK ? error_.code : status, explain(what), error_.where);
    }
    /// The same, but single items may have failed: answers whether some did; see item_failed.
    bool tolerate(plr_status status, const std::string& what) const {
        if (status < 0) require(status, what);
        return status == PLR_ITEMS_FAILED;
    }
    bool item_failed(std::size_t i) const noexcept { return status_[i] != PLR_OK; }
    /// `what: message (item 3)`.
    std::string explain(const std::string& what) const {
        std::string text = what + ": " + (error_.message[0] == 0 ? "failed without a message" : error_.message);
        if (error_.item >= 0) text += " (item " + std::to_string(error_.item) + ")";
        return text;
    }

    /// Values of inputs that have arrived, for save and load.
    template <class Archive> void state(Archive& archive) {
        std::map<std::string, Given> given;
        for (const Place& place : places_) given[place.name] = place.given;
        archive(given);
        if constexpr (Archive::reading)
            for (Place& place : places_) place.given = given[place.name];
    }

private:
    struct Given {
        std::vector<double> numbers;
        std::int64_t valid_from = 0, valid_to = -1;
        template <class Archive> void state(Archive& archive) { archive(numbers, valid_from, valid_to); }
    };
    struct Place {
        std::string name, unit;
        std::int64_t offset;
        std::vector<double> defaults;
        Given given;
        bool valid_at(std::int64_t time) const noexcept { return time >= given.valid_from && time <= given.valid_to; }
        void accept(const plr_quantity& quantity) {
            const plr_const_view& v = quantity.numbers;
            if (static_cast<std::size_t>(v.rows * v.cols) != defaults.size())
                throw DataError("input " + name + " takes " + std::to_string(defaults.size()) + " numbers, got " +
                                std::to_string(v.rows * v.cols));
            if (unit != quantity.unit) throw DataError("input " + name + " is in " + unit + ", got " + quantity.unit);
            given.numbers.clear();
            for (std::int64_t c = 0; c < v.cols; ++c)
                for (std::int64_t r = 0; r < v.rows; ++r)
                    given.numbers.push_back(v.data[c * v.col_stride + r * v.row_stride]);
            given.valid_from = quantity.valid_from;
            given.valid_to = quantity.valid_to;
        }
    };
    static bool ends_with(const std::string& text, const std::string& tail) noexcept {
        return text.size() >= tail.size() && text.compare(text.size() - tail.size(), tail.size(), tail) == 0;
    }

    std::vector<Place> places_;
    std::vector<double> inputs_;
    std::vector<plr_status> status_;
    std::unique_ptr<unsigned char[]> storage_;
    plr_scratch scratch_{};
    plr_error error_{};
    plr_call call_{};
    const plr_log* log_ = nullptr;
};

}  // namespace pelorus
