// Numbers: checks for options that are numbers. The message gives what is allowed and what was typed.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

namespace evod::command_line {

/// Decimal digits without a sign. Rejects a leading zero, which means nothing to people and an octal number to CLI11,
/// and "-1", which CLI11 reads as the greatest number of 64 bits.
struct WholeNumber {
    std::uint64_t min = 0, max = std::numeric_limits<std::uint64_t>::max();

    std::string operator()(const std::string& word) const;
};

/// Rejects "nan", which CLI11 accepts for a number in any range.
struct RealNumber {
    double min, max;

    std::string operator()(const std::string& word) const;
};

} // namespace evod::command_line
