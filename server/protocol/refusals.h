// Refusals as clients read them, and what is quoted in them.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/base/result.h"

#include <string>
#include <string_view>

namespace evod::protocol {

v1::Status to_proto(const base::Refusal& refusal);

/// A response that says no.
v1::Response refusing(std::uint64_t request_id, const base::Refusal& refusal);

/// Text from outside as it may stand in a message or a log: control characters become '?', and of more than
/// `bytes_max` bytes the rest is "…". Valid UTF-8 stays valid.
std::string quotable(std::string_view text, std::size_t bytes_max = 64);

/// Shortest text that reads back as the same number: "0.1", "nan".
std::string number_text(double value);

/// The core names fields of a command; clients know them by their path in the request.
base::Refusal with_paths(base::Refusal refused, const std::string& request_name);

} // namespace evod::protocol
