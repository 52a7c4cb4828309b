#include "server/streaming/delta_stream.h"

#include <limits>
#include <span>
#include <utility>

namespace evod::streaming {
namespace {

constexpr std::size_t organisms = 0, crates = 3; // indices in codec::Counts

/// Returns the parts of the columns x and y that belong to one tile.
template <class Part, class Displacements>
Part part_of(Displacements& all, std::uint32_t begin, std::uint32_t count) {
    return {std::span{all.x}.subspan(begin, count), std::span{all.y}.subspan(begin, count)};
}

} // namespace

std::optional<std::uint16_t> ticks_between(const v1::SnapshotFrame& before, const v1::SnapshotFrame& after) {
    if (!codec::same_unchanging(after, before) || after.generation() != before.generation() ||
        after.generation_tick() < before.generation_tick() ||
        after.generation_tick() - before.generation_tick() > std::numeric_limits<std::uint16_t>::max()) {
        return std::nullopt;
    }
    return static_cast<std::uint16_t>(after.generation_tick() - before.generation_tick());
}

StreamedSnapshot::StreamedSnapshot(std::shared_ptr<EncodedIsland> island, Form form,
                                   const std::shared_ptr<StreamedSnapshot>& previous, runtime::Clock::time_point now,
                                   runtime::Clock::duration between)
    : island_{std::move(island)}
    , form_{form}
    , layout_{form == Form::Tiles ? island_->tiles().layout()
                                  : codec::TileLayout{.width_px = island_->about().width_px(),
                                                      .height_px = island_->about().height_px()}}
    , now_{now}
    , between_{between}
    , tiles_(layout_.count())
    , held_{island_->memory()} {
    held_.set(sizeof(StreamedSnapshot) + 2 * allocation_bytes + tiles_.size() * sizeof(tiles_[0]));
    if (form == Form::Plain) {
        return;
    }
    const codec::Counts all = counts_before(layout_.count());
    for (auto* column : {&organisms_.x, &organisms_.y}) {
        column->resize(all[organisms]);
    }
    for (auto* column : {&crates_.x, &crates_.y}) {
        column->resize(all[crates]);
    }
    held_.set(held_.bytes() + 2 * sizeof(std::uint32_t) * (all[organisms] + all[crates]));
    if (!previous) {
        return;
    }
    previous->previous_ = nullptr; // no session sends the snapshot before the previous one any more
    const auto ticks = ticks_between(previous->island_->about(), island_->about());
    if (!ticks || previous->layout_ != layout_) {
        return;
    }
    previous_ = previous;
    ticks_ = *ticks;
}

const SharedBytes* StreamedSnapshot::head() {
    return form_ == Form::Tiles ? &island_->without_tiles() : nullptr;
}

const SharedBytes& StreamedSnapshot::tile(std::uint32_t tile, v1::Detail detail, v1::Compression compression,
                                          std::uint64_t sent) {
    if (form_ == Form::Plain) {
        return island_->plain();
    }
    if (detail != v1::DETAIL_FULL) {
        return island_->coarse_tile(tile, detail, compression);
    }
    Tile& of = full(tile);
    const bool has_base = sent != 0 && sent == of.base_sequence;
    const Encoding encoding = sent == sequence() ? Encoding::Repeat : has_base ? Encoding::Delta : Encoding::Keyframe;
    SharedBytes& bytes = of.encodings[static_cast<std::size_t>(encoding)][compression == v1::COMPRESSION_ZSTD ? 1 : 0];
    if (bytes) {
        return bytes;
    }
    const auto encode = [&](std::uint64_t base_sequence, std::string_view body, const codec::Seams& seams) {
        return form_ == Form::Whole ? island_->whole(base_sequence, body, seams, compression)
                                    : island_->full_tile(tile, base_sequence, body, seams, compression);
    };
    switch (encoding) {
    case Encoding::Keyframe: {
        codec::Seams seams;
        const std::string body = codec::encode_keyframe(baseline(tile), &seams);
        bytes = encode(0, body, seams);
        break;
    }
    case Encoding::Delta:
        bytes = encode(sent, of.delta, of.delta_seams);
        break;
    case Encoding::Repeat: {
        const codec::BaselineView here = baseline(tile);
        bytes = encode(sent, codec::encode_delta(here, here.snapshot, 0), {});
        break;
    }
    }
    kept_encoding_bytes_ += bytes_of(bytes);
    return bytes;
}

std::size_t StreamedSnapshot::bytes() const {
    return held_.bytes() + kept_encoding_bytes_ + island_->bytes() / static_cast<std::size_t>(island_.use_count()) +
           (previous_ ? previous_->bytes() : 0);
}

StreamedSnapshot::Tile& StreamedSnapshot::full(std::uint32_t tile) {
    if (tiles_[tile]) {
        return *tiles_[tile];
    }
    Tile& of = *(tiles_[tile] = std::make_unique<Tile>());
    held_.set(held_.bytes() + sizeof(Tile) + allocation_bytes);
    of.keyframe_made = now_;
    if (!previous_ || !previous_->tiles_[tile]) {
        return of; // no viewer has the base of a delta, so a keyframe is needed
    }
    const Tile& before = *previous_->tiles_[tile];
    const codec::QuantisedView here = view(tile);
    // If the next snapshot would come after the keyframe interval, this one is the keyframe for all viewers. Its
    // displacements are 0: real displacements would add more bytes than they save in the next delta.
    const bool keyframe_due = now_ + between_ > before.keyframe_made + keyframe_interval;
    if (keyframe_due || !codec::follows(here, previous_->view(tile))) {
        return of;
    }
    const codec::Counts begin = counts_before(tile), count = counts(tile);
    using Part = codec::AdvancedColumns::Displacements;
    const codec::AdvancedColumns advanced{.organisms = part_of<Part>(organisms_, begin[organisms], count[organisms]),
                                          .crates = part_of<Part>(crates_, begin[crates], count[crates])};
    of.ticks = ticks_ > 0 ? ticks_ : before.ticks;
    of.delta = codec::encode_delta(previous_->baseline(tile), here, ticks_, &advanced, &of.delta_seams);
    of.base_sequence = previous_->sequence();
    of.keyframe_made = before.keyframe_made;
    held_.set(held_.bytes() + of.delta.capacity() + allocation_bytes);
    return of;
}

codec::QuantisedView StreamedSnapshot::view(std::uint32_t tile) const {
    return form_ == Form::Tiles ? island_->full(tile) : codec::QuantisedView{island_->snapshot()};
}

codec::Counts StreamedSnapshot::counts_before(std::uint32_t tile) const {
    if (form_ == Form::Tiles) {
        return island_->tiles().counts_before(tile);
    }
    return tile == 0 ? codec::Counts{} : codec::counts_of(island_->snapshot());
}

codec::Counts StreamedSnapshot::counts(std::uint32_t tile) const {
    return form_ == Form::Tiles ? island_->tiles().counts(tile) : codec::counts_of(island_->snapshot());
}

codec::BaselineView StreamedSnapshot::baseline(std::uint32_t tile) const {
    const codec::Counts begin = counts_before(tile), count = counts(tile);
    using Part = codec::BaselineView::Displacements;
    codec::BaselineView baseline;
    baseline.snapshot = view(tile);
    baseline.organisms = part_of<Part>(organisms_, begin[organisms], count[organisms]);
    baseline.crates = part_of<Part>(crates_, begin[crates], count[crates]);
    baseline.ticks = tiles_[tile]->ticks;
    return baseline;
}

void SentState::add_parts(StreamedSnapshot& snapshot, const codec::TileRange& seen, v1::Detail detail,
                          v1::Compression compression, std::vector<const SharedBytes*>& parts) const {
    if (const SharedBytes* const head = snapshot.head()) {
        parts.push_back(head);
    }
    const std::uint32_t columns = snapshot.layout().columns;
    for (std::uint32_t row = seen.row_begin; row < seen.row_end; ++row) {
        const bool has_row = row >= full_.row_begin && row < full_.row_end;
        for (std::uint32_t column = seen.column_begin; column < seen.column_end; ++column) {
            const bool has = has_row && column >= full_.column_begin && column < full_.column_end;
            parts.push_back(&snapshot.tile(row * columns + column, detail, compression, has ? sequence_ : 0));
        }
    }
}

void SentState::sent(const StreamedSnapshot& snapshot, const codec::TileRange& seen, v1::Detail detail) {
    sequence_ = snapshot.sequence();
    full_ = detail == v1::DETAIL_FULL ? seen : codec::TileRange{};
}

} // namespace evod::streaming
