#include "proto/command_line/number.h"

#include "proto/text/number_text.h"

#include <charconv>

namespace evod::command_line {
namespace {

using text::Exponent;
using text::number_text;

template <class Number>
bool read(const std::string& word, Number& number) {
    const char* const end = word.data() + word.size();
    const auto [read_until, error] = std::from_chars(word.data(), end, number);
    return error == std::errc{} && read_until == end;
}

} // namespace

std::string WholeNumber::operator()(const std::string& word) const {
    std::uint64_t number = 0;
    const bool has_leading_zero = word.size() > 1 && word.front() == '0';
    return read(word, number) && !has_leading_zero && number >= min && number <= max
               ? std::string{}
               : "got " + word + ", allowed a whole number, " + std::to_string(min) + " to " + std::to_string(max);
}

std::string RealNumber::operator()(const std::string& word) const {
    double number = 0;
    return read(word, number) && number >= min && number <= max
               ? std::string{}
               : "got " + word + ", allowed " + number_text(min, Exponent::Never) + " to " +
                     number_text(max, Exponent::Never);
}

} // namespace evod::command_line
