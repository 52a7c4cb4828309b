// Waiting in tests: for a condition, never for a fixed time.
//
// A machine that is busy with other work is slow, and may stand still for seconds. A test must not fail for that, so a
// wait is bounded by time in which the waiting thread itself ran: between two looks at the condition at most `look_max`
// counts, however long the thread was kept from running. ctest's TIMEOUT bounds everything.
#pragma once

#include <algorithm>
#include <chrono>
#include <future>
#include <thread>

namespace evod {

constexpr std::chrono::milliseconds look_max{50};
constexpr std::chrono::seconds counted_max{60}; // of time that counts, until a wait is given up
constexpr std::chrono::minutes hang{10};        // a timeout for calls that end by themselves, unless something hangs

inline void take_a_nap() {
    std::this_thread::sleep_for(std::chrono::microseconds{500});
}

/// Takes steps until the condition holds; false if it does not.
///
/// step  what makes it hold; by default nothing but a short sleep
template <class Condition, class Step = void (*)()>
bool wait_until(Condition condition, Step step = take_a_nap) {
    using Clock = std::chrono::steady_clock;
    Clock::duration counted{0};
    for (auto looked = Clock::now(); !condition();) {
        if (counted > counted_max) {
            return false;
        }
        step();
        const auto now = Clock::now();
        counted += std::min<Clock::duration>(now - looked, look_max);
        looked = now;
    }
    return true;
}

/// Waits until a promise is kept; false if it is not.
template <class Value>
bool wait_until_ready(const std::future<Value>& future) {
    return wait_until([&] { return future.wait_for(std::chrono::seconds{0}) == std::future_status::ready; });
}

} // namespace evod
