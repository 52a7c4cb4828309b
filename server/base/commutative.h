// Commutative writes to memory that several pieces of a parallel loop share. The final value does not depend on the
// order of the writes. The returned values depend on it, so no result may use them.
//
// `parallel` is true if several threads may write at the same time. If it is false, the plain operation is used, which
// is several times faster.
#pragma once

#include <algorithm>
#include <atomic>
#include <utility>

namespace evod::base {

/// Adds `change` to `value`. Returns the value before the addition.
template <bool parallel, class T>
T fetch_add(T& value, T change) {
    if constexpr (parallel) {
        return std::atomic_ref{value}.fetch_add(change, std::memory_order_relaxed);
    } else {
        return std::exchange(value, value + change);
    }
}

/// Sets `value` to min(value, candidate). Neither may be NaN.
template <bool parallel, class T>
void fetch_min(T& value, T candidate) {
    if constexpr (parallel) {
        std::atomic_ref shared{value};
        T now = shared.load(std::memory_order_relaxed);
        while (candidate < now && !shared.compare_exchange_weak(now, candidate, std::memory_order_relaxed)) {
        }
    } else {
        value = std::min(value, candidate);
    }
}

/// Sets `value` to `what`. Threads that write at the same time must all write the same value.
template <bool parallel, class T>
void put(T& value, T what) {
    if constexpr (parallel) {
        std::atomic_ref{value}.store(what, std::memory_order_relaxed);
    } else {
        value = what;
    }
}

/// Reads a value that other threads may write at the same time.
template <class T>
T load_shared(T& value) {
    return std::atomic_ref{value}.load(std::memory_order_relaxed);
}

} // namespace evod::base
