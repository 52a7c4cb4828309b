// Exact numbers: whole numbers that a double represents exactly. R, NumPy, JavaScript and spreadsheet programs read
// numbers as doubles, so only these numbers survive them.
//
// Threads      any; no state.
#pragma once

#include "server/base/parameter.h"
#include "server/base/random.h"

#include <cmath>
#include <cstdint>
#include <optional>

namespace evod::base {

/// Every whole number below this one is exact as a double, and so are its neighbours.
constexpr std::uint64_t exact_number_end = std::uint64_t{1} << 53;

/// Makes a seed below 2^53 from 64 random bits. evod draws and derives only such seeds; a user may choose any seed.
constexpr Seed portable_seed(std::uint64_t word) {
    return {word % exact_number_end};
}

/// Returns whether programs that read numbers as doubles can read the seed.
constexpr bool is_portable(Seed seed) {
    return seed.value < exact_number_end;
}

/// Returns the number as a count; nullopt if it is not a whole number in the range of counts, or if it is −0.
inline std::optional<std::uint32_t> whole_number_of(double value) {
    const bool whole = value >= 0 && value <= count_max && value == std::floor(value) && !std::signbit(value);
    return whole ? std::optional{static_cast<std::uint32_t>(value)} : std::nullopt;
}

} // namespace evod::base
