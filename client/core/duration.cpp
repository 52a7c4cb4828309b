#include "client/core/duration.h"

#include <array>
#include <cstdint>
#include <cstdio>

namespace evod::core {

namespace {

std::string with_tenths(double seconds) {
    std::array<char, 400> digits;
    const int length = std::snprintf(digits.data(), digits.size(), "%.1f", seconds);
    return {digits.data(), static_cast<std::size_t>(length)};
}

} // namespace

std::string duration(double seconds) {
    if (!(seconds >= 60 && seconds < 1e15)) {
        return with_tenths(seconds) + " s";
    }
    const auto whole = static_cast<std::uint64_t>(seconds + 0.5);
    const auto two_digits = [](std::uint64_t value) {
        return std::string(value < 10 ? "0" : "") + std::to_string(value);
    };
    if (whole < 3600) {
        return std::to_string(whole / 60) + ":" + two_digits(whole % 60) + " min";
    }
    return std::to_string(whole / 3600) + ":" + two_digits(whole / 60 % 60) + ":" + two_digits(whole % 60) + " h";
}

} // namespace evod::core
