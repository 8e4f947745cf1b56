#include "graph/units.hpp"

#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "graph/problems.hpp"

namespace pelorus::graph {

namespace {

constexpr double pi = 3.14159265358979323846;

/// A unit that does not exist, and none is near.
struct UnknownUnit : UnitError {
    using UnitError::UnitError;
};

struct NamedUnit {
    const char* name;
    Unit unit;
    bool takes_prefix;
};

Unit make(std::array<int, 6> powers, int decimal = 0, double numerator = 1, double denominator = 1) {
    return {{powers}, decimal, numerator, denominator, false};
}

/// Lengths in m, s, kg, rad, A, K. Nautical mile, knot, foot: exact by definition.
const std::vector<NamedUnit>& named_units() {
    static const std::vector<NamedUnit> units = [] {
        Unit decibel;
        decibel.decibel = true;
        return std::vector<NamedUnit>{
            {"m", make({1}), true},
            {"s", make({0, 1}), true},
            {"g", make({0, 0, 1}, -3), true},
            {"rad", make({0, 0, 0, 1}), true},
            {"A", make({0, 0, 0, 0, 1}), true},
            {"K", make({0, 0, 0, 0, 0, 1}), true},
            {"Hz", make({0, -1}), true},
            {"N", make({1, -2, 1}), true},
            {"J", make({2, -2, 1}), true},
            {"W", make({2, -3, 1}), true},
            {"Pa", make({-1, -2, 1}), true},
            {"V", make({2, -3, 1, 0, -1}), true},
            {"min", make({0, 1}, 0, 60), false},
            {"h", make({0, 1}, 0, 3600), false},
            {"d", make({0, 1}, 0, 86400), false},
            {"deg", make({0, 0, 0, 1}, 0, pi, 180), false},
            {"arcmin", make({0, 0, 0, 1}, 0, pi, 10800), false},
            {"arcsec", make({0, 0, 0, 1}, 0, pi, 648000), false},
            {"rev", make({0, 0, 0, 1}, 0, 2 * pi), false},
            {"rpm", make({0, -1, 0, 1}, 0, 2 * pi, 60), false},
            {"ft", make({1}, -4, 3048), false},
            {"nmi", make({1}, 0, 1852), false},
            {"kn", make({1, -1}, 0, 1852, 3600), false},
            {"%", make({}, -2), false},
            {"ppm", make({}, -6), false},
            {"dB", decibel, false},
        };
    }();
    return units;
}

struct Prefix {
    char letter;
    int decimal;
};
constexpr Prefix prefixes[] = {{'T', 12}, {'G', 9},  {'M', 6},  {'k', 3},   {'c', -2},
                               {'m', -3}, {'u', -6}, {'n', -9}, {'p', -12}, {'f', -15}};

Unit find_unit(const std::string& name) {
    for (const NamedUnit& candidate : named_units())
        if (name == candidate.name) return candidate.unit;
    for (const Prefix& prefix : prefixes)
        for (const NamedUnit& candidate : named_units()) {
            if (!candidate.takes_prefix || name.front() != prefix.letter || name.substr(1) != candidate.name) continue;
            Unit unit = candidate.unit;
            unit.decimal += prefix.decimal;
            return unit;
        }
    std::vector<std::string> names;
    for (const NamedUnit& candidate : named_units()) names.emplace_back(candidate.name);
    const std::string near = nearest(name, names);
    const std::string text = "there is no unit '" + name + "'";
    if (near.empty()) throw UnknownUnit(text);
    throw UnitError(text + "; did you mean '" + near + "'?");
}

/// µ, °, ², ³, · to ASCII; a no-break space to a space.
std::string to_ascii(std::string text) {
    static const std::pair<const char*, const char*> replacements[] = {
        {"\xC2\xB5", "u"}, {"\xCE\xBC", "u"}, {"\xC2\xB0", "deg"}, {"\xC2\xB2", "2"},
        {"\xC2\xB3", "3"}, {"\xC2\xB7", "*"}, {"\xC2\xA0", " "}};
    for (const auto& [from, to] : replacements)
        for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at))
            text.replace(at, std::strlen(from), to);
    return text;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_unit_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '%'; }

/// Reads a unit from left to right.
class UnitReader {
public:
    explicit UnitReader(const std::string& text) : text_(text) {}

    Unit read() {
        skip_spaces();
        bool divide = false;
        if (peek() == '1') {
            ++at_;
            skip_spaces();
            if (peek() != '/') fail();
        }
        if (peek() == '/') divide = advance();
        while (true) {
            multiply(factor(), divide);
            skip_spaces();
            if (at_ == text_.size()) break;
            divide = peek() == '/';
            if (peek() == '*' || peek() == '/') advance();
        }
        if (has_decibel_ && factors_ > 1) throw UnitError("dB stands alone, not in '" + text_ + "'");
        return unit_;
    }

private:
    [[noreturn]] void fail() const { throw UnitError("'" + text_ + "' is not a unit"); }
    char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
    void skip_spaces() {
        while (peek() == ' ' || peek() == '\t') ++at_;
    }
    bool advance() {
        ++at_;
        skip_spaces();
        return true;
    }

    Unit factor() {
        const std::size_t start = at_;
        while (is_unit_letter(peek())) ++at_;
        if (at_ == start) fail();
        Unit unit = find_unit(text_.substr(start, at_ - start));
        const int power = exponent();
        if (unit.decibel && power != 1) throw UnitError("dB stands alone, not in '" + text_ + "'");
        for (int& each : unit.dimension.powers) each *= power;
        unit.decimal *= power;
        unit.numerator = std::pow(unit.numerator, power);
        unit.denominator = std::pow(unit.denominator, power);
        return unit;
    }

    int exponent() {
        const bool caret = peek() == '^';
        if (caret) ++at_;
        const bool negative = peek() == '-';
        if (negative) ++at_;
        const std::size_t start = at_;
        while (is_digit(peek())) ++at_;
        if (at_ == start) {
            if (caret || negative) fail();
            return 1;
        }
        if (at_ - start > 1) throw UnitError("the exponent in '" + text_ + "' is too large");
        const int power = text_[start] - '0';
        if (power == 0) fail();
        return negative ? -power : power;
    }

    void multiply(const Unit& factor, bool divide) {
        const int sign = divide ? -1 : 1;
        for (std::size_t i = 0; i < unit_.dimension.powers.size(); ++i)
            unit_.dimension.powers[i] += sign * factor.dimension.powers[i];
        unit_.decimal += sign * factor.decimal;
        unit_.numerator *= divide ? factor.denominator : factor.numerator;
        unit_.denominator *= divide ? factor.numerator : factor.denominator;
        unit_.decibel = unit_.decibel || factor.decibel;
        has_decibel_ = has_decibel_ || factor.decibel;
        if (factor.decibel && divide) throw UnitError("dB stands alone, not in '" + text_ + "'");
        ++factors_;
    }

    const std::string& text_;
    std::size_t at_ = 0;
    Unit unit_;
    int factors_ = 0;
    bool has_decibel_ = false;
};

/// Where the number at the start of the text ends: digits [. digits] [e [sign] digits]. 0: there is none.
std::size_t number_length(std::string_view text) {
    std::size_t at = 0;
    if (at < text.size() && (text[at] == '+' || text[at] == '-')) ++at;
    std::size_t digits = 0;
    while (at < text.size() && is_digit(text[at])) ++at, ++digits;
    if (at < text.size() && text[at] == '.') {
        ++at;
        while (at < text.size() && is_digit(text[at])) ++at, ++digits;
    }
    if (digits == 0) return 0;
    if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
        std::size_t end = at + 1;
        if (end < text.size() && (text[end] == '+' || text[end] == '-')) ++end;
        const std::size_t first = end;
        while (end < text.size() && is_digit(text[end])) ++end;
        if (end > first) at = end;
    }
    return at;
}

/// The number times 10^decimal, rounded once: "3" with -3 is the double 0.003.
double scaled(std::string_view number, int decimal) {
    const std::size_t exponent_at = number.find_first_of("eE");
    std::string_view mantissa = number.substr(0, exponent_at);
    if (!mantissa.empty() && mantissa.front() == '+') mantissa.remove_prefix(1);
    long exponent = 0;
    if (exponent_at != std::string_view::npos) {
        std::string_view digits = number.substr(exponent_at + 1);
        if (digits.front() == '+') digits.remove_prefix(1);
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
        if (error != std::errc() || std::labs(exponent) > 100000)
            throw UnitError("'" + std::string(number) + "' is not a number that a double can hold");
    }
    const std::string text = std::string(mantissa) + "e" + std::to_string(exponent + decimal);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
        throw UnitError("'" + std::string(number) + "' is not a number that a double can hold");
    return value;
}

/// `; there are m/s, km/h, kn`: what people measure it in. "" where the SI unit is all.
std::string usual_units(const Dimension& dimension) {
    static const std::pair<Dimension, const char*> usual[] = {
        {{{0}}, "%, ppm, dB"},
        {{{1}}, "m, km, ft, nmi"},
        {{{0, 1}}, "s, ms, min, h, d"},
        {{{1, -1}}, "m/s, km/h, kn"},
        {{{0, -1}}, "Hz, kHz, 1/s"},
        {{{0, 0, 0, 1}}, "rad, mrad, deg, arcmin, arcsec"},
        {{{0, -1, 0, 1}}, "rad/s, deg/s, rpm"},
    };
    for (const auto& [candidate, names] : usual)
        if (candidate == dimension) return std::string("; there are ") + names;
    return {};
}

std::string expectation(const std::string& expected) {
    return expected.empty() ? "expected a pure number" : "expected a value in " + expected;
}

}  // namespace

Unit parse_unit(const std::string& text) {
    const std::string ascii = trimmed(to_ascii(text));
    return ascii.empty() ? Unit{} : UnitReader(ascii).read();
}

std::string dimension_name(const Dimension& dimension) {
    static const std::pair<Dimension, const char*> names[] = {
        {{{0}}, "pure number"},
        {{{1}}, "length"},
        {{{2}}, "area"},
        {{{3}}, "volume"},
        {{{0, 1}}, "time"},
        {{{1, -1}}, "speed"},
        {{{1, -2}}, "acceleration"},
        {{{1, -3}}, "jerk"},
        {{{0, -1}}, "frequency"},
        {{{0, 0, 1}}, "mass"},
        {{{0, 0, 0, 1}}, "angle"},
        {{{0, -1, 0, 1}}, "angular rate"},
        {{{0, -2, 0, 1}}, "angular acceleration"},
        {{{1, -2, 1}}, "force"},
        {{{2, -2, 1}}, "energy"},
        {{{2, -3, 1}}, "power"},
        {{{0, 0, 0, 0, 0, 1}}, "temperature"},
    };
    for (const auto& [candidate, name] : names)
        if (candidate == dimension) return name;
    return {};
}

double parse_number(const std::string& text) {
    const std::string number = trimmed(text);
    if (number.empty() || number_length(number) != number.size())
        throw UnitError("expected a number, got '" + text + "'");
    return scaled(number, 0);
}

std::int64_t parse_integer(const std::string& text) {
    const std::string number = trimmed(text);
    const std::size_t sign = !number.empty() && (number.front() == '+' || number.front() == '-') ? 1 : 0;
    if (number.size() == sign || number.find_first_not_of("0123456789", sign) != std::string::npos)
        throw UnitError("expected a whole number, got '" + text + "'");
    std::int64_t value = 0;
    const char* first = number.data() + (number.front() == '+' ? 1 : 0);
    const auto [end, error] = std::from_chars(first, number.data() + number.size(), value);
    if (error != std::errc()) throw UnitError("'" + text + "' does not fit into 64 bits");
    return value;
}

namespace {

/// Why a text that should begin with a number does not.
std::string no_number(const std::string& text) {
    const std::size_t word = text.find_first_not_of("+-.");
    const std::string letters = word == std::string::npos ? "" : text.substr(word, 3);
    for (const char* special : {"inf", "Inf", "INF", "nan", "NaN", "NAN"})
        if (letters == special) return "values are finite numbers";
    return text.empty() ? "it is empty" : "it does not begin with a number";
}

}  // namespace

double parse_quantity(const std::string& text, const std::string& expected) {
    const std::string quantity = trimmed(to_ascii(text));
    const std::size_t length = number_length(quantity);
    if (length == 0) throw UnitError(expectation(expected) + ", got '" + text + "' (" + no_number(quantity) + ")");
    const std::string number = quantity.substr(0, length);
    const std::string unit_text = trimmed(quantity.substr(length));
    if (unit_text.empty()) return scaled(number, 0);
    if (unit_text.front() == ',')
        throw UnitError(expectation(expected) + ", got '" + text + "' (decimals stand after a point, not a comma)");
    Unit unit;
    try {
        unit = parse_unit(unit_text);
    } catch (const UnknownUnit& error) {
        throw UnitError(expectation(expected) + ", got '" + text + "' (" + error.what() +
                        usual_units(parse_unit(expected).dimension) + ")");
    } catch (const UnitError& error) {
        throw UnitError(expectation(expected) + ", got '" + text + "' (" + error.what() + ")");
    }
    if (unit.dimension != parse_unit(expected).dimension) {
        const std::string name = dimension_name(unit.dimension);
        throw UnitError(expectation(expected) + ", got '" + text + "'" +
                        (name.empty() ? "" : " (" + unit_text + " is " + with_article(name) + ")"));
    }
    const double value = unit.decibel ? std::pow(10.0, scaled(number, 0) / 10.0)
                                      : scaled(number, unit.decimal) * unit.numerator / unit.denominator;
    if (!std::isfinite(value)) throw UnitError("'" + text + "' is not a number that a double can hold");
    return value;
}

std::int64_t parse_time(const std::string& text) {
    const double nanoseconds = parse_quantity(text, "s") * 1e9;
    if (std::abs(nanoseconds) > 9.2e18) throw UnitError("'" + text + "' is beyond what 64-bit nanoseconds can hold");
    return std::llround(nanoseconds);
}

}  // namespace pelorus::graph
