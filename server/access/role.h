// Roles: the permissions of a session.
//
// Threads      any; no state.
#pragma once

#include "evod/v1/commands.pb.h"

#include <optional>
#include <string_view>

namespace evod::access {

/// Each role includes those before it.
enum class Role {
    Viewer,     // queries, subscriptions, exports and replays
    Controller, // also run control and parameters
    Admin,      // also creates and deletes worlds, and ends the server
};

/// "viewer", "controller", "admin".
const char* name_of(Role role);
std::optional<Role> role_named(std::string_view name);
v1::Role to_proto(Role role);

/// The lowest role that may send a request with these rules. A request without a role needs Admin.
///
/// in_own_replay  the request names a replay that its session has opened.
Role role_needed(const v1::RequestRules& rules, bool in_own_replay);

} // namespace evod::access
