/// Normalised innovations squared, from trackers to analyzers (see abi/consistency.h).
///
/// A tracker:   InnovationsBuilder innovations_;                           // an out port of PLR_MESSAGE_VALUES
///              innovations_.add(track.id, squared, components);           // each update of a scan
///              publish(port, innovations_.message(event.time)); innovations_.clear();
/// An analyzer: void on_values(const Event&, const plr_values& values) { for_each_innovation(values, [&](const Innovation& i) { ... }); }
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <pelorus/abi/consistency.h>
#include <pelorus/messages.hpp>

namespace pelorus {

struct Innovation {
    std::uint64_t track = 0;
    std::int64_t time = 0;  ///< ns
    double squared = 0;     ///< e' S^-1 e
    double components = 0;  ///< of e
};

/// message() is valid until the builder is changed or dies.
class InnovationsBuilder {
public:
    void clear() {
        ids_.clear();
        numbers_.clear();
    }
    void add(std::uint64_t track, double squared, int components) {
        ids_.push_back(track);
        numbers_.push_back(squared);
        numbers_.push_back(components);
    }
    std::int64_t count() const noexcept { return static_cast<std::int64_t>(ids_.size()); }

    /// Of the scan at `time` (ns). With at least one innovation.
    const plr_message& message(std::int64_t time) {
        quantity_ = {sizeof(plr_quantity),
                     0,
                     "",
                     PLR_QUANTITY_INNOVATION,
                     "",
                     const_view(numbers_.data(), 2, 1, count()),
                     time,
                     time,
                     ids_.data()};
        values_ = {sizeof(plr_values), 1, &quantity_};
        message_ = detail::message_of(PLR_MESSAGE_VALUES, time);
        message_.body.values = &values_;
        return message_;
    }

private:
    std::vector<std::uint64_t> ids_;
    std::vector<double> numbers_;
    plr_quantity quantity_{};
    plr_values values_{};
    plr_message message_{};
};

/// Calls `use` for each innovation in a message; answers how many there were. Throws DataError where a quantity of that name is
/// something else; quantities of other names are passed over.
template <class Use> std::int64_t for_each_innovation(const plr_values& values, Use use) {
    std::int64_t found = 0;
    const char* at = reinterpret_cast<const char*>(values.quantities);
    for (std::uint32_t k = 0; k < values.count; ++k) {
        const auto& quantity = *reinterpret_cast<const plr_quantity*>(at);
        at += quantity.struct_size;
        if (std::string(PLR_QUANTITY_INNOVATION) != quantity.name) continue;
        const plr_const_view& v = quantity.numbers;
        if (v.rows != 2 || v.cols != 1 || quantity.ids == nullptr)
            throw DataError(std::string(quantity.name) + " is " + std::to_string(v.rows) + " x " +
                            std::to_string(v.cols) + " an item, expected 2 x 1 and ids: d^2 and its components");
        for (std::int64_t i = 0; i < v.count; ++i, ++found) {
            const double* item = v.data + i * v.item_stride;
            const Innovation one{quantity.ids[i], quantity.valid_from, item[0], item[v.row_stride]};
            if (!(one.squared >= 0) || !std::isfinite(one.squared) || !(one.components >= 1))
                throw DataError(std::string(quantity.name) + " of track " + std::to_string(one.track) +
                                " is no square of at least one component");
            use(one);
        }
    }
    return found;
}

}  // namespace pelorus
