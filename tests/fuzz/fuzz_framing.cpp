// Any bytes, cut anywhere, give the same frames and the same end; what a frame holds is parsed as both ends would.
#include "proto/wire/framing.h"

#include "evod/v1/session.pb.h"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

struct Outcome {
    std::vector<std::string> frames;
    std::string damage;
    friend bool operator==(const Outcome&, const Outcome&) = default;
};

Outcome read(std::span<const std::byte> bytes, std::size_t chunk_bytes) {
    using namespace evod::wire;
    Outcome outcome;
    FrameReader reader{client_limits};
    while (!bytes.empty()) {
        const std::size_t length = std::min(chunk_bytes, bytes.size());
        reader.feed(bytes.first(length));
        bytes = bytes.subspan(length);
        for (;;) {
            const auto frame = reader.next();
            if (!frame) {
                outcome.damage = frame.error().what;
                return outcome;
            }
            if (!*frame) {
                break;
            }
            const auto body = (*frame)->body;
            outcome.frames.emplace_back(reinterpret_cast<const char*>(body.data()), body.size());
        }
    }
    return outcome;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) {
        return 0;
    }
    const auto bytes = std::as_bytes(std::span{data, size}).subspan(1);
    const Outcome whole = read(bytes, bytes.size() + 1);
    if (whole != read(bytes, 1 + data[0] % 16)) {
        std::abort();
    }
    for (const std::string& body : whole.frames) {
        (void)evod::wire::parse_body<evod::v1::ClientMessage>(std::as_bytes(std::span{body}));
        (void)evod::wire::parse_body<evod::v1::ServerMessage>(std::as_bytes(std::span{body}));
    }
    return 0;
}
