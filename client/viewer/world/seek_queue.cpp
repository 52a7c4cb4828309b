#include "client/viewer/world/seek_queue.h"

#include <utility>

namespace evod::viewer {

std::optional<evod::v1::RunMoment> SeekQueue::add(evod::v1::RunMoment to) {
    if (under_way_) {
        next_ = std::move(to);
        return std::nullopt;
    }
    under_way_ = std::move(to);
    return under_way_;
}

std::optional<evod::v1::RunMoment> SeekQueue::answered() {
    under_way_ = std::exchange(next_, std::nullopt);
    return under_way_;
}

const evod::v1::RunMoment* SeekQueue::target() const {
    return next_ ? &*next_ : under_way_ ? &*under_way_ : nullptr;
}

} // namespace evod::viewer
