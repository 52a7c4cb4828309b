#include "server/network/budget.h"

namespace evod::network {

void Budget::change(double bytes_per_s, v1::Detail most) {
    bytes_per_s_ = bytes_per_s;
    saved_bytes_ = std::min(saved_bytes_, saved_bytes_max());
    most_ = detail_ = most;
    patience_ = patience_min;
    rose_ = {};
}

void Budget::save(Clock::time_point now) {
    const std::chrono::duration<double> passed = looked_ ? now - *looked_ : Clock::duration{0};
    looked_ = now;
    saved_bytes_ = std::min(saved_bytes_ + bytes_per_s_ * passed.count(), saved_bytes_max());
}

void Budget::tell_less(Clock::time_point now) {
    // More detail that could not be kept up is tried less often; what could for long enough begins anew.
    const bool kept_up = now - rose_ > 2 * patience_;
    patience_ = kept_up ? Clock::duration{patience_min} : std::min<Clock::duration>(2 * patience_, patience_max);
    detail_ = less(detail_);
    try_more_ = now + patience_;
}

} // namespace evod::network
