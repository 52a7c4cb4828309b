#include "server/network/chains.h"

#include <limits>
#include <utility>

namespace evod::network {

ChainPicture::ChainPicture(v1::SnapshotFrame about, std::shared_ptr<const wire::Scene> scene,
                           wire::Compressor& compressor)
    : about_{std::move(about)}
    , footing_{std::make_shared<const wire::Footing>(wire::standing(std::move(scene)))}
    , compressor_{&compressor} {
    about_.clear_body();
    about_.set_codec(v1::CODEC_DELTA);
}

ChainPicturePtr ChainPicture::next(v1::SnapshotFrame about, std::shared_ptr<const wire::Scene> scene,
                                   bool with_delta) const {
    // Another life, time turned back, or too much of it: nothing can be foretold.
    const bool goes_on =
        wire::same_unchanging(about, about_) && about.generation() == about_.generation() &&
        about.generation_tick() >= about_.generation_tick() &&
        about.generation_tick() - about_.generation_tick() <= std::numeric_limits<std::uint16_t>::max() &&
        wire::follows(*scene, *footing_->scene);
    const auto ticks =
        goes_on ? static_cast<std::uint16_t>(about.generation_tick() - about_.generation_tick()) : std::uint16_t{0};
    auto picture = std::make_shared<ChainPicture>(std::move(about), scene, *compressor_);
    if (!goes_on)
        return picture;
    picture->footing_ = std::make_shared<const wire::Footing>(wire::moved_on(*footing_, std::move(scene), ticks));
    if (with_delta) {
        picture->base_ = footing_;
        picture->base_sequence_ = sequence();
        picture->ticks_ = ticks;
    }
    return picture;
}

const SharedBytes& ChainPicture::keyframe(v1::Compression compression) {
    return form(keyframe_, compression, false);
}

const SharedBytes& ChainPicture::delta(v1::Compression compression) {
    return form(delta_, compression, true);
}

std::string ChainPicture::body(bool as_delta) const {
    return as_delta ? wire::encode_delta(*base_, *footing_->scene, ticks_) : wire::encode_keyframe(*footing_);
}

const SharedBytes& ChainPicture::form(Forms& forms, v1::Compression compression, bool as_delta) {
    const bool compressed = compression == v1::COMPRESSION_ZSTD;
    SharedBytes& bytes = forms[compressed ? 1 : 0];
    if (bytes)
        return bytes;
    v1::SnapshotFrame frame = about_;
    if (as_delta) {
        frame.set_base_sequence(base_sequence_);
        wire::leave_out_unchanging(frame);
    }
    std::string whole = body(as_delta);
    frame.set_checksum(wire::checksum_of(frame, whole));
    if (compressed) {
        std::string shorter = compressor_->compress(whole);
        if (shorter.size() < whole.size()) {
            whole = std::move(shorter);
            frame.set_compression(v1::COMPRESSION_ZSTD);
        }
    }
    frame.set_body(std::move(whole));
    return bytes = std::make_shared<const std::string>(frame.SerializeAsString());
}

ChainPicturePtr Chain::add(v1::SnapshotFrame about, std::shared_ptr<const wire::Scene> scene,
                           wire::Compressor& compressor, runtime::Clock::time_point now,
                           runtime::Clock::duration between) {
    // The next picture would come too late to be the keyframe.
    const bool keyframe_due = now + between > keyframe_made_ + keyframe_interval;
    latest_ = latest_ ? latest_->next(std::move(about), std::move(scene), !keyframe_due)
                      : std::make_shared<ChainPicture>(std::move(about), std::move(scene), compressor);
    if (latest_->base_sequence() == 0)
        keyframe_made_ = now;
    return latest_;
}

} // namespace evod::network
