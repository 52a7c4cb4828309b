// Answers: builds the answers to commands and encodes responses as frames.
//
// Threads      any; no state. answer_of() reads the laboratory, so only the simulation thread may call it.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/base/result.h"
#include "server/simulation/laboratory.h"

#include <cstdint>
#include <string>

namespace evod::protocol {

/// Builds the answer to a command that was applied or refused.
///
/// request_name  name of the field in the request: "set_parameters".
/// laboratory    the laboratory in its state right after the command.
v1::Response answer_of(std::uint64_t request_id, const std::string& request_name,
                       const simulation::Laboratory& laboratory, const base::Result<simulation::Applied>& applied);

/// Encodes the response as a control frame. The server sends this frame, and the journal stores it.
std::string frame_of(v1::Response response);

} // namespace evod::protocol
