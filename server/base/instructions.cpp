#include "server/base/instructions.h"

#include "server/base/assert.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace evod::base {
namespace {

constexpr std::array<std::string_view, 3> names = {"baseline", "avx2", "avx512"};

Instructions& in_use() {
    static Instructions value = default_instructions();
    return value;
}

} // namespace

std::string_view name_of(Instructions instructions) {
    return names[static_cast<std::size_t>(instructions)];
}

Instructions widest_instructions() {
#if defined(__x86_64__)
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
        return Instructions::Avx512;
    }
    if (__builtin_cpu_supports("avx2")) {
        return Instructions::Avx2;
    }
#endif
    return Instructions::Baseline;
}

Instructions default_instructions() {
#if defined(__x86_64__)
    // Intel processors before Ice Lake reduce their clock for 512-bit vectors; they have no VBMI2.
    if (widest_instructions() == Instructions::Avx512 && !__builtin_cpu_supports("avx512vbmi2")) {
        return Instructions::Avx2;
    }
#endif
    return widest_instructions();
}

std::span<const std::string_view> available_instructions() {
    return std::span{names}.first(static_cast<std::size_t>(widest_instructions()) + 1);
}

Instructions instructions() {
    return in_use();
}

void use_instructions(Instructions instructions) {
    EVOD_ASSERT(instructions <= widest_instructions());
    in_use() = instructions;
}

bool use_instructions(std::string_view name) {
    const auto available = available_instructions();
    const auto found = std::ranges::find(available, name);
    if (found == available.end()) {
        return false;
    }
    use_instructions(static_cast<Instructions>(found - available.begin()));
    return true;
}

} // namespace evod::base
