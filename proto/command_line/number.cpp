#include "proto/command_line/number.h"

#include <charconv>

namespace evod::command_line {
namespace {

template <class Number>
bool read(const std::string& word, Number& number) {
    const char* const end = word.data() + word.size();
    const auto [read_until, error] = std::from_chars(word.data(), end, number);
    return error == std::errc{} && read_until == end;
}

/// The shortest text, without an exponent, that reads back as the same number.
std::string text_of(double number) {
    char digits[400]; // DBL_MAX has 309 digits
    return {digits, std::to_chars(digits, digits + sizeof digits, number, std::chars_format::fixed).ptr};
}

} // namespace

std::string WholeNumber::operator()(const std::string& word) const {
    std::uint64_t number = 0;
    const bool has_leading_zero = word.size() > 1 && word.front() == '0';
    return read(word, number) && !has_leading_zero && number >= min && number <= max
               ? std::string{}
               : "must be a whole number, " + std::to_string(min) + " to " + std::to_string(max) + ", not " + word;
}

std::string RealNumber::operator()(const std::string& word) const {
    double number = 0;
    return read(word, number) && number >= min && number <= max
               ? std::string{}
               : "must be a number, " + text_of(min) + " to " + text_of(max) + ", not " + word;
}

} // namespace evod::command_line
