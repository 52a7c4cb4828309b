// Numbers as text: the messages, errors, tables and files of the server and of its clients. Standard library only,
// because every folder may include this one, below the purity line too.
//
// Threads      any; no state.
// Determinism  independent of the locale.
#pragma once

#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

namespace evod::text {

/// States when the text of a number has an exponent.
enum class Exponent {
    IfShorter, // "1e+05" and "1e-04", but "10000"
    IfLong,    // below 1e-5 and from 1e15
    Never,
};

/// Writes a number with the arguments of std::to_chars that follow the value.
inline std::string formatted_number(double value, auto... format) {
    char digits[400]; // the longest double without an exponent has 327 characters
    return {digits, std::to_chars(digits, digits + sizeof digits, value, format...).ptr};
}

/// Returns the shortest text that parses back to the same number: "0.1", "-2.5", "nan".
inline std::string number_text(double value, Exponent exponent = Exponent::IfShorter) {
    if (exponent == Exponent::IfShorter) {
        return formatted_number(value);
    }
    const double size = std::abs(value);
    const bool plain = exponent == Exponent::Never || value == 0 || (size >= 1e-5 && size < 1e15);
    return formatted_number(value, plain ? std::chars_format::fixed : std::chars_format::scientific);
}

/// Formats a number with at most `digits` significant digits, without trailing zeros, like %g of printf.
inline std::string rounded(double value, int digits) {
    return formatted_number(value, std::chars_format::general, digits);
}

/// Formats a number with `decimals` decimals, at most 80: fixed(2.345, 1) is "2.3".
inline std::string fixed(double value, int decimals) {
    return formatted_number(value, std::chars_format::fixed, decimals);
}

/// Returns a fitness as all programs print it: with one decimal from 10 on, and below with four significant digits, but
/// at least one decimal. From 1e7 on it has four significant digits and an exponent. Ties are rounded to even, and zero
/// has no sign. proto/vectors/fitness.json has examples; the page and evoview add separators and a typographic minus.
inline std::string fitness_text(double value) {
    value += 0.0; // no minus sign for 0
    const double size = std::abs(value);
    std::string text = value == 0 || (size >= 10 && size < 1e7) ? fixed(value, 1) : rounded(value, 4);
    return text.find_first_of(".en") == std::string::npos ? text + ".0" : text; // not "1e+07", "inf" and "nan"
}

/// "12,345".
inline std::string with_separators(std::uint64_t number) {
    std::string text = std::to_string(number);
    for (std::size_t end = text.size(); end > 3; end -= 3) {
        text.insert(end - 3, 1, ',');
    }
    return text;
}

} // namespace evod::text
