// Counted allocations: operators new and delete of a test program, which has one thread.
#pragma once

#include <cstddef>

namespace evod::tests {

extern std::size_t allocations;               // so far
extern std::size_t allocations_until_failure; // the last of so many throws std::bad_alloc; 0: none does

} // namespace evod::tests
