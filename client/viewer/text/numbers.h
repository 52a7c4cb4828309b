// Numbers: as people read and choose them.
//
// Threads      none.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace evod::viewer {

/// What printf would print, however long it is.
[[gnu::format(printf, 1, 2)]] std::string print(const char* format, ...);

std::string with_separators(std::uint64_t number); // 1234567 → "1,234,567"
/// Of a number that is printed already: "-1234.5" → "−1,234.5".
std::string with_separators(std::string printed);

/// Six digits and no more: "1,234.5", "0.0123"; "–" of what is not finite.
std::string shown_number(double number);
/// "1,234.5 px"; of no unit the number.
std::string with_unit(double number, std::string_view unit);

std::string shown_tenths(double number); // 251.34 → "251.3"

/// Digits and nothing else; nullopt also of what is more than 64 bits hold.
std::optional<std::uint64_t> whole_number(std::string_view text);

/// The least of 1, 2 and 5 times a power of ten that is not less than `least`; 1 of nothing. A little more than it
/// gives the next one: nice_step(1.5 * 20) is 50.
double nice_step(double least);

} // namespace evod::viewer
