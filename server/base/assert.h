// EVOD_ASSERT: an assertion for the preconditions of the core. It is checked in every build, because a wrong simulation
// is worse than none.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace evod::base {

[[noreturn]] inline void assertion_failed(const char* condition, const char* file, int line) {
    std::fprintf(stderr, "%s:%d: assertion failed: %s\n", file, line, condition);
    std::abort();
}

} // namespace evod::base

#define EVOD_ASSERT(condition)                                                                                         \
    (static_cast<bool>(condition) ? void(0) : ::evod::base::assertion_failed(#condition, __FILE__, __LINE__))
