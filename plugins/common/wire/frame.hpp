/// What a datagram says, in the units and orders of docs/wire-format.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace wire {

constexpr int version = 1;
constexpr std::size_t largest_datagram = 65507;  ///< bytes that UDP over IPv4 can carry
constexpr std::size_t longest_sender = 64;       ///< bytes of a sender's name
constexpr std::uint64_t most_parts = 10000;

enum class Kind : std::uint8_t { scan, truth, tracks, end };

/// One scan, one truth, one end, or one part of them.
struct Frame {
    Kind kind = Kind::scan;
    std::int64_t time = 0;                    ///< ns
    std::optional<std::int64_t> arrival;      ///< ns
    std::array<std::uint64_t, 2> part{1, 1};  ///< this one, from 1, and how many there are
    std::string sensor;
    std::uint64_t width = 0;          ///< components of a row
    std::vector<double> values;       ///< rows x width
    std::vector<double> covariances;  ///< rows x width x width, or one for all rows, or none
    bool common = false;              ///< one covariance was given for all rows; of one row alone, no size tells
    std::vector<std::uint64_t> ids;   ///< one a row, or none (of scans)
    std::vector<std::int64_t> times;  ///< ns, one a row, or none
    std::vector<double> snr;          ///< one a row, or none
    std::vector<double> waveform;
    std::vector<std::uint64_t> parents;                    ///< of truth: one a row, or none
    std::vector<std::int64_t> births;                      ///< ns; of truth: one a row, or none
    std::vector<double> extents;                           ///< of truth: rows x d x d, or none
    std::uint64_t extent_dimension = 0;                    ///< d
    std::vector<std::vector<std::uint64_t>> measurements;  ///< of truth: one list a row, or none

    std::size_t rows() const noexcept { return width == 0 ? 0 : values.size() / static_cast<std::size_t>(width); }
    bool common_covariance() const noexcept { return common; }
    /// Memory that the frame takes, without the room that its lists have to spare.
    std::size_t bytes() const noexcept;

    template <class Archive> void state(Archive& archive) {
        archive(kind, time, arrival, part, sensor, width, values, covariances, common, ids, times, snr, waveform,
                parents, births, extents, extent_dimension, measurements);
    }
};

/// What one datagram holds.
struct Datagram {
    std::string sender;
    std::uint64_t session = 0;
    std::optional<std::uint64_t> sequence;
    std::vector<Frame> frames;

    std::size_t bytes() const noexcept;

    template <class Archive> void state(Archive& archive) { archive(sender, session, sequence, frames); }
};

/// Appends the rows of the next part. False, and `whole` is as before, where the part is not the next one of this frame.
bool append(Frame& whole, const Frame& part);

/// An id that two rows share (of truth: at one time), which messages must not have.
std::optional<std::uint64_t> doubled_id(const Frame& frame);

}  // namespace wire
