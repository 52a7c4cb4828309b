#include "server/base/column.h"

#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace evod::base {
namespace {

constexpr std::size_t large_page = 2 << 20;

std::align_val_t alignment(std::size_t bytes) {
    constexpr std::size_t cache_line = 64;
    return std::align_val_t{bytes >= 2 * large_page ? large_page : cache_line};
}

} // namespace

void* allocate_column(std::size_t bytes) {
    void* memory = ::operator new(bytes, alignment(bytes));
#if defined(__linux__)
    if (bytes >= 2 * large_page) {
        madvise(memory, bytes / large_page * large_page,
                MADV_HUGEPAGE); // only a hint: the program also works without large pages
    }
#endif
    return memory;
}

void free_column(void* memory, std::size_t bytes) noexcept {
    ::operator delete(memory, alignment(bytes));
}

} // namespace evod::base
