// One decoder decodes or refuses every sequence of SnapshotFrames; what is decoded is valid.
//
// The input consists of frames, whole or in tiles, each after its length in two bytes. Checksums are corrected, because
// random input would hardly ever contain a right one.
#include "proto/codec/little_endian.h"
#include "proto/codec/snapshot_decoder.h"
#include "tests/fuzz/valid_snapshot.h"

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
        const auto snapshot = decoder.decode(std::move(frame));
        if (!snapshot) {
            evod::fuzz::require(!snapshot.error().what.empty());
            continue;
        }
        evod::fuzz::require_valid(*snapshot);
    }
    return 0;
}
