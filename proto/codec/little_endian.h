// Writes and reads little-endian numbers, whatever the byte order of the machine.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstring>

namespace evod::codec {

template <std::unsigned_integral Number>
constexpr Number in_little_endian_order(Number value) {
    if constexpr (std::endian::native == std::endian::little || sizeof(Number) == 1) {
        return value;
    } else {
        Number swapped = 0;
        for (std::size_t byte = 0; byte < sizeof(Number); ++byte) {
            swapped = static_cast<Number>((swapped << 8) | ((value >> (8 * byte)) & 0xff));
        }
        return swapped;
    }
}

/// Writes sizeof(Number) bytes at `to`, which need not be aligned.
template <std::unsigned_integral Number>
void store(Number value, void* to) {
    const Number ordered = in_little_endian_order(value);
    std::memcpy(to, &ordered, sizeof ordered);
}

/// Reads sizeof(Number) bytes at `from`, which need not be aligned.
template <std::unsigned_integral Number>
Number load(const void* from) {
    Number value;
    std::memcpy(&value, from, sizeof value);
    return in_little_endian_order(value);
}

} // namespace evod::codec
