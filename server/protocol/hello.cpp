#include "server/protocol/hello.h"

#include "proto/codec/framing.h"
#include "server/protocol/commands.h"
#include "server/protocol/refusals.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace evod::protocol {
namespace {

constexpr std::size_t name_bytes_max = 64;
constexpr std::uint32_t client_frame_bytes_min = 65'536; // every client must accept at least this

} // namespace

std::optional<base::Refusal> refusal_of(const v1::Hello& hello) {
    std::vector<base::Violation> violations;
    const auto check_length = [&](const char* field, const std::string& text) {
        if (text.size() > name_bytes_max) {
            violations.push_back({field, "at most " + std::to_string(name_bytes_max) + " bytes",
                                  std::to_string(text.size()) + " bytes"});
        }
    };
    check_length("hello.client_name", hello.client_name());
    check_length("hello.client_version", hello.client_version());
    if (hello.frame_bytes_max() != 0 && hello.frame_bytes_max() < client_frame_bytes_min) {
        violations.push_back({"hello.frame_bytes_max", "0, or at least " + std::to_string(client_frame_bytes_min),
                              std::to_string(hello.frame_bytes_max())});
    }
    if (hello.has_join() && !hello.token().empty()) {
        violations.push_back({"hello.join", "absent with a token", "a join"});
    }
    if (!violations.empty()) {
        return invalid(std::move(violations));
    }
    const std::uint32_t lowest = hello.protocol_version();
    const std::uint32_t highest = std::max(lowest, hello.protocol_version_max());
    if (codec::protocol_version < lowest || codec::protocol_version > highest) {
        return base::Refusal{
            .code = base::RefusalCode::FailedPrecondition,
            .message = "client and server support no common protocol version: use a client of the server's version",
            .violations = {{"hello.protocol_version", std::to_string(codec::protocol_version),
                            highest == lowest ? std::to_string(lowest)
                                              : std::to_string(lowest) + " to " + std::to_string(highest)}},
            .reason = base::Reason::ProtocolVersion};
    }
    return std::nullopt;
}

std::string client_name_of(const v1::Hello& hello) {
    return hello.client_name().empty() ? "unnamed" : quotable(hello.client_name());
}

} // namespace evod::protocol
