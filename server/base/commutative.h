// Commutative operations on memory that several pieces of a parallel loop write to: whichever comes first, the outcome
// is the same. What they return is not, so no result may depend on it.
//
// `side_by_side` tells whether others may write at the same time; where not, the plain operation is several times
// faster.
#pragma once

#include <algorithm>
#include <atomic>
#include <utility>

namespace evod::base {

/// value += change; returns what it was before.
template <bool side_by_side, class T>
T fetch_add(T& value, T change) {
    if constexpr (side_by_side) {
        return std::atomic_ref{value}.fetch_add(change, std::memory_order_relaxed);
    } else {
        return std::exchange(value, value + change);
    }
}

/// value = min(value, candidate). Numbers only, no NaN.
template <bool side_by_side, class T>
void fetch_min(T& value, T candidate) {
    if constexpr (side_by_side) {
        std::atomic_ref shared{value};
        T now = shared.load(std::memory_order_relaxed);
        while (candidate < now && !shared.compare_exchange_weak(now, candidate, std::memory_order_relaxed)) {
        }
    } else {
        value = std::min(value, candidate);
    }
}

/// value = what; all who write at the same time write the same.
template <bool side_by_side, class T>
void put(T& value, T what) {
    if constexpr (side_by_side) {
        std::atomic_ref{value}.store(what, std::memory_order_relaxed);
    } else {
        value = what;
    }
}

/// What is there while others may write.
template <class T>
T look_at(T& value) {
    return std::atomic_ref{value}.load(std::memory_order_relaxed);
}

} // namespace evod::base
