/// How the holder of a partitioner asks it: buffers that grow as needed.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include <pelorus/parts.hpp>

namespace partition {

/// Cells of the last split, and the memory for the next one. [worker, exclusive]
class Request {
public:
    /// Splits `args` (out is filled in here): buffers and scratch memory of the call are this object's own, enlarged where the
    /// partitioner asks for it. Answers the partitioner's status; afterwards the functions below tell the cells.
    plr_status split(const pelorus::PartitionerPart& partitioner, const plr_call& call, plr_partitioner_split args) {
        const std::int64_t points = args.points.count;
        grow(1, points + args.predictions.count, points);
        const plr_partitioner_info& info = partitioner.info();
        plr_scratch scratch =
            scratch_of(info.scratch_bytes +
                       info.scratch_bytes_point * static_cast<std::uint64_t>(points + args.predictions.count));
        plr_call own = call;
        own.scratch = &scratch;
        args.out = &out_;
        plr_status status = partitioner.call(&plr_partitioner::split, own, args);
        if (status != PLR_E_CAPACITY) return status;
        grow(out_.alternatives, out_.cells, out_.members);  // overlap, or several alternatives
        scratch.used = 0;
        own.error->code = PLR_OK;
        return partitioner.call(&plr_partitioner::split, own, args);
    }

    std::int64_t alternatives() const noexcept { return out_.alternatives; }
    double weight(std::int64_t alternative) const noexcept { return alternative_weights_[index(alternative)]; }
    /// Cells of an alternative are first_cell(a) .. first_cell(a + 1) - 1.
    std::int64_t first_cell(std::int64_t alternative) const noexcept {
        return alternative_offsets_[index(alternative)];
    }
    std::int64_t cells() const noexcept { return out_.cells; }
    /// The prediction that a cell is of, or -1.
    std::int64_t prediction(std::int64_t cell) const noexcept { return cell_predictions_[index(cell)]; }
    std::int64_t size(std::int64_t cell) const noexcept {
        return cell_offsets_[index(cell + 1)] - cell_offsets_[index(cell)];
    }
    /// The points of a cell, ascending, and their weights, which sum to 1.
    const std::int64_t* points(std::int64_t cell) const noexcept {
        return member_points_.data() + cell_offsets_[index(cell)];
    }
    const double* weights(std::int64_t cell) const noexcept {
        return member_weights_.data() + cell_offsets_[index(cell)];
    }

private:
    static std::size_t index(std::int64_t i) noexcept { return static_cast<std::size_t>(i); }

    void grow(std::int64_t alternatives, std::int64_t cells, std::int64_t members) {
        alternative_offsets_.resize(std::max(alternative_offsets_.size(), index(alternatives + 1)));
        alternative_weights_.resize(alternative_offsets_.size());
        cell_offsets_.resize(std::max(cell_offsets_.size(), index(cells + 1)));
        cell_predictions_.resize(cell_offsets_.size());
        member_points_.resize(std::max(member_points_.size(), index(members)));
        member_weights_.resize(member_points_.size());
        out_ = {};
        out_.struct_size = sizeof out_;
        out_.alternative_capacity = static_cast<std::int64_t>(alternative_offsets_.size()) - 1;
        out_.cell_capacity = static_cast<std::int64_t>(cell_offsets_.size()) - 1;
        out_.member_capacity = static_cast<std::int64_t>(member_points_.size());
        out_.alternative_offsets = alternative_offsets_.data();
        out_.alternative_weights = alternative_weights_.data();
        out_.cell_offsets = cell_offsets_.data();
        out_.cell_predictions = cell_predictions_.data();
        out_.member_points = member_points_.data();
        out_.member_weights = member_weights_.data();
    }

    plr_scratch scratch_of(std::uint64_t bytes) {
        const std::uint64_t lines = bytes / sizeof(Line) + 1;
        if (lines > lines_) {
            scratch_.reset(new Line[lines]);
            lines_ = lines;
        }
        return {scratch_[0].bytes, lines_ * sizeof(Line), 0};
    }

    struct alignas(64) Line {
        unsigned char bytes[64];
    };
    std::vector<std::int64_t> alternative_offsets_, cell_offsets_, cell_predictions_, member_points_;
    std::vector<double> alternative_weights_, member_weights_;
    plr_partition out_{};
    std::unique_ptr<Line[]> scratch_;
    std::uint64_t lines_ = 0;
};

}  // namespace partition
