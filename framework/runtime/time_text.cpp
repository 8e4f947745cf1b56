#include "runtime/time_text.hpp"

#include <fmt/format.h>

namespace pelorus::runtime {

std::string seconds_text(std::int64_t nanoseconds) {
    const bool negative = nanoseconds < 0;
    const auto bits = static_cast<std::uint64_t>(nanoseconds);
    const std::uint64_t magnitude = negative ? ~bits + 1 : bits;
    constexpr std::uint64_t second = 1'000'000'000;
    std::string text = fmt::format("{}{}.{:09}", negative ? "-" : "", magnitude / second, magnitude % second);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text + " s";
}

}  // namespace pelorus::runtime
