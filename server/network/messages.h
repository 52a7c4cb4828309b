// Messages: encodes the frames that the network thread sends, and logs refusals.
//
// Threads      any; no state.
#pragma once

#include "evod/v1/session.pb.h"
#include "proto/codec/shared_bytes.h"
#include "server/base/result.h"

#include <cstdint>
#include <string>

namespace evod::network {

using codec::SharedBytes;

/// Returns a response without an answer, which reports success.
v1::Response response_to(std::uint64_t request_id);

SharedBytes encode_control(const v1::ServerMessage& message);
SharedBytes encode_response(v1::Response response);
/// Encodes the event after setting its time to the current time.
SharedBytes encode_event(v1::Event event);
SharedBytes encode_goodbye(const base::Refusal& why);

/// Logs a refusal at Level::Debug. Logs nothing if the response is not a refusal.
///
/// by  the client that sent the request, as Session::by() returns it.
void log_refusal(std::uint64_t session, const std::string& by, const v1::Response& response);
void log_refusal(std::uint64_t session, const std::string& by, std::uint64_t request_id, const base::Refusal& refused);

} // namespace evod::network
