#include "server/streaming/bandwidth.h"

namespace evod::streaming {

void Bandwidth::change(double bytes_per_s, v1::Detail most) {
    const double more_bytes = accumulated_s_max * (bytes_per_s - bytes_per_s_);
    bytes_per_s_ = bytes_per_s;
    // The debt after a very large snapshot is limited, so that the next snapshot does not wait long.
    bytes_ = std::clamp(bytes_ + std::max(more_bytes, 0.0), -bytes_max(), bytes_max());
    most_ = detail_ = most;
    retry_after_ = retry_min;
    raised_ = {};
}

void Bandwidth::accumulate(Clock::time_point now) {
    const std::chrono::duration<double> passed = updated_ ? now - *updated_ : Clock::duration{0};
    updated_ = now;
    bytes_ = std::min(bytes_ + bytes_per_s_ * passed.count(), bytes_max());
}

Bandwidth::Clock::time_point Bandwidth::when_accumulated(double bytes, Clock::time_point now) const {
    const std::chrono::duration<double> wait{(bytes - bytes_) / bytes_per_s_};
    return now + std::chrono::ceil<Clock::duration>(wait);
}

void Bandwidth::raise_detail(v1::Detail detail, Clock::time_point now) {
    if (detail < detail_) {
        raised_ = now;
    }
    detail_ = std::min(detail_, detail);
    try_more_ = now + retry_after_;
}

void Bandwidth::lower_detail(Clock::time_point now) {
    // If the higher detail was not sustained, the interval until the next attempt is doubled, otherwise reset.
    const bool sustained = now - raised_ > 2 * retry_after_;
    retry_after_ = sustained ? Clock::duration{retry_min} : std::min<Clock::duration>(2 * retry_after_, retry_max);
    detail_ = less(detail_);
    try_more_ = now + retry_after_;
}

} // namespace evod::streaming
