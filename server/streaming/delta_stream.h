// Chains: the pictures of an island at one rate, each told from the one before, for whoever takes deltas.
//
// A delta is made with its picture, for whoever keeps up is sent it; any other form when the first session asks for it.
// Each is made once, and the sessions share the bytes. All viewers of a world at one rate are shown the same pictures,
// so that what is a delta for one is a delta for all.
//
// Owner        Streams; a DeltaSnapshot lives as long as a session is to send it.
// Threads      the network thread.
#pragma once

#include "proto/codec/compression.h"
#include "proto/codec/delta_codec.h"
#include "proto/codec/shared_bytes.h"
#include "server/runtime/clock.h"

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace evod::streaming {

using codec::SharedBytes;

/// Everybody takes a keyframe at least so often, if there are pictures.
constexpr std::chrono::seconds keyframe_interval{2};

/// A frame but for what is in it; immutable.
using AboutPtr = std::shared_ptr<const v1::SnapshotFrame>;

/// The ticks from one picture to the next; nullopt: another life, time turned back, or too much of it: nothing can be
/// foretold.
std::optional<std::uint16_t> ticks_between(const v1::SnapshotFrame& before, const v1::SnapshotFrame& after);

/// One picture of a chain, in every form in which it is sent: fields 1 to 49 of a SnapshotFrame.
class DeltaSnapshot {
  public:
    /// about       what the codec says of it is set here.
    /// scene       its entities, of which nothing has moved yet; or with the way they came.
    /// compressor  there as long as forms of the picture are asked for.
    DeltaSnapshot(AboutPtr about, std::shared_ptr<const codec::QuantisedSnapshot> scene, codec::Compressor& compressor)
        : DeltaSnapshot{std::move(about), codec::initial_baseline(std::move(scene)), compressor} {}
    DeltaSnapshot(AboutPtr about, codec::Baseline baseline, codec::Compressor& compressor)
        : about_{std::move(about)}, baseline_{std::move(baseline)}, compressor_{&compressor} {}

    /// The picture after this one. with_delta: it may be told as a delta; otherwise it is a keyframe for all, and
    /// nothing has moved yet: displacements would take more bytes in it than they save in the delta after it.
    std::shared_ptr<DeltaSnapshot> next(AboutPtr about, std::shared_ptr<const codec::QuantisedSnapshot> scene,
                                        bool with_delta) const;

    std::uint64_t sequence() const { return about_->sequence(); }
    /// Who was sent that picture last can take the delta; 0: there is none.
    std::uint64_t base_sequence() const { return base_sequence_; }

    /// As it is told to somebody who was sent that picture last; 0: none.
    const SharedBytes& after(std::uint64_t sequence_sent, v1::Compression compression) {
        return sequence_sent != 0 && sequence_sent == base_sequence_ ? delta(compression) : keyframe(compression);
    }
    const SharedBytes& keyframe(v1::Compression compression) { return form(keyframe_, compression, false); }
    const SharedBytes& delta(v1::Compression compression) { return form(delta_, compression, true); }

  private:
    using Forms = std::array<SharedBytes, 2>; // as it is, compressed
    const SharedBytes& form(Forms& forms, v1::Compression compression, bool as_delta);

    AboutPtr about_;
    codec::Baseline baseline_;
    std::uint64_t base_sequence_ = 0;
    std::string delta_body_; // if there is one
    codec::Seams delta_seams_;
    codec::Compressor* compressor_;
    Forms keyframe_, delta_;
};

using DeltaSnapshotPtr = std::shared_ptr<DeltaSnapshot>;

/// The pictures of one island at one rate.
class DeltaStream {
  public:
    /// between  how long it usually is to the next picture.
    const DeltaSnapshotPtr& add(AboutPtr about, std::shared_ptr<const codec::QuantisedSnapshot> scene,
                                codec::Compressor& compressor, runtime::Clock::time_point now,
                                runtime::Clock::duration between);

    /// Null before the first.
    const DeltaSnapshotPtr& latest() const { return latest_; }

  private:
    DeltaSnapshotPtr latest_;
    runtime::Clock::time_point keyframe_made_; // the last that was one for all
};

/// A body as it is sent: compressed, if that is asked for and makes it shorter; then the message is told so.
///
/// message     a SnapshotFrame or a SnapshotTile.
/// compressed  what the answer is a view of in that case.
template <class Message>
std::string_view sent_body(Message& message, std::string_view body, const codec::Seams& seams,
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

/// What a field of bytes begins with, added to a message that lies there serialized: what is long, as a body is, is
/// then copied once only, when it is added itself.
void append_field_head(int number, std::size_t bytes, std::string& to);
/// Of that head and the bytes.
std::size_t field_bytes(int number, std::size_t bytes);

} // namespace evod::streaming
