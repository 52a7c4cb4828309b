#include "server/base/state_hash.h"

#include <cstddef>
#include <string>

namespace evod::base {

std::string to_text(const StateHash& hash) {
    // printf is not used: it took 1.5 % of the time to encode a snapshot of 10,000 organisms.
    constexpr std::size_t digits = 16; // digits of one 64-bit half
    std::string text(2 * digits, '0');
    for (std::size_t i = 0; i < digits; ++i) {
        text[digits - 1 - i] = "0123456789abcdef"[hash.high >> (4 * i) & 15];
        text[2 * digits - 1 - i] = "0123456789abcdef"[hash.low >> (4 * i) & 15];
    }
    return text;
}

std::string to_bytes(const StateHash& hash) {
    std::string bytes(16, '\0');
    for (std::size_t i = 0; i < 8; ++i) {
        bytes[7 - i] = static_cast<char>(hash.high >> (8 * i) & 0xff);
        bytes[15 - i] = static_cast<char>(hash.low >> (8 * i) & 0xff);
    }
    return bytes;
}

} // namespace evod::base
