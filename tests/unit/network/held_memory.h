// Held memory: replaces operators new and delete in a test program, and counts the memory that is allocated.
//
// Threads      any; the number is atomic.
#pragma once

#include <cstddef>

namespace evod::tests {

/// Memory that is allocated now, with the headers of the allocator.
std::size_t held_memory();

} // namespace evod::tests
