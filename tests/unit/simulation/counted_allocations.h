// Counted allocations: replaces operators new and delete in a test program that has one thread.
#pragma once

#include <cstddef>

namespace evod::tests {

extern std::size_t allocations;               // so far
extern std::size_t allocations_until_failure; // the allocation with this number throws std::bad_alloc; 0: none does

} // namespace evod::tests
