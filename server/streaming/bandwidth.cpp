#include "server/streaming/bandwidth.h"

namespace evod::streaming {

void Bandwidth::change(double bytes_per_s, v1::Detail most) {
    const double saved_bytes_more = saved_s_max * (bytes_per_s - bytes_per_s_);
    bytes_per_s_ = bytes_per_s;
    // After one huge snapshot the debt is limited, so that the next snapshot need not wait long.
    saved_bytes_ = std::clamp(saved_bytes_ + std::max(saved_bytes_more, 0.0), -saved_bytes_max(), saved_bytes_max());
    most_ = detail_ = most;
    patience_ = patience_min;
    rose_ = {};
}

void Bandwidth::save(Clock::time_point now) {
    const std::chrono::duration<double> passed = looked_ ? now - *looked_ : Clock::duration{0};
    looked_ = now;
    saved_bytes_ = std::min(saved_bytes_ + bytes_per_s_ * passed.count(), saved_bytes_max());
}

Bandwidth::Clock::time_point Bandwidth::when_saved(double bytes, Clock::time_point now) const {
    const std::chrono::duration<double> wait{(bytes - saved_bytes_) / bytes_per_s_};
    return now + std::chrono::ceil<Clock::duration>(wait);
}

void Bandwidth::tell_more(v1::Detail detail, Clock::time_point now) {
    if (detail < detail_) {
        rose_ = now;
    }
    detail_ = std::min(detail_, detail);
    try_more_ = now + patience_;
}

void Bandwidth::tell_less(Clock::time_point now) {
    // More detail that could not be kept up is tried less often; what could for long enough begins anew.
    const bool kept_up = now - rose_ > 2 * patience_;
    patience_ = kept_up ? Clock::duration{patience_min} : std::min<Clock::duration>(2 * patience_, patience_max);
    detail_ = less(detail_);
    try_more_ = now + patience_;
}

} // namespace evod::streaming
