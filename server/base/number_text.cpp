#include "server/base/number_text.h"

#include <charconv>

namespace evod::base {

std::string number_text(double value) {
    char digits[32]; // the longest double has 24 characters
    const auto end = std::to_chars(digits, digits + sizeof digits, value);
    return {digits, end.ptr};
}

} // namespace evod::base
