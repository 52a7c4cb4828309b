#include "server/streaming/subscription.h"

namespace evod::streaming {

void SnapshotSubscription::set_view(const v1::View& wanted) {
    view = wanted;
    if (view->detail() == v1::DETAIL_UNSPECIFIED) {
        view->set_detail(v1::DETAIL_FULL);
    }
    const auto bytes_per_s = static_cast<double>(view->bytes_per_s_max());
    if (!view->has_bytes_per_s_max()) {
        bandwidth.reset();
    } else if (bandwidth) {
        bandwidth->change(bytes_per_s, view->detail());
    } else {
        bandwidth.emplace(bytes_per_s, view->detail());
    }
}

Form SnapshotSubscription::form() const {
    return codec != v1::CODEC_DELTA ? Form::Plain : view ? Form::Tiles : Form::Whole;
}

SnapshotSubscription to_subscription(const v1::SubscribeSnapshots& request, const std::string& world,
                                     std::uint32_t island_count, double rate_hz) {
    SnapshotSubscription subscription;
    subscription.world = world;
    if (request.has_island()) {
        subscription.island = request.island();
    } else {
        subscription.island_count = island_count;
    }
    subscription.rate_hz = rate_hz;
    if (request.codec() != v1::CODEC_UNSPECIFIED) {
        subscription.codec = request.codec();
    }
    subscription.compression = request.compression();
    if (request.has_unacknowledged_max()) {
        subscription.unacknowledged_max = request.unacknowledged_max();
    }
    subscription.with = {.headings = request.headings(), .species = request.species()};
    if (request.has_view()) {
        subscription.set_view(request.view());
    }
    return subscription;
}

} // namespace evod::streaming
