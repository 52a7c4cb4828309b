// Every SnapshotFrame of CODEC_PLAIN is decoded or refused; what is decoded is valid.
#include "tests/fuzz/valid_snapshot.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    evod::v1::SnapshotFrame frame;
    if (!frame.ParseFromArray(data, static_cast<int>(size))) {
        return 0;
    }
    const auto snapshot = evod::codec::decode_plain(std::move(frame));
    if (snapshot) {
        evod::fuzz::require_valid(*snapshot);
    } else {
        evod::fuzz::require(!snapshot.error().what.empty());
    }
    return 0;
}
