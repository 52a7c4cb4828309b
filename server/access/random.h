// Random: random bits for secrets, from the cryptographic generator of OpenSSL, which the operating system seeds.
//
// Threads      any; no state of its own.
#pragma once

#include <cstdint>

namespace evod::access {

std::uint64_t draw_random();

} // namespace evod::access
