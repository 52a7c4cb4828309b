// Whole number: a check for CLI11 of options of both ends that are whole numbers: an empty text, or what was given and
// what is allowed; CLI11 names the option. Its own takes "-1" for the greatest number of 64 bits, and "010" for eight.
#pragma once

#include <charconv>
#include <cstdint>
#include <limits>
#include <string>

namespace evod::wire {

/// Decimal digits; a zero in front means nothing to people, and eight times as much to C.
struct WholeNumber {
    std::uint64_t min = 0, max = std::numeric_limits<std::uint64_t>::max();

    std::string operator()(const std::string& word) const {
        std::uint64_t number = 0;
        const char* const end = word.data() + word.size();
        const auto read = std::from_chars(word.data(), end, number);
        const bool digits = read.ec == std::errc{} && read.ptr == end && (word.size() == 1 || word.front() != '0');
        return digits && number >= min && number <= max
                   ? std::string{}
                   : "must be a whole number, " + std::to_string(min) + " to " + std::to_string(max) + ", not " + word;
    }
};

} // namespace evod::wire
