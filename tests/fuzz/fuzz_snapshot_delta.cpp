// Any SnapshotFrames, one after another, are decoded or refused by one decoder; what is decoded is sound.
//
// The input is frames, whole or in tiles, each behind its length in two bytes. Checksums are put right, for chance
// would find none.
#include "proto/codec/little_endian.h"
#include "proto/codec/snapshot_decoder.h"
#include "tests/fuzz/sound_picture.h"

#include <algorithm>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    evod::codec::SnapshotDecoder decoder;
    while (size >= 2) {
        const std::size_t length = std::min<std::size_t>(evod::codec::load<std::uint16_t>(data), size - 2);
        evod::v1::SnapshotFrame frame;
        if (!frame.ParseFromArray(data + 2, static_cast<int>(length))) {
            return 0;
        }
        data += 2 + length;
        size -= 2 + length;
        if (frame.compression() != evod::v1::COMPRESSION_ZSTD) {
            frame.set_checksum(evod::codec::checksum_of(frame, frame.body()));
        }
        for (auto& tile : *frame.mutable_tiles()) {
            if (tile.compression() != evod::v1::COMPRESSION_ZSTD) {
                tile.set_checksum(evod::codec::checksum_of(frame.tile_px(), frame.position_bytes(), tile, tile.body()));
            }
        }
        const auto picture = decoder.decode(std::move(frame));
        if (!picture) {
            evod::fuzz::require(!picture.error().what.empty());
            continue;
        }
        evod::fuzz::require_sound(*picture);
    }
    return 0;
}
