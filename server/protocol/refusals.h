// Refusals: converts refusals into messages, and makes text from clients safe for messages and logs.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/base/result.h"

#include <string>
#include <string_view>

namespace evod::protocol {

v1::Status to_proto(const base::Refusal& refusal);

/// Builds a response that contains a refusal.
v1::Response refusing(std::uint64_t request_id, const base::Refusal& refusal);

/// Makes text from a client safe for messages and logs. Replaces control characters with '?'. If the text is longer
/// than `bytes_max` bytes, cuts it and appends "…". Valid UTF-8 stays valid.
std::string quotable(std::string_view text, std::size_t bytes_max = 64);

/// Prefixes the field names in a refusal with the name of the request, as clients spell them:
/// "set_parameters.mutation_chance".
base::Refusal with_paths(base::Refusal refused, const std::string& request_name);

} // namespace evod::protocol
