// Hello: checks the fields of a Hello that can be checked without other data.
#pragma once

#include "evod/v1/session.pb.h"
#include "server/base/result.h"

#include <optional>
#include <string>

namespace evod::protocol {

/// Returns a refusal if a field is invalid or if there is no common protocol version; nullopt if the Hello is valid.
std::optional<base::Refusal> refusal_of(const v1::Hello& hello);

/// The client's name for logs and actors. It is never empty.
std::string client_name_of(const v1::Hello& hello);

} // namespace evod::protocol
