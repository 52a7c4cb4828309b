// Gzip: compresses a file that browsers load.
//
// Threads      any; no state.
// Source       RFC 1952.
#pragma once

#include <string>
#include <string_view>

namespace evod::codec {

/// Compresses bytes to one gzip member, as small as libdeflate can. Takes about 10 ms for 30 kB.
std::string gzip(std::string_view bytes);

} // namespace evod::codec
