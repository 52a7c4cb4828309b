// Numbers: checks for numeric options. An error message contains the allowed values and the typed text.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

namespace evod::command_line {

/// Checks a whole number from `min` to `max`. Accepts decimal digits without a sign. Rejects a leading zero, because
/// CLI11 would parse an octal number. Rejects "-1", because CLI11 would parse it as the largest 64-bit number.
struct WholeNumber {
    std::uint64_t min = 0, max = std::numeric_limits<std::uint64_t>::max();

    std::string operator()(const std::string& word) const;
};

/// Checks a number from `min` to `max`. Rejects "nan", which CLI11 accepts in any range.
struct RealNumber {
    double min, max;

    std::string operator()(const std::string& word) const;
};

} // namespace evod::command_line
