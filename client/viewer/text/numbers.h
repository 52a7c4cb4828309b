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

/// Formats like printf and returns the text, which may have any length.
[[gnu::format(printf, 1, 2)]] std::string print(const char* format, ...);

std::string with_separators(std::uint64_t number); // 1234567 → "1,234,567"
/// Adds separators to a number that is already text: "-1234.5" → "−1,234.5".
std::string with_separators(std::string printed);

/// Returns the number with at most six digits: "1,234.5", "0.0123"; "–" if it is not finite.
std::string shown_number(double number);

/// Returns the number with three significant digits: "1.21", "0.0123"; 1,000 and more as a whole number: "12,346"; "–"
/// if it is not finite.
std::string three_digits(double number);

std::string shown_fitness(double fitness); // by the rule of text::fitness_text, with separators: −1234.56 → "−1,234.6"
std::string shown_tenths(double number); // 251.34 → "251.3"

/// Parses a text that consists of digits only. Returns nullopt for any other text and for numbers that need more than
/// 64 bits.
std::optional<std::uint64_t> whole_number(std::string_view text);

/// Parses a whole number from the text of an input field. If the number is allowed, clears `problem`. Otherwise returns
/// nullopt and sets `problem` to "FIELD: got "TEXT", allowed whole numbers from LEAST to MOST".
std::optional<std::uint64_t> number_in(std::string_view field, std::string_view text, std::uint64_t least,
                                       std::uint64_t most, std::string& problem);

/// Returns the smallest number >= `least` that is 1, 2 or 5 times a power of ten; 1 if `least` is not positive.
/// nice_step(1.5 * step) is the next larger step: nice_step(1.5 * 20) is 50.
double nice_step(double least);

} // namespace evod::viewer
