#include "server/streaming/delta_stream.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/wire_format_lite.h>

#include <limits>
#include <utility>

namespace evod::streaming {

std::optional<std::uint16_t> ticks_between(const v1::SnapshotFrame& before, const v1::SnapshotFrame& after) {
    if (!codec::same_unchanging(after, before) || after.generation() != before.generation() ||
        after.generation_tick() < before.generation_tick() ||
        after.generation_tick() - before.generation_tick() > std::numeric_limits<std::uint16_t>::max()) {
        return std::nullopt;
    }
    return static_cast<std::uint16_t>(after.generation_tick() - before.generation_tick());
}

DeltaSnapshotPtr DeltaSnapshot::next(AboutPtr about, std::shared_ptr<const codec::QuantisedSnapshot> scene,
                                     bool with_delta) const {
    const auto ticks = ticks_between(*about_, *about);
    if (!ticks || !with_delta || !codec::follows(*scene, *baseline_.scene)) {
        return std::make_shared<DeltaSnapshot>(std::move(about), std::move(scene), *compressor_);
    }
    // What stayed is paired once for both: the next baseline, and the delta, which whoever keeps up is sent.
    codec::Baseline baseline = codec::initial_baseline(std::move(scene));
    baseline.ticks = *ticks > 0 ? *ticks : baseline_.ticks;
    const codec::AdvancedColumns moved{.organisms = {baseline.organisms.x, baseline.organisms.y},
                                       .crates = {baseline.crates.x, baseline.crates.y}};
    codec::Seams seams;
    std::string delta = codec::encode_delta(baseline_, *baseline.scene, *ticks, &moved, &seams);
    auto picture = std::make_shared<DeltaSnapshot>(std::move(about), std::move(baseline), *compressor_);
    picture->delta_body_ = std::move(delta);
    picture->delta_seams_ = std::move(seams);
    picture->base_sequence_ = sequence();
    return picture;
}

const SharedBytes& DeltaSnapshot::form(Forms& forms, v1::Compression compression, bool as_delta) {
    SharedBytes& bytes = forms[compression == v1::COMPRESSION_ZSTD ? 1 : 0];
    if (bytes) {
        return bytes;
    }
    v1::SnapshotFrame frame = *about_;
    frame.set_codec(v1::CODEC_DELTA);
    if (as_delta) {
        frame.set_base_sequence(base_sequence_);
        codec::leave_out_unchanging(frame);
    }
    codec::Seams keyframe_seams;
    const std::string keyframe = as_delta ? "" : codec::encode_keyframe(baseline_, &keyframe_seams);
    const std::string& body = as_delta ? delta_body_ : keyframe;
    frame.set_checksum(codec::checksum_of(frame, body));
    std::string compressed;
    const std::string_view sent =
        sent_body(frame, body, as_delta ? delta_seams_ : keyframe_seams, compression, *compressor_, compressed);
    std::string made;
    made.reserve(frame.ByteSizeLong() + field_bytes(v1::SnapshotFrame::kBodyFieldNumber, sent.size()));
    frame.AppendToString(&made);
    append_field_head(v1::SnapshotFrame::kBodyFieldNumber, sent.size(), made);
    made += sent;
    return bytes = std::make_shared<const std::string>(std::move(made));
}

const DeltaSnapshotPtr& DeltaStream::add(AboutPtr about, std::shared_ptr<const codec::QuantisedSnapshot> scene,
                                         codec::Compressor& compressor, runtime::Clock::time_point now,
                                         runtime::Clock::duration between) {
    // The next picture would come too late to be the keyframe.
    const bool keyframe_due = now + between > keyframe_made_ + keyframe_interval;
    latest_ = latest_ ? latest_->next(std::move(about), std::move(scene), !keyframe_due)
                      : std::make_shared<DeltaSnapshot>(std::move(about), std::move(scene), compressor);
    if (latest_->base_sequence() == 0) {
        keyframe_made_ = now;
    }
    return latest_;
}

using google::protobuf::internal::WireFormatLite;
using google::protobuf::io::CodedOutputStream;

void append_field_head(int number, std::size_t bytes, std::string& to) {
    std::array<std::uint8_t, 10> head; // two numbers of at most five bytes each
    std::uint8_t* end = WireFormatLite::WriteTagToArray(number, WireFormatLite::WIRETYPE_LENGTH_DELIMITED, head.data());
    end = CodedOutputStream::WriteVarint32ToArray(static_cast<std::uint32_t>(bytes), end);
    to.append(reinterpret_cast<const char*>(head.data()), static_cast<std::size_t>(end - head.data()));
}

std::size_t field_bytes(int number, std::size_t bytes) {
    return WireFormatLite::TagSize(number, WireFormatLite::TYPE_BYTES) + WireFormatLite::LengthDelimitedSize(bytes);
}

} // namespace evod::streaming
