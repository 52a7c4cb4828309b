#include "proto/codec/snapshot_decoder.h"

#include "proto/codec/compression.h"
#include "proto/codec/framing.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace evod::codec {

namespace {

/// Returns the uncompressed body, or Damage if it is longer than bytes_max.
Result<std::string> content_of(std::string body, evod::v1::Compression compression, std::uint64_t bytes_max) {
    switch (compression) {
    case evod::v1::COMPRESSION_ZSTD:
        return decompress(body, bytes_max);
    case evod::v1::COMPRESSION_UNSPECIFIED:
    case evod::v1::COMPRESSION_NONE:
        return {boost::system::in_place_value, std::move(body)};
    default:
        return Damage{"a snapshot's compression is " + std::to_string(compression) + ", not a known one"};
    }
}

Damage keyframe_needed() {
    return Damage{"a snapshot has an unknown base: a keyframe is needed"};
}

Damage checksum_mismatch() {
    return Damage{"a snapshot's checksum does not match its body"};
}

Damage base_mismatch(std::uint64_t got, std::uint64_t last) {
    return Damage{"a snapshot's base_sequence is " + std::to_string(got) + ", not the last one, " +
                  std::to_string(last)};
}

} // namespace

bool is_keyframe(const evod::v1::SnapshotFrame& frame) {
    return frame.base_sequence() == 0 &&
           std::ranges::all_of(frame.tiles(), [](const auto& tile) { return tile.base_sequence() == 0; });
}

Result<ReceivedSnapshot> SnapshotDecoder::decode(evod::v1::SnapshotFrame frame) {
    if (frame.codec() != evod::v1::CODEC_DELTA) {
        return decode_plain(std::move(frame));
    }
    frame.clear_plain(); // has no meaning with this codec
    auto decoded = frame.tile_px() > 0 ? decode_tiles(std::move(frame)) : decode_whole(std::move(frame));
    if (!decoded) {
        forget();
    }
    return decoded;
}

void SnapshotDecoder::forget() {
    snapshot_ = nullptr;
    whole_.reset();
    tiles_.reset();
}

Result<ReceivedSnapshot> SnapshotDecoder::decode_whole(evod::v1::SnapshotFrame frame) {
    const bool keyframe = frame.base_sequence() == 0;
    if (!keyframe && !whole_) {
        return keyframe_needed();
    }
    if (!keyframe && frame.base_sequence() != whole_->about.sequence()) {
        return base_mismatch(frame.base_sequence(), whole_->about.sequence());
    }
    if (!keyframe) {
        frame.set_world(whole_->about.world());
        frame.set_run_id(whole_->about.run_id());
        frame.set_island_count(whole_->about.island_count());
        frame.set_width_px(whole_->about.width_px());
        frame.set_height_px(whole_->about.height_px());
        frame.set_item_radius_px(whole_->about.item_radius_px());
    }
    if (auto damage = damage_of_fields(frame)) {
        return *std::move(damage);
    }
    const Baseline* const base = keyframe ? nullptr : &whole_->baseline;
    const Counts counts = counts_of(frame);
    const auto content = content_of(std::move(*frame.mutable_body()), frame.compression(),
                                    body_bytes_max(counts, base ? base->snapshot.get() : nullptr));
    frame.clear_body();
    frame.clear_tiles(); // tiles have no meaning without tile_px
    if (!content) {
        return content.error();
    }
    if (checksum_of(frame, *content) != frame.checksum()) {
        return checksum_mismatch();
    }
    auto baseline =
        decode_body(*content, {.counts = counts, .position_bytes = frame.position_bytes(), .of_tile = false}, base);
    if (!baseline) {
        return baseline.error();
    }
    forget();
    snapshot_ = baseline->snapshot;
    whole_ = WholeIsland{.baseline = *std::move(baseline), .about = frame};
    return ReceivedSnapshot{.about = std::move(frame), .entities = snapshot_, .tiles = {}};
}

Result<ReceivedSnapshot> SnapshotDecoder::decode_tiles(evod::v1::SnapshotFrame frame) {
    if (auto damage = damage_of_fields(frame)) {
        return *std::move(damage);
    }
    const auto layout = tile_layout_of(frame);
    if (!layout) {
        return layout.error();
    }
    Tiles next{.layout = *layout, .bases = {}};
    std::vector<DecodedTile> visible;
    std::vector<const QuantisedSnapshot*> snapshots;
    std::uint64_t content_bytes_left = *client_limits.stream_bytes_max; // for all tiles together
    for (evod::v1::SnapshotTile& tile : *frame.mutable_tiles()) {
        if (tile.tile() >= layout->count()) {
            return Damage{"a tile's index is " + std::to_string(tile.tile()) + ", not one of " +
                          std::to_string(layout->count())};
        }
        if (!visible.empty() && visible.back().tile >= tile.tile()) {
            return Damage{"a snapshot's tiles are out of order"};
        }
        if (tile.sequence() != frame.sequence()) {
            return Damage{"a tile's sequence is " + std::to_string(tile.sequence()) + ", not that of its snapshot, " +
                          std::to_string(frame.sequence())};
        }
        const Tiles::Base* base = nullptr;
        if (tile.detail() == evod::v1::DETAIL_FULL && tile.base_sequence() != 0) {
            if (tiles_ && tiles_->layout == *layout && tiles_->bases.contains(tile.tile())) {
                base = &tiles_->bases.at(tile.tile());
            }
            if (!base) {
                return keyframe_needed();
            }
            if (tile.base_sequence() != base->sequence) {
                return base_mismatch(tile.base_sequence(), base->sequence);
            }
        }
        const Counts counts = counts_of(tile);
        const std::uint64_t bytes_max = tile.detail() == evod::v1::DETAIL_DENSITY
                                            ? density_bytes_max
                                            : body_bytes_max(counts, base ? base->baseline.snapshot.get() : nullptr);
        const auto content =
            content_of(std::move(*tile.mutable_body()), tile.compression(), std::min(bytes_max, content_bytes_left));
        if (!content) {
            return content.error();
        }
        content_bytes_left -= std::min<std::uint64_t>(content_bytes_left, content->size());
        if (checksum_of(frame.tile_px(), frame.position_bytes(), tile, *content) != tile.checksum()) {
            return Damage{"a tile's checksum does not match its body"};
        }
        DecodedTile& decoded = visible.emplace_back();
        decoded.tile = tile.tile();
        decoded.detail = tile.detail();
        decoded.left_px = double{1} * (tile.tile() % layout->columns) * layout->tile_px;
        decoded.top_px = double{1} * (tile.tile() / layout->columns) * layout->tile_px;
        if (tile.detail() == evod::v1::DETAIL_FULL) {
            auto baseline =
                decode_body(*content, {.counts = counts, .position_bytes = frame.position_bytes(), .of_tile = true},
                            base ? &base->baseline : nullptr);
            if (!baseline) {
                return baseline.error();
            }
            snapshots.push_back(baseline->snapshot.get());
            next.bases[tile.tile()] = {.sequence = tile.sequence(), .baseline = *std::move(baseline)};
        } else if (tile.detail() == evod::v1::DETAIL_DOTS) {
            auto dots = decode_dots(*content, counts, *layout, tile.tile());
            if (!dots) {
                return dots.error();
            }
            decoded.dots = *std::move(dots);
        } else if (tile.detail() == evod::v1::DETAIL_DENSITY) {
            auto density = decode_density(*content, counts);
            if (!density) {
                return density.error();
            }
            decoded.density = *std::move(density);
        } else {
            return Damage{"a tile's detail is " + std::to_string(tile.detail()) + ", not a known one"};
        }
    }
    auto snapshot = merged(frame.position_bytes(), snapshots);
    if (!snapshot) {
        return snapshot.error();
    }
    forget();
    snapshot_ = std::make_shared<const QuantisedSnapshot>(*std::move(snapshot));
    tiles_ = std::move(next);
    frame.clear_body();
    frame.clear_tiles();
    return ReceivedSnapshot{.about = std::move(frame), .entities = snapshot_, .tiles = std::move(visible)};
}

} // namespace evod::codec
