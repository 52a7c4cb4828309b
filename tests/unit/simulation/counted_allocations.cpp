#include "tests/unit/simulation/counted_allocations.h"

#include <cstdlib>
#include <new>

namespace evod::tests {

std::size_t allocations = 0, allocations_until_failure = 0;

} // namespace evod::tests

namespace {

void count() {
    ++evod::tests::allocations;
    if (evod::tests::allocations_until_failure > 0 && --evod::tests::allocations_until_failure == 0) {
        throw std::bad_alloc{};
    }
}

} // namespace

// g++ does not detect that both functions of a pair are replaced.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"

void* operator new(std::size_t size) {
    count();
    if (void* memory = std::malloc(size > 0 ? size : 1)) {
        return memory;
    }
    throw std::bad_alloc{};
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    count();
    const auto align = static_cast<std::size_t>(alignment);
    if (void* memory = std::aligned_alloc(align, (size + align - 1) / align * align)) {
        return memory;
    }
    throw std::bad_alloc{};
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}
