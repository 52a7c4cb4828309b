// Request rules: reads the options in commands.proto by reflection.
//
// Threads      any; the rules are constant.
#pragma once

#include "evod/v1/commands.pb.h"

#include <string>

namespace evod::protocol {

/// The rules for this kind of request; nullptr: this server does not know the request.
const v1::RequestRules* rules_of(const v1::Request& request);

/// The kind of the request, or REQUEST_KIND_UNSPECIFIED if this server does not know it.
v1::RequestKind kind_of(const v1::Request& request);

/// The name of the field in the request: "set_parameters". Empty if this server does not know the request.
std::string name_of(const v1::Request& request);

/// The value of the field `world` in the request's message; empty if the message has no such field.
std::string world_of(const v1::Request& request);

} // namespace evod::protocol
