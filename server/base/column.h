// Column: one field of many entities, as a vector whose memory suits loops over all of them.
//
// It begins at a cache line, so that a load of several fields never spans two; and a large one asks for large pages, of
// which the processor remembers more at once: a tick of a million organisms takes some 6 % less time for both.
#pragma once

#include <cstddef>
#include <vector>

namespace evod::base {

void* allocate_column(std::size_t bytes);
void free_column(void* memory, std::size_t bytes) noexcept;

template <class T>
struct ColumnAllocator {
    using value_type = T;

    ColumnAllocator() = default;
    template <class U>
    ColumnAllocator(const ColumnAllocator<U>&) {}

    T* allocate(std::size_t count) { return static_cast<T*>(allocate_column(count * sizeof(T))); }
    void deallocate(T* memory, std::size_t count) noexcept { free_column(memory, count * sizeof(T)); }
    friend bool operator==(const ColumnAllocator&, const ColumnAllocator&) { return true; }
};

template <class T>
using Column = std::vector<T, ColumnAllocator<T>>;

} // namespace evod::base
