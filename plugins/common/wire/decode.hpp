/// Datagrams that came from outside, read and checked. Nothing in them is trusted.
#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

#include <pelorus/space.hpp>

#include "frame.hpp"

namespace wire {

/// What the reader expects to be told of.
struct Vocabulary {
    struct Sensor {
        pelorus::Space measurement;
        pelorus::Space waveform;  ///< no components: the sensor has none
    };
    std::map<std::string, Sensor> sensors;
    std::string frame;     ///< name of the frame of reference
    pelorus::Space truth;  ///< no components: truth is not wanted, its content is not read
};

/// What is wrong, where, and what was expected: one line of printable ASCII.
struct BadFrame : std::runtime_error {
    explicit BadFrame(const std::string& text) : std::runtime_error(text) {}
};

/// Reads a datagram of JSON lines or of CSV, told by its first character. Throws BadFrame; `into` then has sender, session
/// and sequence as far as they could be read, and no frames. Tracks are not read beyond their envelope. A reader's memory is
/// bounded by the datagram's size.
void decode(std::string_view bytes, const Vocabulary& vocabulary, Datagram& into);

// The two formats.
void decode_json(std::string_view bytes, const Vocabulary& vocabulary, Datagram& into);
void decode_csv(std::string_view bytes, const Vocabulary& vocabulary, Datagram& into);

/// The sensor of that name. Throws BadFrame, naming those that there are.
const Vocabulary::Sensor& sensor_of(const Vocabulary& vocabulary, const std::string& name);
/// Throws BadFrame unless the matrix (n x n) is symmetric and positive definite.
void check_covariance(const double* matrix, std::size_t n, const std::string& where);
/// Checks what a line or row tells of its datagram, and takes it over from the first. Throws BadFrame.
void adopt_envelope(const Datagram& told, bool first, Datagram& into);
/// Throws BadFrame unless the part lies in 1 ... number of parts, and those within bounds.
void check_part(const std::array<std::uint64_t, 2>& part);

}  // namespace wire
