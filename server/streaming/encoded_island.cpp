#include "server/streaming/encoded_island.h"

#include "proto/codec/delta_codec.h"
#include "proto/codec/snapshot_codec.h"
#include "server/protocol/events.h"
#include "server/protocol/worlds.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/wire_format_lite.h>

#include <string>
#include <utility>

namespace evod::streaming {
namespace {

using google::protobuf::internal::WireFormatLite;
using google::protobuf::io::CodedOutputStream;

/// Appends the tag and the length of a field whose content has `bytes` bytes. The caller appends the content itself, so
/// that it is copied only once.
void append_field_head(int number, std::size_t bytes, std::string& to) {
    std::array<std::uint8_t, 10> head; // the tag and the length are varints of at most five bytes each
    std::uint8_t* end = WireFormatLite::WriteTagToArray(number, WireFormatLite::WIRETYPE_LENGTH_DELIMITED, head.data());
    end = CodedOutputStream::WriteVarint32ToArray(static_cast<std::uint32_t>(bytes), end);
    to.append(reinterpret_cast<const char*>(head.data()), static_cast<std::size_t>(end - head.data()));
}

/// Size of a field whose content has `bytes` bytes: tag, length and content.
std::size_t field_bytes(int number, std::size_t bytes) {
    return WireFormatLite::TagSize(number, WireFormatLite::TYPE_BYTES) + WireFormatLite::LengthDelimitedSize(bytes);
}

/// Returns the body as it is sent. It is compressed if the subscription wants compression and the result is shorter;
/// then message.compression is set.
///
/// message     a SnapshotFrame or a SnapshotTile.
/// compressed  buffer for the compressed body.
template <class Message>
std::string_view body_to_send(Message& message, std::string_view body, const codec::Seams& seams,
                              v1::Compression compression, codec::Compressor& compressor, std::string& compressed) {
    if (compression != v1::COMPRESSION_ZSTD) {
        return body;
    }
    compressed = compressor.compress(body, seams);
    if (compressed.size() >= body.size()) {
        return body;
    }
    message.set_compression(v1::COMPRESSION_ZSTD);
    return compressed;
}

/// Memory of the fields that describe an island, with their texts and messages.
constexpr std::size_t about_bytes = sizeof(v1::SnapshotFrame) + sizeof(v1::LiveStatistics) + sizeof(v1::Speed) + 400;

} // namespace

v1::SnapshotFrame frame_without_entities(const runtime::Snapshot& snapshot, const runtime::IslandSnapshot& island) {
    v1::SnapshotFrame frame;
    frame.set_world(snapshot.world);
    frame.set_run_id(to_bytes(snapshot.run_id));
    frame.set_island(island.island);
    frame.set_island_count(snapshot.island_count);
    frame.set_width_px(island.width_px);
    frame.set_height_px(island.height_px);
    frame.set_tick(snapshot.moment.tick);
    frame.set_generation(snapshot.moment.generation);
    frame.set_generation_tick(snapshot.moment.generation_tick);
    frame.set_simulated_s(snapshot.moment.simulated_s);
    frame.set_state(protocol::to_proto(snapshot.state));
    *frame.mutable_speed() = protocol::to_proto(snapshot.speed);
    frame.set_state_hash(base::to_bytes(snapshot.hash));
    frame.set_item_radius_px(snapshot.item_radius_px);
    simulation::LiveStatistics live = island.live;
    live.health_mean = simulation::mean_health(island.organisms.health, island.organisms.alive_count);
    *frame.mutable_live() = protocol::to_proto(live, island.island);
    frame.set_ticks_per_s(snapshot.ticks_per_s);
    frame.set_slowed(snapshot.slowed);
    return frame;
}

EncodedIsland::EncodedIsland(v1::SnapshotFrame about, codec::QuantisedSnapshot snapshot, codec::Compressor& compressor,
                             SnapshotMemory* memory)
    : snapshot_{std::make_shared<const codec::QuantisedSnapshot>(std::move(snapshot))}
    , about_{std::move(about)}
    , compressor_{&compressor}
    , held_{memory} {
    codec::describe(*snapshot_, about_);
    count_memory();
}

void EncodedIsland::count_memory() {
    std::size_t bytes = sizeof(EncodedIsland) - sizeof(v1::SnapshotFrame) + about_bytes +
                        sizeof(codec::QuantisedSnapshot) + 2 * allocation_bytes;
    for (const auto part : codec::snapshot_parts) {
        const codec::Entities& of = (*snapshot_).*part;
        for (const codec::Column* column : {&of.id, &of.x, &of.y, &of.width, &of.height, &of.heading, &of.species}) {
            bytes += column->empty() ? 0 : column->size() * sizeof(std::uint32_t) + allocation_bytes;
        }
    }
    held_.set(bytes + (tiles_ ? tiles_->held_bytes() : 0) + coarse_.size() * sizeof(coarse_[0]));
}

const SharedBytes& EncodedIsland::keep(SharedBytes& place, std::string bytes) {
    place = counted(std::move(bytes), memory());
    kept_encoding_bytes_ += bytes_of(place);
    return place;
}

codec::SnapshotTiles& EncodedIsland::tiles() {
    if (!tiles_) {
        tiles_.emplace(snapshot_, codec::tile_layout(about_.width_px(), about_.height_px()));
        count_memory();
    }
    return *tiles_;
}

codec::QuantisedView EncodedIsland::full(std::uint32_t tile) {
    const std::size_t before = tiles().held_bytes();
    const codec::QuantisedView view = tiles_->full(tile);
    if (tiles_->held_bytes() != before) {
        count_memory();
    }
    return view;
}

const SharedBytes& EncodedIsland::plain() {
    if (!plain_) {
        v1::SnapshotFrame frame = about_;
        codec::encode_plain(*snapshot_, frame);
        keep(plain_, frame.SerializeAsString());
    }
    return plain_;
}

v1::SnapshotFrame EncodedIsland::delta_frame() const {
    v1::SnapshotFrame frame = about_;
    frame.set_codec(v1::CODEC_DELTA);
    return frame;
}

SharedBytes EncodedIsland::whole(std::uint64_t base_sequence, std::string_view body, const codec::Seams& seams,
                                 v1::Compression compression) {
    v1::SnapshotFrame frame = delta_frame();
    if (base_sequence != 0) {
        frame.set_base_sequence(base_sequence);
        codec::clear_unchanging(frame);
    }
    frame.set_checksum(codec::checksum_of(frame, body));
    std::string compressed;
    const std::string_view sent = body_to_send(frame, body, seams, compression, *compressor_, compressed);
    std::string bytes;
    bytes.reserve(frame.ByteSizeLong() + field_bytes(v1::SnapshotFrame::kBodyFieldNumber, sent.size()));
    frame.AppendToString(&bytes);
    append_field_head(v1::SnapshotFrame::kBodyFieldNumber, sent.size(), bytes);
    bytes += sent;
    return counted(std::move(bytes), memory());
}

const SharedBytes& EncodedIsland::without_tiles() {
    if (!without_tiles_) {
        v1::SnapshotFrame frame = delta_frame();
        frame.set_tile_px(tiles().layout().tile_px);
        keep(without_tiles_, frame.SerializeAsString());
    }
    return without_tiles_;
}

std::string EncodedIsland::encode_tile(v1::SnapshotTile tile, std::string_view body, const codec::Seams& seams,
                                       v1::Compression compression) {
    codec::set_counts(tiles().counts(tile.tile()), tile);
    tile.set_sequence(about_.sequence());
    tile.set_checksum(codec::checksum_of(tiles().layout().tile_px, about_.position_bytes(), tile, body));
    std::string compressed;
    const std::string_view sent = body_to_send(tile, body, seams, compression, *compressor_, compressed);
    const std::size_t bytes = tile.ByteSizeLong() + field_bytes(v1::SnapshotTile::kBodyFieldNumber, sent.size());
    std::string field;
    field.reserve(field_bytes(v1::SnapshotFrame::kTilesFieldNumber, bytes));
    append_field_head(v1::SnapshotFrame::kTilesFieldNumber, bytes, field);
    tile.AppendToString(&field);
    append_field_head(v1::SnapshotTile::kBodyFieldNumber, sent.size(), field);
    field += sent;
    return field;
}

SharedBytes EncodedIsland::full_tile(std::uint32_t tile, std::uint64_t base_sequence, std::string_view body,
                                     const codec::Seams& seams, v1::Compression compression) {
    v1::SnapshotTile message;
    message.set_tile(tile);
    message.set_detail(v1::DETAIL_FULL);
    message.set_base_sequence(base_sequence);
    return counted(encode_tile(std::move(message), body, seams, compression), memory());
}

const SharedBytes& EncodedIsland::coarse_tile(std::uint32_t tile, v1::Detail detail, v1::Compression compression) {
    if (coarse_.empty()) {
        coarse_.resize(tiles().layout().count());
        count_memory();
    }
    const bool dots = detail == v1::DETAIL_DOTS;
    SharedBytes& bytes = coarse_[tile][(dots ? 0 : 2) + (compression == v1::COMPRESSION_ZSTD ? 1 : 0)];
    if (!bytes) {
        v1::SnapshotTile message;
        message.set_tile(tile);
        message.set_detail(detail);
        keep(bytes,
             encode_tile(std::move(message), dots ? tiles().dots(tile) : tiles().density(tile), {}, compression));
    }
    return bytes;
}

} // namespace evod::streaming
