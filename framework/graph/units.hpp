/// Quantities as people write them ("3 mrad", "25 km", "1e-3 m2/s3", "20 dB") to SI numbers.
///
///     quantity = number [unit]
///     unit     = ["1"] ["/"] factor { ("*" | " " | "/") factor }       from left to right: m/s/s = m/s2
///     factor   = name [["^"] ["-"] digits]                             m2, m^2, s-1
///
/// rad is a dimension of its own, so that an angle is never taken for a pure number. dB is a power ratio and stands alone.
#pragma once

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace pelorus::graph {

/// What is wrong with a quantity or a unit; one line without a place.
struct UnitError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Powers of m, s, kg, rad, A, K.
struct Dimension {
    std::array<int, 6> powers{};
    bool operator==(const Dimension& other) const noexcept { return powers == other.powers; }
    bool operator!=(const Dimension& other) const noexcept { return !(*this == other); }
};

/// A quantity in SI is number x 10^decimal x numerator / denominator, or 10^(number / 10) for dB.
struct Unit {
    Dimension dimension;
    int decimal = 0;
    double numerator = 1, denominator = 1;
    bool decibel = false;

    bool is_si() const noexcept { return !decibel && decimal == 0 && numerator == denominator; }
};

/// Throws UnitError. "" is the unit of pure numbers.
Unit parse_unit(const std::string& text);

/// `time`, `speed`, or "" for a dimension without a common name.
std::string dimension_name(const Dimension& dimension);

/// A finite decimal number, the whole text. Throws UnitError: no hexadecimal, no underscores, no nan, no inf.
double parse_number(const std::string& text);

/// A whole number, the whole text. Throws UnitError.
std::int64_t parse_integer(const std::string& text);

/// A quantity in the SI unit `expected` ("m", "m2/s3", ""); a number without a unit is taken as it stands.
/// Throws UnitError: `expected a value in m, got '3 s' (s is a time)`.
double parse_quantity(const std::string& text, const std::string& expected);

/// A time such as "30 s" or "2 min" in nanoseconds, rounded to the nearest; a number without a unit is in seconds.
/// Throws UnitError.
std::int64_t parse_time(const std::string& text);

}  // namespace pelorus::graph
