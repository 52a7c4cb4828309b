#include "tests/unit/network/held_memory.h"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> held = 0;
constexpr std::size_t header_bytes = sizeof(std::size_t);

void* counted(void* memory) {
    if (memory == nullptr) {
        throw std::bad_alloc{};
    }
    held += malloc_usable_size(memory) + header_bytes;
    return memory;
}

void release(void* memory) {
    if (memory != nullptr) {
        held -= malloc_usable_size(memory) + header_bytes;
        std::free(memory);
    }
}

} // namespace

namespace evod::tests {

std::size_t held_memory() {
    return held;
}

} // namespace evod::tests

// g++ does not detect that both functions of a pair are replaced.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"

void* operator new(std::size_t size) {
    return counted(std::malloc(size > 0 ? size : 1));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    const auto align = static_cast<std::size_t>(alignment);
    return counted(std::aligned_alloc(align, (size + align - 1) / align * align));
}
void operator delete(void* memory) noexcept {
    release(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    release(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    release(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    release(memory);
}
