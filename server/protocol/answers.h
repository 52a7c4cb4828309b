// Answers to commands, and responses as frames.
//
// Threads      any; no state. answer_of() reads the laboratory, so only the simulation thread calls it.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/base/result.h"
#include "server/simulation/laboratory.h"

#include <cstdint>
#include <string>

namespace evod::protocol {

/// The answer to a command that was applied or refused.
///
/// request_name  the field of the request: "set_parameters".
/// laboratory    in the state from which the command holds.
v1::Response answer_of(std::uint64_t request_id, const std::string& request_name,
                       const simulation::Laboratory& laboratory, const base::Result<simulation::Applied>& applied);

/// The response as a control frame: what the server sends, and what the journal stores.
std::string frame_of(v1::Response response);

} // namespace evod::protocol
