#include "server/base/instructions.h"

#include "server/base/assert.h"

namespace evod::base {
namespace {

Instructions& in_use() {
    static Instructions value = widest_instructions();
    return value;
}

} // namespace

Instructions widest_instructions() {
#if defined(__x86_64__)
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx2")) {
        return Instructions::Avx2;
    }
#endif
    return Instructions::Baseline;
}

Instructions instructions() {
    return in_use();
}

void use_instructions(Instructions instructions) {
    EVOD_ASSERT(instructions <= widest_instructions());
    in_use() = instructions;
}

} // namespace evod::base
