// Any SnapshotFrame is decoded or refused; what is decoded is sound.
#include "tests/fuzz/sound_picture.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    evod::v1::SnapshotFrame frame;
    if (!frame.ParseFromArray(data, static_cast<int>(size))) {
        return 0;
    }
    const auto picture = evod::codec::decode(std::move(frame));
    if (picture) {
        evod::fuzz::require_sound(*picture);
    } else {
        evod::fuzz::require(!picture.error().what.empty());
    }
    return 0;
}
