// Bandwidth: the detail in which a viewer is sent each snapshot, so that it gets at most the bytes per second it wants.
//
// Unspent bytes accumulate for a while, because keyframes are long. When a snapshot costs more than has accumulated, it
// is sent in less detail; if even the least detail costs too much, it is delayed. More detail is tried again after a
// while, of the same snapshot if no newer one has arrived. If more detail cannot be sustained, the next attempt comes
// later.
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
    static constexpr double accumulated_s_max = 2;                     // bytes of so many seconds accumulate at most
    static constexpr std::chrono::seconds retry_min{2}, retry_max{64}; // until more detail is tried

    /// bytes_per_s  > 0.
    /// most         the wanted detail.
    Bandwidth(double bytes_per_s, v1::Detail most) { change(bytes_per_s, most); }

    /// Sets another rate and detail, which is tried at once. Accumulated bytes stay, up to the new maximum. A higher
    /// maximum is filled at once, as at the beginning.
    void change(double bytes_per_s, v1::Detail most);

    struct Choice {
        std::optional<v1::Detail> detail; // nullopt: the snapshot cannot be sent yet
        Clock::time_point again;          // when to call again; after less detail than wanted, when to call refine()
    };
    /// Chooses the detail of a snapshot and spends its cost.
    ///
    /// cost  returns the bytes of the snapshot at a detail; its last call is for the chosen one.
    template <class Cost>
    Choice choose(Clock::time_point now, const Cost& cost);

    /// The same for a snapshot that was already sent: chooses more detail, or none.
    ///
    /// shown  the detail in which it was sent, less than wanted.
    template <class Cost>
    Choice refine(Clock::time_point now, v1::Detail shown, const Cost& cost);

  private:
    double bytes_max() const { return accumulated_s_max * bytes_per_s_; }
    Clock::time_point when_accumulated(double bytes, Clock::time_point now) const;
    void raise_detail(v1::Detail detail, Clock::time_point now);
    void accumulate(Clock::time_point now);
    void lower_detail(Clock::time_point now);
    static v1::Detail less(v1::Detail detail) { return static_cast<v1::Detail>(detail + 1); }

    double bytes_per_s_ = 0, bytes_ = 0; // accumulated; < 0 after a snapshot that cost more
    v1::Detail most_ = v1::DETAIL_FULL, detail_ = v1::DETAIL_FULL;
    Clock::duration retry_after_ = retry_min;
    std::optional<Clock::time_point> updated_; // when bytes_ was
    Clock::time_point raised_, try_more_;      // when detail_ was raised; when more detail is tried
};

template <class Cost>
Bandwidth::Choice Bandwidth::choose(Clock::time_point now, const Cost& cost) {
    accumulate(now);
    if (detail_ != most_ && now >= try_more_) {
        // Starts with the most detail: where little changes, a full delta may cost less than dots.
        const auto affordable = [&](v1::Detail detail) { return static_cast<double>(cost(detail)) <= bytes_; };
        v1::Detail more = most_;
        while (more != detail_ && !affordable(more)) {
            more = less(more);
        }
        raise_detail(more, now);
    }
    for (;;) {
        const auto bytes = static_cast<double>(cost(detail_));
        // A snapshot that costs more than can ever accumulate is sent when the maximum has accumulated.
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
