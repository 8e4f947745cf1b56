/// A simulation that was recorded: where each object was, and where it was measured, tick by tick.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace simulation {

/// Two text files beside each other, NAME_meas.csv and NAME_truth.csv, of rows k,i,x,y,z without a header: tick, object (from 0 on, in the
/// order of the targets), and coordinates in m. In memory as a whole.
class Recording {
public:
    /// Reads both, `measured` being the path of the first. Throws ParameterError("recording"), with file and line where a row is wrong.
    Recording(const std::filesystem::path& measured, std::uint64_t objects);

    /// One more than the last tick that is told of.
    std::uint64_t ticks() const noexcept { return ticks_; }
    /// Position of an object at a tick (3, m), or nullptr where there is none.
    const double* truth(std::uint64_t tick, std::uint64_t object) const noexcept { return at(truth_, tick, object); }
    const double* measured(std::uint64_t tick, std::uint64_t object) const noexcept {
        return at(measured_, tick, object);
    }
    /// Of all that was read: tells another recording.
    std::uint64_t digest() const noexcept { return digest_; }

private:
    using Table = std::vector<double>;  ///< 3 x objects x ticks; not a number where there is nothing

    Table read(const std::filesystem::path& file);
    const double* at(const Table& table, std::uint64_t tick, std::uint64_t object) const noexcept;

    std::uint64_t objects_, ticks_ = 0, digest_ = 14695981039346656037u;
    Table measured_, truth_;
};

}  // namespace simulation
