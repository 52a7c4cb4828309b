// Printable: which characters of a text from a peer or a file must not reach a terminal or a log, and which bytes are
// UTF-8. Standard library only, because every folder may include this one.
//
// Threads      any; no state.
#pragma once

#include <cstddef>
#include <string_view>

namespace evod::text {

/// If the first character of `utf8` controls a terminal, ends a line or changes the direction of text, returns its
/// length in bytes; otherwise 0.
inline std::size_t unsafe_character_bytes(std::string_view utf8) {
    const auto byte = [&](std::size_t at) { return at < utf8.size() ? static_cast<unsigned char>(utf8[at]) : 0; };
    const auto is = [](int value, int least, int most) { return value >= least && value <= most; };
    if (utf8.empty()) {
        return 0;
    }
    if (byte(0) < 0x20 || byte(0) == 0x7f) {
        return 1;
    }
    if ((byte(0) == 0xc2 && is(byte(1), 0x80, 0x9f)) || (byte(0) == 0xd8 && byte(1) == 0x9c)) { // U+0080 to 9F, U+061C
        return 2;
    }
    const bool e280 = byte(0) == 0xe2 && byte(1) == 0x80, e281 = byte(0) == 0xe2 && byte(1) == 0x81;
    if ((e280 && (is(byte(2), 0x8e, 0x8f) || is(byte(2), 0xa8, 0xae))) || // U+200E, U+200F, U+2028 to 202E
        (e281 && is(byte(2), 0xa6, 0xa9))) {                              // U+2066 to 2069
        return 3;
    }
    return 0;
}

/// Returns the length in bytes of the character at the start of `utf8`: 1 to 4; 0 if it is empty or not valid UTF-8.
inline std::size_t character_bytes(std::string_view utf8) {
    if (utf8.empty()) {
        return 0;
    }
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(utf8[i]); };
    const std::size_t count = byte(0) < 0x80    ? 1
                              : byte(0) < 0xc2  ? 0
                              : byte(0) < 0xe0  ? 2
                              : byte(0) < 0xf0  ? 3
                              : byte(0) <= 0xf4 ? 4
                                                : 0;
    if (count > utf8.size()) {
        return 0;
    }
    for (std::size_t i = 1; i < count; ++i) {
        if ((byte(i) & 0xc0) != 0x80) {
            return 0;
        }
    }
    // Overlong encodings, UTF-16 surrogates, and code points above U+10FFFF are invalid: RFC 3629 section 4.
    if ((byte(0) == 0xe0 && byte(1) < 0xa0) || (byte(0) == 0xed && byte(1) > 0x9f) ||
        (byte(0) == 0xf0 && byte(1) < 0x90) || (byte(0) == 0xf4 && byte(1) > 0x8f)) {
        return 0;
    }
    return count;
}

} // namespace evod::text
