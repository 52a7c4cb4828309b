// Any SnapshotFrame is decoded or refused; what is decoded has columns of one length and finite numbers.
#include "proto/wire/snapshot_codec.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace {

void require(bool holds) {
    if (!holds) {
        std::abort();
    }
}

void require_finite(const std::vector<float>& column, std::size_t size) {
    require(column.size() == size);
    require(std::all_of(column.begin(), column.end(), [](float value) { return std::isfinite(value); }));
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    evod::v1::SnapshotFrame frame;
    if (!frame.ParseFromArray(data, static_cast<int>(size))) {
        return 0;
    }
    const auto picture = evod::wire::decode(std::move(frame));
    if (!picture) {
        require(!picture.error().what.empty());
        return 0;
    }
    const auto& organisms = picture->organisms;
    for (const auto* column : {&organisms.x_px, &organisms.y_px, &organisms.radius_px, &organisms.health}) {
        require_finite(*column, organisms.id.size());
    }
    for (const auto* items : {&picture->food, &picture->poison}) {
        require_finite(items->x_px, items->id.size());
        require_finite(items->y_px, items->id.size());
    }
    for (const auto* boxes : {&picture->crates, &picture->obstacles}) {
        for (const auto* column : {&boxes->x_px, &boxes->y_px, &boxes->half_width_px, &boxes->half_height_px}) {
            require_finite(*column, boxes->x_px.size());
        }
    }
    return 0;
}
