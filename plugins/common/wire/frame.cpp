#include "frame.hpp"

#include <algorithm>
#include <utility>

namespace wire {

namespace {

/// A column that one part has and the other has not would leave rows without a cell.
template <class Column> bool agree(const Column& whole, std::size_t whole_rows, const Column& part, std::size_t rows) {
    return whole_rows == 0 || rows == 0 || whole.empty() == part.empty();
}

template <class Column> void extend(Column& whole, const Column& part) {
    whole.insert(whole.end(), part.begin(), part.end());
}

}  // namespace

std::size_t Frame::bytes() const noexcept {
    std::size_t list = 0;
    for (const auto& ids_of_row : measurements) list += sizeof ids_of_row + ids_of_row.size() * sizeof(std::uint64_t);
    return sizeof(Frame) + list +
           8 * (values.size() + covariances.size() + ids.size() + times.size() + snr.size() + waveform.size() +
                parents.size() + births.size() + extents.size());
}

std::size_t Datagram::bytes() const noexcept {
    std::size_t sum = sizeof(Datagram) + sender.size();
    for (const Frame& frame : frames) sum += frame.bytes();
    return sum;
}

bool append(Frame& whole, const Frame& part) {
    const std::size_t before = whole.rows(), added = part.rows();
    const bool next = part.kind == whole.kind && part.part[1] == whole.part[1] && part.part[0] == whole.part[0] + 1 &&
                      part.time == whole.time && part.arrival == whole.arrival && part.sensor == whole.sensor &&
                      part.width == whole.width && part.waveform == whole.waveform &&
                      part.extent_dimension == whole.extent_dimension && part.common == whole.common;
    if (!next || (whole.common && part.covariances != whole.covariances) ||
        !agree(whole.covariances, before, part.covariances, added) || !agree(whole.ids, before, part.ids, added) ||
        !agree(whole.times, before, part.times, added) || !agree(whole.snr, before, part.snr, added) ||
        !agree(whole.parents, before, part.parents, added) || !agree(whole.births, before, part.births, added) ||
        !agree(whole.measurements, before, part.measurements, added))
        return false;
    whole.part[0] = part.part[0];
    extend(whole.values, part.values);
    if (!whole.common) extend(whole.covariances, part.covariances);
    extend(whole.ids, part.ids);
    extend(whole.times, part.times);
    extend(whole.snr, part.snr);
    extend(whole.parents, part.parents);
    extend(whole.births, part.births);
    extend(whole.extents, part.extents);
    extend(whole.measurements, part.measurements);
    return true;
}

std::optional<std::uint64_t> doubled_id(const Frame& frame) {
    std::vector<std::pair<std::uint64_t, std::int64_t>> keys;
    for (std::size_t i = 0; i < frame.ids.size(); ++i) {
        const bool timed = frame.kind == Kind::truth && !frame.times.empty();
        keys.emplace_back(frame.ids[i], timed ? frame.times[i] : 0);
    }
    std::sort(keys.begin(), keys.end());
    const auto found = std::adjacent_find(keys.begin(), keys.end());
    if (found == keys.end()) return std::nullopt;
    return found->first;
}

}  // namespace wire
