// Framing: any bytes, cut in any way, give the same frames and the same damage. The content of a frame is parsed as
// both ends parse it.
//
// The first byte selects the limits. The bytes themselves select the cuts; short inputs are also cut at every byte. One
// input in 32, selected the same way, is cut in every way: up to 8 bytes in all 2^(n-1) ways; up to 16, which is a
// header, a body and the beginning of the next frame, at all pairs of places; up to 64 at each place.
#include "proto/codec/framing.h"

#include "evod/v1/session.pb.h"
#include "evod/v1/stream.pb.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace {

using namespace evod::codec;
using Bytes = std::span<const std::byte>;

void require(bool holds) {
    if (!holds) {
        std::abort();
    }
}

/// A frame that ends at `end`; its body is the last body_bytes before that.
struct Found {
    Channel channel;
    std::size_t end, body_bytes;
};

/// The result of reading all bytes at once.
struct Whole {
    std::vector<Found> frames;
    std::string damage; // empty: none
};

Whole read_whole(Bytes bytes, const FrameLimits& limits) {
    Whole whole;
    FrameReader reader{limits};
    reader.feed(bytes);
    for (;;) {
        const auto frame = reader.next();
        if (!frame) {
            whole.damage = frame.error().what;
            require(!whole.damage.empty());
            return whole;
        }
        if (!*frame) {
            return whole;
        }
        whole.frames.push_back({(*frame)->channel, bytes.size() - reader.buffered_bytes(), (*frame)->body.size()});
    }
}

/// The same bytes in pieces. Each frame must be returned as soon as its last byte is fed; the damage must be the same.
class InPieces {
  public:
    InPieces(Bytes bytes, const FrameLimits& limits, const Whole& whole)
        : bytes_{bytes}, whole_{whole}, reader_{limits} {}

    /// Feeds the piece that ends at offset `cut`.
    void feed_to(std::size_t cut) {
        reader_.feed(bytes_.subspan(fed_, cut - fed_));
        fed_ = cut;
        for (;;) {
            const auto frame = reader_.next();
            if (!frame) {
                damage_ = frame.error().what;
                return;
            }
            if (!*frame) {
                break;
            }
            require(next_ < whole_.frames.size());
            const Found& expected = whole_.frames[next_++];
            const auto body = (*frame)->body;
            require((*frame)->channel == expected.channel && body.size() == expected.body_bytes &&
                    std::memcmp(body.data(), bytes_.data() + expected.end - body.size(), body.size()) == 0);
        }
        require(next_ == whole_.frames.size() || whole_.frames[next_].end > fed_);
    }
    void finish() {
        feed_to(bytes_.size());
        require(next_ == whole_.frames.size() && damage_ == whole_.damage);
    }

  private:
    const Bytes bytes_;
    const Whole& whole_;
    FrameReader reader_;
    std::size_t fed_ = 0, next_ = 0;
    std::string damage_;
};

void cut_in_every_way(Bytes bytes, const FrameLimits& limits, const Whole& whole) {
    const std::size_t size = bytes.size();
    if (size <= 8) {
        for (std::uint32_t cuts = 0; size > 0 && cuts < 1u << (size - 1); ++cuts) {
            InPieces pieces{bytes, limits, whole};
            for (std::size_t at = 1; at < size; ++at) {
                if ((cuts >> (at - 1) & 1) != 0) {
                    pieces.feed_to(at);
                }
            }
            pieces.finish();
        }
        return;
    }
    for (std::size_t first = 1; size <= 64 && first < size; ++first) {
        for (std::size_t second = first; second < (size <= 16 ? size : first + 1); ++second) {
            InPieces pieces{bytes, limits, whole};
            pieces.feed_to(first);
            pieces.feed_to(second); // an empty piece if it equals the first
            pieces.finish();
        }
    }
}

/// next_length  returns the length of the next piece, at least 1.
void cut_by(Bytes bytes, const FrameLimits& limits, const Whole& whole, auto next_length) {
    InPieces pieces{bytes, limits, whole};
    for (std::size_t at = 0; at < bytes.size();) {
        at = std::min(bytes.size(), at + next_length());
        pieces.feed_to(at);
    }
    pieces.finish();
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) {
        return 0;
    }
    constexpr FrameLimits limits_of[] = {hello_limits, server_limits, client_limits};
    const FrameLimits& limits = limits_of[data[0] % std::size(limits_of)];
    const Bytes bytes = std::as_bytes(std::span{data, size}).subspan(1);
    std::uint32_t draw = data[0];
    for (const std::byte byte : bytes) {
        draw = (draw ^ static_cast<std::uint32_t>(byte)) * 16777619u;
    }
    const Whole whole = read_whole(bytes, limits);
    if (draw >> 27 == 0) {
        cut_in_every_way(bytes, limits, whole);
    }
    if (bytes.size() <= 64) {
        cut_by(bytes, limits, whole, [] { return 1; });
    }
    for (const std::size_t longest : {12, 1000}) {
        cut_by(bytes, limits, whole, [longest, &draw] {
            draw = draw * 1664525u + 1013904223u;
            return 1 + (draw >> 16) % longest;
        });
    }

    for (const auto& [channel, end, body_bytes] : whole.frames) {
        const Bytes body = bytes.subspan(end - body_bytes, body_bytes);
        (void)parse_body<evod::v1::ClientMessage>(body);
        if (channel == Channel::Control) {
            (void)parse_body<evod::v1::ServerMessage>(body);
        } else {
            (void)parse_body<evod::v1::SnapshotFrame>(body);
        }
    }
    return 0;
}
