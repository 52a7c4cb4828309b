// Refusals as messages, and text from clients made safe for messages and logs.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/base/result.h"

#include <string>
#include <string_view>

namespace evod::protocol {

v1::Status to_proto(const base::Refusal& refusal);

/// A response with a refusal.
v1::Response refusing(std::uint64_t request_id, const base::Refusal& refusal);

/// Text from a client as a message or log may contain it: control characters become '?', and a text above `bytes_max`
/// bytes ends in "…". Valid UTF-8 stays valid.
std::string quotable(std::string_view text, std::size_t bytes_max = 64);

/// Prefixes the field names of the core with the request, as clients spell them: "set_parameters.mutation_chance".
base::Refusal with_paths(base::Refusal refused, const std::string& request_name);

} // namespace evod::protocol
