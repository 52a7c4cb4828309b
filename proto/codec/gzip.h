// Gzip: a file that browsers load compressed, and other clients as it is.
//
// Threads      any; no state.
// Source       RFC 1952.
#pragma once

#include <string>
#include <string_view>

namespace evod::codec {

/// Compresses bytes to one gzip member, as small as libdeflate can. Takes about 10 ms for 30 kB.
std::string gzip(std::string_view bytes);

/// The bytes of one gzip member that this program contains or made. Throws std::runtime_error for any others.
std::string gunzip(std::string_view compressed);

} // namespace evod::codec
