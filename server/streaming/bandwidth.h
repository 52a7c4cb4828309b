// Bandwidth: how closely a viewer is shown each picture so that it is sent no more bytes a second than it wants.
//
// What is not spent is saved for a while, for keyframes are long. When a picture costs more than there is, detail is
// left out, and where that does not help the picture is. More detail is tried again after a while, of the same picture
// if no other has come; if it cannot be kept up, after a longer one.
//
// Owner        a subscription; on the network thread.
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
    static constexpr double saved_s_max = 2;                                 // of the rate, is saved
    static constexpr std::chrono::seconds patience_min{2}, patience_max{64}; // before more detail is tried

    /// bytes_per_s  above 0; most: the detail that is wanted.
    Bandwidth(double bytes_per_s, v1::Detail most) { change(bytes_per_s, most); }

    /// Something else is wanted now: it is shown as closely as it can be. What is saved stays, as far as it may; what
    /// may be saved beyond that is there, as at the beginning.
    void change(double bytes_per_s, v1::Detail most);

    struct Choice {
        std::optional<v1::Detail> detail; // nullopt: the picture cannot be sent yet
        Clock::time_point again;          // then it can; or, if it is sent in less detail than is wanted, look_closer()
    };
    /// How closely a picture is shown now; what that costs is spent.
    ///
    /// cost  bytes of the picture at a detail; asked last of the one that is chosen.
    template <class Cost>
    Choice choose(Clock::time_point now, const Cost& cost);

    /// The same of a picture that was shown already, and stays: in more detail than that, or not at all.
    ///
    /// shown  less than is wanted.
    template <class Cost>
    Choice look_closer(Clock::time_point now, v1::Detail shown, const Cost& cost);

  private:
    double saved_bytes_max() const { return saved_s_max * bytes_per_s_; }
    Clock::time_point when_saved(double bytes, Clock::time_point now) const;
    void tell_more(v1::Detail detail, Clock::time_point now);
    void save(Clock::time_point now);
    void tell_less(Clock::time_point now);
    static v1::Detail less(v1::Detail detail) { return static_cast<v1::Detail>(detail + 1); }

    double bytes_per_s_ = 0, saved_bytes_ = 0; // below 0 after a picture longer than can be saved for
    v1::Detail most_ = v1::DETAIL_FULL, detail_ = v1::DETAIL_FULL;
    Clock::duration patience_ = patience_min;
    std::optional<Clock::time_point> looked_; // at what is saved
    Clock::time_point rose_, try_more_;       // to detail_ from less; when that is to be tried
};

template <class Cost>
Bandwidth::Choice Bandwidth::choose(Clock::time_point now, const Cost& cost) {
    save(now);
    if (detail_ != most_ && now >= try_more_) {
        // From the most on: where little changes, all of a picture that is told from the one before may cost less than
        // its dots.
        const auto affordable = [&](v1::Detail detail) { return static_cast<double>(cost(detail)) <= saved_bytes_; };
        v1::Detail more = most_;
        while (more != detail_ && !affordable(more)) {
            more = less(more);
        }
        tell_more(more, now);
    }
    for (;;) {
        const auto bytes = static_cast<double>(cost(detail_));
        // What never can be saved for is sent when all is saved that can be.
        const double needed = std::min(bytes, saved_bytes_max());
        if (detail_ != v1::DETAIL_DENSITY && bytes > saved_bytes_) {
            tell_less(now);
            continue;
        }
        if (needed > saved_bytes_) {
            return {std::nullopt, when_saved(needed, now)};
        }
        saved_bytes_ -= bytes;
        return {detail_, detail_ == most_ ? now : try_more_};
    }
}

template <class Cost>
Bandwidth::Choice Bandwidth::look_closer(Clock::time_point now, v1::Detail shown, const Cost& cost) {
    save(now);
    if (detail_ >= shown && now < try_more_) {
        return {std::nullopt, try_more_};
    }
    for (v1::Detail detail = most_; detail < shown; detail = less(detail)) {
        const auto bytes = static_cast<double>(cost(detail));
        if (bytes > saved_bytes_max()) {
            continue;
        }
        if (bytes > saved_bytes_) {
            return {std::nullopt, when_saved(bytes, now)};
        }
        saved_bytes_ -= bytes;
        tell_more(detail, now);
        return {detail, try_more_};
    }
    return {std::nullopt, Clock::time_point::max()};
}

} // namespace evod::streaming
