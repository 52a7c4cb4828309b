#include "client/core/exact.h"

#include <array>
#include <charconv>
#include <cmath>

namespace evod::core {

std::string exact(double value) {
    std::array<char, 64> digits;
    const double size = std::abs(value);
    const bool plain = value == 0 || (size >= 1e-5 && size < 1e15);
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                   plain ? std::chars_format::fixed : std::chars_format::scientific)
                         .ptr;
    return {digits.data(), end};
}

} // namespace evod::core
