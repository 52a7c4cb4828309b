// QR code: makes the modules of a QR code from a text, with libqrencode.
//
// Threads      any; no state.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace evod::classes {

struct QrModules {
    std::uint32_t size = 0; // modules per side, without the quiet zone
    std::string modules;    // size * size bytes, row by row: 1 is dark
};

constexpr std::size_t qr_text_bytes_max = 300;

/// Returns the smallest QR code of a text with error correction level M, which repairs 15 % of the modules: for paper
/// and projectors. Returns nullopt if there is no memory.
///
/// text  1 to qr_text_bytes_max bytes
std::optional<QrModules> qr_code_of(const std::string& text);

} // namespace evod::classes
