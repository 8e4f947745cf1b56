/// The answer of a split, into the caller's buffers.
#pragma once

#include <cstdint>

#include "groups.hpp"
#include "scan.hpp"

namespace partition {

/// Appends members to cells and cells to alternatives. What the buffers do not hold is counted and not written, so that a call
/// tells what it needs in the same breath.
class Writer {
public:
    explicit Writer(plr_partition& out) noexcept : out_(out) {
        if (out_.alternative_offsets != nullptr) out_.alternative_offsets[0] = 0;
        if (out_.cell_offsets != nullptr) out_.cell_offsets[0] = 0;
    }

    /// Members ascend; weights of a cell sum to 1.
    void member(std::int64_t point, double weight) noexcept {
        if (members_ < out_.member_capacity) {
            out_.member_points[members_] = point;
            out_.member_weights[members_] = weight;
        }
        ++members_;
    }
    /// Ends the cell of the members since the last one.
    void cell(std::int64_t prediction) noexcept {
        if (cells_ < out_.cell_capacity) {
            out_.cell_predictions[cells_] = prediction;
            out_.cell_offsets[cells_ + 1] = members_;
        }
        ++cells_;
    }
    /// Ends the alternative of the cells since the last one.
    void alternative(double weight) noexcept {
        if (alternatives_ < out_.alternative_capacity) {
            out_.alternative_weights[alternatives_] = weight;
            out_.alternative_offsets[alternatives_ + 1] = cells_;
        }
        ++alternatives_;
    }

    /// A cell of each group, of no prediction, its members alike. point_of(i): the point that is meant by the groups' i.
    template <class PointOf> void cells(const Groups& groups, const PointOf& point_of) noexcept {
        for (std::uint32_t group = 0; group < groups.count(); ++group) {
            const std::uint32_t size = groups.size(group);
            const double weight = 1.0 / size;
            for (std::uint32_t k = 0; k < size; ++k) member(point_of(groups.begin(group)[k]), weight);
            cell(-1);
        }
    }
    void cells(const Groups& groups) noexcept {
        cells(groups, [](std::uint32_t i) { return i; });
    }

    /// Tells the sizes. PLR_E_CAPACITY where something was not written.
    plr_status finish() noexcept {
        out_.alternatives = alternatives_;
        out_.cells = cells_;
        out_.members = members_;
        const bool fits = alternatives_ <= out_.alternative_capacity && cells_ <= out_.cell_capacity &&
                          members_ <= out_.member_capacity;
        return fits ? PLR_OK : PLR_E_CAPACITY;
    }

private:
    plr_partition& out_;
    std::int64_t alternatives_ = 0, cells_ = 0, members_ = 0;
};

}  // namespace partition
