// Column: an array with one number for each of many entities.
#pragma once

#include <cstdint>
#include <memory>
#include <new>
#include <span>
#include <utility>
#include <vector>

namespace evod::codec {

/// An allocator that leaves numbers uninitialised, where std::allocator would set them to 0.
template <class T>
struct Uninitialised : std::allocator<T> {
    template <class U>
    struct rebind {
        using other = Uninitialised<U>;
    };
    template <class U>
    void construct(U* at) noexcept {
        ::new (static_cast<void*>(at)) U;
    }
    template <class U, class... Arguments>
    void construct(U* at, Arguments&&... arguments) {
        ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
    }
};

/// Signed or unsigned numbers. Arithmetic is modulo 2^32. Column(count) and resize() leave new numbers uninitialised,
/// because the codecs overwrite nearly all of them immediately.
using Column = std::vector<std::uint32_t, Uninitialised<std::uint32_t>>;
using Numbers = std::span<const std::uint32_t>;

} // namespace evod::codec
