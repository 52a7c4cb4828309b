#include "server/network/chains.h"

#include <limits>
#include <utility>

namespace evod::network {

std::optional<std::uint16_t> ticks_between(const v1::SnapshotFrame& before, const v1::SnapshotFrame& after) {
    if (!wire::same_unchanging(after, before) || after.generation() != before.generation() ||
        after.generation_tick() < before.generation_tick() ||
        after.generation_tick() - before.generation_tick() > std::numeric_limits<std::uint16_t>::max())
        return std::nullopt;
    return static_cast<std::uint16_t>(after.generation_tick() - before.generation_tick());
}

ChainPicture::ChainPicture(AboutPtr about, std::shared_ptr<const wire::Scene> scene, wire::Compressor& compressor)
    : about_{std::move(about)}
    , footing_{std::make_shared<const wire::Footing>(wire::standing(std::move(scene)))}
    , compressor_{&compressor} {}

ChainPicturePtr ChainPicture::next(AboutPtr about, std::shared_ptr<const wire::Scene> scene, bool with_delta) const {
    const auto ticks = ticks_between(*about_, *about);
    const bool goes_on = ticks && wire::follows(*scene, *footing_->scene);
    auto picture = std::make_shared<ChainPicture>(std::move(about), scene, *compressor_);
    if (!goes_on || !with_delta)
        return picture;
    // What stayed is paired once for both: the next footing, and the delta, which whoever keeps up is sent.
    auto footing = std::make_shared<wire::Footing>(wire::standing(std::move(scene)));
    footing->ticks = *ticks > 0 ? *ticks : footing_->ticks;
    const wire::MovedOn moved{.organisms = {footing->organisms.x, footing->organisms.y},
                              .crates = {footing->crates.x, footing->crates.y}};
    picture->delta_body_ = wire::encode_delta(*footing_, *footing->scene, *ticks, &moved, &picture->delta_seams_);
    picture->footing_ = std::move(footing);
    picture->base_sequence_ = sequence();
    return picture;
}

const SharedBytes& ChainPicture::form(Forms& forms, v1::Compression compression, bool as_delta) {
    SharedBytes& bytes = forms[compression == v1::COMPRESSION_ZSTD ? 1 : 0];
    if (bytes)
        return bytes;
    v1::SnapshotFrame frame = *about_;
    frame.set_codec(v1::CODEC_DELTA);
    if (as_delta) {
        frame.set_base_sequence(base_sequence_);
        wire::leave_out_unchanging(frame);
    }
    wire::Seams seams;
    std::string body;
    if (as_delta) {
        body = delta_body_;
        seams = delta_seams_;
    } else {
        body = wire::encode_keyframe(*footing_, &seams);
    }
    frame.set_checksum(wire::checksum_of(frame, body));
    set_body(frame, std::move(body), seams, compression, *compressor_);
    return bytes = std::make_shared<const std::string>(frame.SerializeAsString());
}

const ChainPicturePtr& Chain::add(AboutPtr about, std::shared_ptr<const wire::Scene> scene,
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
