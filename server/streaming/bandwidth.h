// Bandwidth: chooses the level of detail of each snapshot for a viewer, so that the viewer receives at most its chosen
// number of bytes per second.
//
// Unspent bytes accumulate for a limited time, because keyframes are large. A snapshot that costs more than the
// accumulated bytes is sent in less detail. If even the lowest detail costs too much, the snapshot is delayed. After a
// while, more detail is tried again. If no newer snapshot has arrived by then, the last snapshot is sent again in more
// detail. If the higher detail cannot be sustained, the interval until the next attempt is doubled.
//
// Owner        a subscription.
// Threads      the network thread.
#pragma once

#include "evod/v1/stream.pb.h"
#include "server/runtime/clock.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>

namespace evod::streaming {

class Bandwidth {
  public:
    using Clock = runtime::Clock;
    static constexpr double accumulated_s_max = 2;                     // bytes accumulate for at most this many seconds
    static constexpr std::chrono::seconds retry_min{2}, retry_max{64}; // range of the time until more detail is tried

    /// bytes_per_s  the limit, > 0.
    /// most         the highest level of detail that the viewer wants.
    Bandwidth(double bytes_per_s, v1::Detail most) { change(bytes_per_s, most); }

    /// Sets a new rate and a new highest level of detail, which is tried at once. Accumulated bytes are kept, up to the
    /// new maximum. If the maximum increases, the additional bytes are available at once, as for a new object.
    void change(double bytes_per_s, v1::Detail most);

    struct Choice {
        std::optional<v1::Detail> detail; // nullopt: the snapshot cannot be sent yet
        // When to call choose() again, if `detail` is nullopt; or when to call refine(), if `detail` is lower than
        // wanted.
        Clock::time_point again;
    };
    /// Chooses the level of detail of a snapshot and spends its cost.
    ///
    /// cost  returns the size of the snapshot in bytes at a given detail. The last call is for the chosen detail.
    template <class Cost>
    Choice choose(Clock::time_point now, const Cost& cost);

    /// Chooses a higher level of detail for a snapshot that was already sent. Choice::detail is nullopt if the
    /// accumulated bytes do not suffice.
    ///
    /// shown  the detail in which the snapshot was sent; it is lower than wanted.
    template <class Cost>
    Choice refine(Clock::time_point now, v1::Detail shown, const Cost& cost);

  private:
    double bytes_max() const { return accumulated_s_max * bytes_per_s_; }
    Clock::time_point when_accumulated(double bytes, Clock::time_point now) const;
    void raise_detail(v1::Detail detail, Clock::time_point now);
    void accumulate(Clock::time_point now);
    void lower_detail(Clock::time_point now);
    static v1::Detail less(v1::Detail detail) { return static_cast<v1::Detail>(detail + 1); }

    double bytes_per_s_ = 0, bytes_ = 0; // bytes_: accumulated bytes; negative after a snapshot that cost more
    v1::Detail most_ = v1::DETAIL_FULL, detail_ = v1::DETAIL_FULL;
    Clock::duration retry_after_ = retry_min;
    std::optional<Clock::time_point> updated_; // time at which bytes_ was computed
    Clock::time_point raised_, try_more_;      // time when detail_ was raised, and time when more detail is tried
};

template <class Cost>
Bandwidth::Choice Bandwidth::choose(Clock::time_point now, const Cost& cost) {
    accumulate(now);
    if (detail_ != most_ && now >= try_more_) {
        // Try the highest detail first: if little has changed, a delta in full detail may be smaller than dots.
        const auto affordable = [&](v1::Detail detail) { return static_cast<double>(cost(detail)) <= bytes_; };
        v1::Detail more = most_;
        while (more != detail_ && !affordable(more)) {
            more = less(more);
        }
        raise_detail(more, now);
    }
    for (;;) {
        const auto bytes = static_cast<double>(cost(detail_));
        // A snapshot may cost more than can ever accumulate. It is sent when the maximum has accumulated.
        const double needed = std::min(bytes, bytes_max());
        if (detail_ != v1::DETAIL_DENSITY && bytes > bytes_) {
            lower_detail(now);
            continue;
        }
        if (needed > bytes_) {
            return {std::nullopt, when_accumulated(needed, now)};
        }
        bytes_ -= bytes;
        return {detail_, detail_ == most_ ? now : try_more_};
    }
}

template <class Cost>
Bandwidth::Choice Bandwidth::refine(Clock::time_point now, v1::Detail shown, const Cost& cost) {
    accumulate(now);
    if (detail_ >= shown && now < try_more_) {
        return {std::nullopt, try_more_};
    }
    for (v1::Detail detail = most_; detail < shown; detail = less(detail)) {
        const auto bytes = static_cast<double>(cost(detail));
        if (bytes > bytes_max()) {
            continue;
        }
        if (bytes > bytes_) {
            return {std::nullopt, when_accumulated(bytes, now)};
        }
        bytes_ -= bytes;
        raise_detail(detail, now);
        return {detail, try_more_};
    }
    return {std::nullopt, Clock::time_point::max()};
}

} // namespace evod::streaming
