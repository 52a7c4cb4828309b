// Viewer: one subscription at the far end of a connection. Receives frames and decodes them.
#pragma once

#include "proto/codec/snapshot_decoder.h"
#include "server/streaming/delta_stream.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace evod::streaming {

class Viewer {
  public:
    explicit Viewer(v1::Compression compression = v1::COMPRESSION_NONE) : compression_{compression} {}

    /// The frame that this viewer is sent. It is not decoded.
    v1::SnapshotFrame send(StreamedSnapshot& snapshot, const codec::TileRange& seen,
                           v1::Detail detail = v1::DETAIL_FULL) {
        std::vector<const SharedBytes*> parts;
        sent_.add_parts(snapshot, seen, detail, compression_, parts);
        sent_.sent(snapshot, seen, detail);
        std::string bytes;
        for (const SharedBytes* part : parts) {
            bytes += **part;
        }
        v1::SnapshotFrame frame;
        EXPECT_TRUE(frame.ParseFromString(bytes));
        return frame;
    }
    v1::SnapshotFrame send(StreamedSnapshot& snapshot) { return send(snapshot, codec::tiles_of(snapshot.layout())); }

    codec::Result<codec::ReceivedSnapshot> watch(StreamedSnapshot& snapshot, const codec::TileRange& seen,
                                                 v1::Detail detail = v1::DETAIL_FULL) {
        return decoder_.decode(send(snapshot, seen, detail));
    }
    codec::Result<codec::ReceivedSnapshot> watch(StreamedSnapshot& snapshot) { return decoder_.decode(send(snapshot)); }
    codec::Result<codec::ReceivedSnapshot> decode(v1::SnapshotFrame frame) { return decoder_.decode(std::move(frame)); }

    void request_keyframe() { sent_.reset(); }
    const codec::QuantisedSnapshot* snapshot() const { return decoder_.snapshot(); }
    bool needs_keyframe() const { return decoder_.needs_keyframe(); }

  private:
    v1::Compression compression_;
    SentState sent_;
    codec::SnapshotDecoder decoder_;
};

} // namespace evod::streaming
