// Waiting, in tests, for what comes sooner or later: for a condition and never for a while.
#pragma once

#include <chrono>
#include <thread>

namespace evod {

inline void take_a_nap() {
    std::this_thread::sleep_for(std::chrono::milliseconds{2});
}

/// Takes steps until the condition holds; false if it does not within many seconds.
///
/// step  what makes it hold; by default nothing but a short sleep
template <class Condition, class Step = void (*)()>
bool wait_until(Condition condition, Step step = take_a_nap) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds{20};
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) {
            return false;
        }
        step();
    }
    return true;
}

} // namespace evod
