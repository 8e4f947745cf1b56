#include "time_text.hpp"

#include <charconv>
#include <cmath>
#include <cstdlib>

#include <pelorus/failure.hpp>

namespace source_csv {

namespace {

constexpr std::int64_t second = 1'000'000'000;

[[noreturn]] void refuse(std::string_view text, const std::string& expected) {
    throw pelorus::DataError("'" + std::string(text.substr(0, 80)) + "' is no time: expected " + expected);
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Reads text from the left.
class Scanner {
public:
    explicit Scanner(std::string_view text) : whole_(text), left_(text) {}

    bool done() const { return left_.empty(); }
    char peek() const { return left_.empty() ? '\0' : left_.front(); }
    bool take(char c) {
        if (peek() != c) return false;
        left_.remove_prefix(1);
        return true;
    }
    /// Exactly `count` digits.
    int digits(std::size_t count) {
        int value = 0;
        for (std::size_t i = 0; i < count; ++i, left_.remove_prefix(1)) {
            if (!is_digit(peek())) fail();
            value = value * 10 + (peek() - '0');
        }
        return value;
    }
    /// Digits behind a decimal point, as nanoseconds of a second, rounded.
    std::int64_t fraction() {
        std::int64_t value = 0, unit = second / 10;
        if (!is_digit(peek())) fail();
        for (; unit > 0 && is_digit(peek()); unit /= 10, left_.remove_prefix(1)) value += unit * (peek() - '0');
        if (is_digit(peek()) && peek() >= '5') ++value;
        while (is_digit(peek())) left_.remove_prefix(1);
        return value;
    }
    [[noreturn]] void fail() const {
        refuse(whole_, "YYYY-MM-DD hh:mm:ss[.fraction] with T or a space between and Z or an offset behind");
    }

private:
    std::string_view whole_, left_;
};

/// Days since 1970-01-01 in the proleptic Gregorian calendar.
/// Source: H. Hinnant, chrono-compatible low-level date algorithms, 2013: days_from_civil.
std::int64_t days_since_1970(int year, int month, int day) {
    const std::int64_t y = month <= 2 ? year - 1 : year;
    const std::int64_t era = y / 400;  // years here are never negative
    const std::int64_t year_of_era = y - era * 400;
    const std::int64_t day_of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
    return era * 146097 + year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year - 719468;
}

int days_in_month(int year, int month) {
    constexpr int days[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    const bool leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
    return month == 2 && leap ? 29 : days[month - 1];
}

/// Days since 1970 of YYYY-MM-DD or YYYYMMDD. `extended` answers which.
std::int64_t scan_date(Scanner& scanner, bool& extended) {
    const int year = scanner.digits(4);
    extended = scanner.take('-');
    const int month = scanner.digits(2);
    if (extended && !scanner.take('-')) scanner.fail();
    const int day = scanner.digits(2);
    if (year < 1 || month < 1 || month > 12 || day < 1 || day > days_in_month(year, month)) scanner.fail();
    return days_since_1970(year, month, day);
}

/// hh:mm[:ss[.fraction]] or hhmm[ss[.fraction]].
struct Clock {
    std::int64_t seconds = 0, nanoseconds = 0;
};
Clock scan_clock(Scanner& scanner, bool extended) {
    const int hour = scanner.digits(2);
    if (extended && !scanner.take(':')) scanner.fail();
    const int minute = scanner.digits(2);
    Clock clock;
    int seconds = 0;
    if (extended ? scanner.take(':') : is_digit(scanner.peek())) {
        seconds = scanner.digits(2);
        if (scanner.take('.') || scanner.take(',')) clock.nanoseconds = scanner.fraction();
    }
    if (hour > 24 || minute > 59 || seconds > 60 || (hour == 24 && minute + seconds > 0)) scanner.fail();
    clock.seconds = hour * 3600 + minute * 60 + seconds;
    return clock;
}

/// Z, +hh:mm, +hhmm, +hh or nothing: seconds east of Greenwich.
std::int64_t scan_offset(Scanner& scanner) {
    if (scanner.take('Z') || scanner.take('z') || scanner.done()) return 0;
    const bool west = scanner.peek() == '-';
    if (!scanner.take('+') && !scanner.take('-')) scanner.fail();
    const int hours = scanner.digits(2);
    scanner.take(':');
    const int minutes = scanner.done() ? 0 : scanner.digits(2);
    if (hours > 23 || minutes > 59) scanner.fail();
    return (west ? -1 : 1) * (hours * 3600 + minutes * 60);
}

/// seconds * 1e9 + nanoseconds, unless that is beyond int64.
std::int64_t combine(std::string_view text, std::int64_t seconds, std::int64_t nanoseconds) {
    std::int64_t time = 0;
    if (__builtin_mul_overflow(seconds, second, &time) || __builtin_add_overflow(time, nanoseconds, &time))
        refuse(text, "a time within 292 years of the zero of the count");
    return time;
}

std::int64_t parse_iso(std::string_view text) {
    Scanner scanner(text);
    bool extended = false;
    const std::int64_t days = scan_date(scanner, extended);
    Clock clock;
    std::int64_t east = 0;
    if (!scanner.done()) {
        if (!scanner.take('T') && !scanner.take('t') && !scanner.take(' ')) scanner.fail();
        clock = scan_clock(scanner, extended);
        east = scan_offset(scanner);
        if (!scanner.done()) scanner.fail();
    }
    return combine(text, days * 86400 + clock.seconds - east, clock.nanoseconds);
}

/// An exponent, or more digits than count exactly: through a double.
std::int64_t parse_inexact(std::string_view text, double unit) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) refuse(text, "a number");
    const double nanoseconds = value * unit;
    if (std::abs(nanoseconds) > 9.2e18) refuse(text, "a time within 292 years of the zero of the count");
    return std::llround(nanoseconds);
}

/// [-]digits[.digits] in units of `unit` ns, exactly.
std::int64_t parse_number(std::string_view text, std::int64_t unit) {
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    std::string_view left = text;
    const bool negative = !left.empty() && left.front() == '-';
    if (negative) left.remove_prefix(1);
    std::int64_t whole = 0;
    std::size_t digits = 0;
    while (digits < left.size() && is_digit(left[digits])) ++digits;
    const bool point = digits < left.size() && left[digits] == '.';
    const std::string_view fraction = point ? left.substr(digits + 1) : std::string_view();
    const bool plain = digits > 0 && (point || digits == left.size()) &&
                       fraction.find_first_not_of("0123456789") == std::string_view::npos;
    if (!plain) return parse_inexact(text, static_cast<double>(unit));
    const bool fits = std::from_chars(left.data(), left.data() + digits, whole).ec == std::errc();
    // The unit is a power of ten: its digits are used up after as many decimals.
    std::int64_t part = 0;
    std::int64_t share = unit;
    bool round_up = false;
    for (const char c : fraction) {
        if (share == 1) {
            round_up = c >= '5';
            break;
        }
        share /= 10;
        part += share * (c - '0');
    }
    std::int64_t time = 0;
    if (!fits || __builtin_mul_overflow(whole, unit, &time) ||
        __builtin_add_overflow(time, part + (round_up ? 1 : 0), &time))
        refuse(text, "a time within 292 years of the zero of the count");
    return negative ? -time : time;
}

}  // namespace

std::int64_t parse_time(std::string_view text, TimeFormat format) {
    switch (format) {
        case TimeFormat::seconds:
            return parse_number(text, second);
        case TimeFormat::milliseconds:
            return parse_number(text, second / 1'000);
        case TimeFormat::microseconds:
            return parse_number(text, second / 1'000'000);
        case TimeFormat::nanoseconds:
            return parse_number(text, 1);
        default:
            return parse_iso(text);
    }
}

}  // namespace source_csv
