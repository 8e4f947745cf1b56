/// Times as recordings spell them, to nanoseconds.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace source_csv {

enum class TimeFormat { iso8601, seconds, milliseconds, microseconds, nanoseconds };

/// Nanoseconds since 1970 (iso8601, UTC unless an offset is given) or since whatever the numbers count from. Decimal digits
/// are taken exactly; what is finer than a nanosecond is rounded to the nearest.
///
///     iso8601    2016-01-12 13:02:11.218, 2016-01-12T13:02:11Z, 2016-01-12T14:02+01:00, 20160112T130211Z, 2016-01-12
///     others     12.109, -3, 1.5e3
///
/// Throws DataError: `'13:02' is no time: expected YYYY-MM-DD hh:mm:ss` and the like. A leap second (60) reads as the
/// second that follows it.
std::int64_t parse_time(std::string_view text, TimeFormat format);

}  // namespace source_csv
