// Column: one number of many entities.
#pragma once

#include <cstdint>
#include <memory>
#include <new>
#include <span>
#include <utility>
#include <vector>

namespace evod::codec {

/// Leaves numbers without a value where std::allocator would set them to 0.
template <class T>
struct WithoutValue : std::allocator<T> {
    template <class U>
    struct rebind {
        using other = WithoutValue<U>;
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

/// With or without a sign; arithmetic is modulo 2^32. What Column(count) and resize() add has no value until it is
/// written: of a picture nearly all is, at once.
using Column = std::vector<std::uint32_t, WithoutValue<std::uint32_t>>;
using Numbers = std::span<const std::uint32_t>;

} // namespace evod::codec
