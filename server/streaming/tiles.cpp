#include "server/streaming/tiles.h"

#include <span>
#include <utility>

namespace evod::streaming {

IslandTiles::IslandTiles(v1::SnapshotFrame about, std::shared_ptr<const codec::QuantisedSnapshot> scene,
                         codec::Compressor& compressor)
    : scene_{std::move(scene), codec::tile_layout(about.width_px(), about.height_px())}
    , about_{std::move(about)}
    , compressor_{&compressor} {
    about_.set_codec(v1::CODEC_DELTA);
    about_.set_tile_px(scene_.layout().tile_px);
}

const SharedBytes& IslandTiles::about_bytes() {
    if (!about_bytes_) {
        about_bytes_ = std::make_shared<const std::string>(about_.SerializeAsString());
    }
    return about_bytes_;
}

SharedBytes IslandTiles::encode(v1::SnapshotTile tile, std::string_view body, const codec::Seams& seams,
                                v1::Compression compression) {
    codec::set_counts(scene_.counts(tile.tile()), tile);
    tile.set_sequence(about_.sequence());
    tile.set_checksum(codec::checksum_of(about_, tile, body));
    std::string compressed;
    const std::string_view sent = sent_body(tile, body, seams, compression, *compressor_, compressed);
    const std::size_t bytes = tile.ByteSizeLong() + field_bytes(v1::SnapshotTile::kBodyFieldNumber, sent.size());
    std::string field;
    field.reserve(field_bytes(v1::SnapshotFrame::kTilesFieldNumber, bytes));
    append_field_head(v1::SnapshotFrame::kTilesFieldNumber, bytes, field);
    tile.AppendToString(&field);
    append_field_head(v1::SnapshotTile::kBodyFieldNumber, sent.size(), field);
    field += sent;
    return std::make_shared<const std::string>(std::move(field));
}

const SharedBytes& IslandTiles::coarse(std::uint32_t tile, v1::Detail detail, v1::Compression compression) {
    if (coarse_.empty()) {
        coarse_.resize(scene_.layout().count());
    }
    const bool dots = detail == v1::DETAIL_DOTS;
    SharedBytes& bytes = coarse_[tile][(dots ? 0 : 2) + (compression == v1::COMPRESSION_ZSTD ? 1 : 0)];
    if (!bytes) {
        v1::SnapshotTile picture;
        picture.set_tile(tile);
        picture.set_detail(detail);
        bytes = encode(std::move(picture), dots ? scene_.dots(tile) : scene_.density(tile), {}, compression);
    }
    return bytes;
}

TiledSnapshot::TiledSnapshot(std::shared_ptr<IslandTiles> island, const std::shared_ptr<TiledSnapshot>& before,
                             runtime::Clock::time_point now, runtime::Clock::duration between)
    : island_{std::move(island)}, now_{now}, between_{between}, tiles_(layout().count()) {
    const codec::Counts counts = island_->scene().counts_before(layout().count());
    organisms_.x.resize(counts[0]);
    organisms_.y.resize(counts[0]);
    crates_.x.resize(counts[3]);
    crates_.y.resize(counts[3]);
    if (!before) {
        return;
    }
    before->before_ = nullptr; // nobody is sent that one any more
    const auto ticks = ticks_between(before->island_->about(), island_->about());
    if (!ticks || before->layout() != layout()) {
        return;
    }
    before_ = before;
    ticks_ = *ticks;
}

const SharedBytes& TiledSnapshot::tile(std::uint32_t tile, v1::Detail detail, v1::Compression compression,
                                       std::uint64_t sent) {
    if (detail != v1::DETAIL_FULL) {
        return island_->coarse(tile, detail, compression);
    }
    Tile& of = full(tile);
    const bool has_base = sent != 0 && sent == of.base_sequence;
    const Form form = sent == sequence() ? Form::Again : has_base ? Form::Delta : Form::Keyframe;
    SharedBytes& bytes = of.forms[static_cast<std::size_t>(form)][compression == v1::COMPRESSION_ZSTD ? 1 : 0];
    if (bytes) {
        return bytes;
    }
    v1::SnapshotTile picture;
    picture.set_tile(tile);
    picture.set_detail(detail);
    if (form == Form::Keyframe) {
        codec::Seams seams;
        const std::string body = codec::encode_keyframe(baseline(tile), &seams);
        return bytes = island_->encode(std::move(picture), body, seams, compression);
    }
    picture.set_base_sequence(sent);
    if (form == Form::Delta) {
        return bytes = island_->encode(std::move(picture), of.delta, of.delta_seams, compression);
    }
    const codec::BaselineView here = baseline(tile);
    return bytes = island_->encode(std::move(picture), codec::encode_delta(here, here.scene, 0), {}, compression);
}

TiledSnapshot::Tile& TiledSnapshot::full(std::uint32_t tile) {
    if (tiles_[tile]) {
        return *tiles_[tile];
    }
    Tile& of = *(tiles_[tile] = std::make_unique<Tile>());
    of.keyframe_made = now_;
    if (before_ && before_->tiles_[tile]) {
        const Tile& before = *before_->tiles_[tile];
        const codec::Counts begin = island_->scene().counts_before(tile), count = island_->scene().counts(tile);
        const auto part = [&](Displacements& all, std::size_t k) {
            return codec::AdvancedColumns::Displacements{std::span{all.x}.subspan(begin[k], count[k]),
                                                         std::span{all.y}.subspan(begin[k], count[k])};
        };
        const codec::QuantisedView scene = island_->scene().full(tile);
        const codec::AdvancedColumns to{.organisms = part(organisms_, 0), .crates = part(crates_, 3)};
        // Otherwise the next picture would come too late to be the keyframe. In that nothing has moved yet, as in a
        // chain's.
        if (now_ + between_ <= before.keyframe_made + keyframe_interval) {
            of.ticks = ticks_ > 0 ? ticks_ : before.ticks;
            of.delta = codec::encode_delta(before_->baseline(tile), scene, ticks_, &to, &of.delta_seams);
            of.base_sequence = before_->sequence();
            of.keyframe_made = before.keyframe_made;
        }
    }
    return of;
}

codec::BaselineView TiledSnapshot::baseline(std::uint32_t tile) const {
    const codec::Counts begin = island_->scene().counts_before(tile), count = island_->scene().counts(tile);
    const auto part = [&](const Displacements& all, std::size_t k) {
        return codec::BaselineView::Displacements{std::span{all.x}.subspan(begin[k], count[k]),
                                                  std::span{all.y}.subspan(begin[k], count[k])};
    };
    codec::BaselineView baseline;
    baseline.scene = island_->scene().full(tile);
    baseline.organisms = part(organisms_, 0);
    baseline.crates = part(crates_, 3);
    baseline.ticks = tiles_[tile]->ticks;
    return baseline;
}

void SentTiles::add_parts(TiledSnapshot& picture, const codec::TileRange& seen, v1::Detail detail,
                          v1::Compression compression, std::vector<const SharedBytes*>& parts) const {
    parts.push_back(&picture.about());
    const std::uint32_t columns = picture.layout().columns;
    for (std::uint32_t row = seen.row_begin; row < seen.row_end; ++row) {
        const bool has_row = row >= full_.row_begin && row < full_.row_end;
        for (std::uint32_t column = seen.column_begin; column < seen.column_end; ++column) {
            const bool has = has_row && column >= full_.column_begin && column < full_.column_end;
            parts.push_back(&picture.tile(row * columns + column, detail, compression, has ? sequence_ : 0));
        }
    }
}

void SentTiles::sent(const TiledSnapshot& picture, const codec::TileRange& seen, v1::Detail detail) {
    sequence_ = picture.sequence();
    full_ = detail == v1::DETAIL_FULL ? seen : codec::TileRange{};
}

} // namespace evod::streaming
