// Any SnapshotFrames, one after another, are decoded or refused by one decoder; what is decoded has the counts that its
// frame tells, and ids that rise.
//
// The input is frames, each behind its length in two bytes. Checksums are put right, for chance would find none.
#include "proto/wire/delta_codec.h"
#include "proto/wire/little_endian.h"

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

void require_rising(const std::vector<std::uint32_t>& ids) {
    require(std::adjacent_find(ids.begin(), ids.end(), std::greater_equal<>{}) == ids.end());
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    evod::wire::PictureDecoder decoder;
    while (size >= 2) {
        const std::size_t length = std::min<std::size_t>(evod::wire::load<std::uint16_t>(data), size - 2);
        evod::v1::SnapshotFrame frame;
        if (!frame.ParseFromArray(data + 2, static_cast<int>(length))) {
            return 0;
        }
        data += 2 + length;
        size -= 2 + length;
        if (frame.compression() != evod::v1::COMPRESSION_ZSTD) {
            frame.set_checksum(evod::wire::checksum_of(frame, frame.body()));
        }
        const auto picture = decoder.decode(std::move(frame));
        if (!picture) {
            require(!picture.error().what.empty());
            continue;
        }
        const auto& organisms = picture->organisms;
        require(organisms.id.size() == picture->about.organism_count());
        require_rising(organisms.id);
        for (const auto* column : {&organisms.x_px, &organisms.y_px, &organisms.radius_px, &organisms.health}) {
            require_finite(*column, organisms.id.size());
        }
        for (const auto* items : {&picture->food, &picture->poison}) {
            require_rising(items->id);
            require_finite(items->x_px, items->id.size());
            require_finite(items->y_px, items->id.size());
        }
        require(picture->food.id.size() == picture->about.food_count());
        require(picture->poison.id.size() == picture->about.poison_count());
        require(picture->crates.x_px.size() == picture->about.crate_count());
        require(picture->obstacles.x_px.size() == picture->about.obstacle_count());
        for (const auto* boxes : {&picture->crates, &picture->obstacles}) {
            for (const auto* column : {&boxes->x_px, &boxes->y_px, &boxes->half_width_px, &boxes->half_height_px}) {
                require_finite(*column, boxes->x_px.size());
            }
        }
    }
    return 0;
}
