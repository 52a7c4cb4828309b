// Numbers: formats numbers for users and reads typed ones.
//
// Owner        none: functions.
// Threads      any.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace evod::viewer {

/// Returns the text that printf would print, of any length.
[[gnu::format(printf, 1, 2)]] std::string print(const char* format, ...);

std::string with_separators(std::uint64_t number); // 1234567 → "1,234,567"
/// For a number already formatted: "-1234.5" → "−1,234.5".
std::string with_separators(std::string printed);

/// At most six digits: "1,234.5", "0.0123"; "–" if the number is not finite.
std::string shown_number(double number);
/// "1,234.5 px"; without a unit only the number.
std::string with_unit(double number, std::string_view unit);

std::string shown_tenths(double number); // 251.34 → "251.3"

/// Reads a text of digits only; nullopt for any other text and for numbers beyond 64 bits.
std::optional<std::uint64_t> whole_number(std::string_view text);

/// Reads a whole number from the text of an input field. Clears `problem` if it is allowed; otherwise returns nullopt
/// and sets `problem` to "FIELD: got "TEXT", allowed whole numbers from LEAST to MOST".
std::optional<std::uint64_t> number_in(std::string_view field, std::string_view text, std::uint64_t least,
                                       std::uint64_t most, std::string& problem);

/// The smallest of 1, 2 and 5 times a power of ten that is at least `least`; 1 if `least` is not positive.
/// nice_step(1.5 * step) is the next larger step: nice_step(1.5 * 20) is 50.
double nice_step(double least);

} // namespace evod::viewer
