// Sizes of tests that run small every day and large in scripts/test --long.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>

namespace evod {

/// The value of an environment variable, or the everyday size where it is not set.
inline std::uint64_t everyday_size(const char* variable, std::uint64_t everyday) {
    const char* long_size = std::getenv(variable);
    return long_size == nullptr ? everyday : std::stoull(long_size);
}

} // namespace evod
