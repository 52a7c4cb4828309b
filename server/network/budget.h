// Budget: how closely a viewer is shown each picture so that it is sent no more bytes a second than it wants.
//
// What is not spent is saved for a while, for keyframes are long. When a picture costs more than there is, detail is
// left out, and where that does not help the picture is. More detail is tried again after a while; if it cannot be kept
// up, after a longer one.
//
// Owner        a subscription; on the network thread.
#pragma once

#include "evod/v1/stream.pb.h"
#include "server/runtime/clock.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>

namespace evod::network {

namespace v1 = evod::v1;

class Budget {
  public:
    using Clock = runtime::Clock;
    static constexpr double saved_s_max = 2;                                 // of the rate, is saved
    static constexpr std::chrono::seconds patience_min{2}, patience_max{64}; // before more detail is tried

    /// bytes_per_s  above 0; most: the detail that is wanted.
    Budget(double bytes_per_s, v1::Detail most) : saved_bytes_{saved_s_max * bytes_per_s} { change(bytes_per_s, most); }

    /// Something else is wanted now: it is shown as closely as it can be. What is saved stays, as far as it may.
    void change(double bytes_per_s, v1::Detail most);

    struct Choice {
        std::optional<v1::Detail> detail; // nullopt: the picture cannot be sent yet
        Clock::time_point again;          // then it can
    };
    /// How closely a picture is shown now; what that costs is spent.
    ///
    /// cost  bytes of the picture at a detail; asked last of the one that is chosen.
    template <class Cost>
    Choice choose(Clock::time_point now, const Cost& cost);

  private:
    double saved_bytes_max() const { return saved_s_max * bytes_per_s_; }
    void save(Clock::time_point now);
    void tell_less(Clock::time_point now);
    static v1::Detail less(v1::Detail detail) { return static_cast<v1::Detail>(detail + 1); }

    double bytes_per_s_ = 0, saved_bytes_; // below 0 after a picture longer than can be saved for
    v1::Detail most_ = v1::DETAIL_FULL, detail_ = v1::DETAIL_FULL;
    Clock::duration patience_ = patience_min;
    std::optional<Clock::time_point> looked_; // at what is saved
    Clock::time_point rose_, try_more_;       // to detail_ from less; when that is to be tried
};

template <class Cost>
Budget::Choice Budget::choose(Clock::time_point now, const Cost& cost) {
    save(now);
    if (detail_ != most_ && now >= try_more_) {
        // From the most on: where little changes, all of a picture that is told from the one before may cost less than
        // its dots.
        const auto affordable = [&](v1::Detail detail) { return static_cast<double>(cost(detail)) <= saved_bytes_; };
        v1::Detail more = most_;
        while (more != detail_ && !affordable(more))
            more = less(more);
        if (more != detail_)
            rose_ = now;
        detail_ = more;
        try_more_ = now + patience_;
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
            const std::chrono::duration<double> wait{(needed - saved_bytes_) / bytes_per_s_};
            return {std::nullopt, now + std::chrono::ceil<Clock::duration>(wait)};
        }
        saved_bytes_ -= bytes;
        return {detail_, now};
    }
}

} // namespace evod::network
