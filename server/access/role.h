// Roles: each session has a role, which determines its permissions.
//
// Threads      any; no state.
#pragma once

#include "evod/v1/commands.pb.h"

#include <optional>
#include <string_view>

namespace evod::access {

/// Each role includes the permissions of the roles before it.
enum class Role {
    Viewer,     // may send queries, subscriptions, exports and requests for replays
    Teacher,    // may also create classes, and control the worlds of these classes
    Controller, // may also control worlds and set parameters
    Admin,      // may also create and delete worlds and shut the server down
};

/// Returns "viewer", "teacher", "controller" or "admin".
const char* name_of(Role role);
std::optional<Role> role_named(std::string_view name);
v1::Role to_proto(Role role);

} // namespace evod::access
