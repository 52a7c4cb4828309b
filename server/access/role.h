// Roles: what a session may ask for.
#pragma once

#include "evod/v1/commands.pb.h"

#include <optional>
#include <string_view>

namespace evod::access {

/// Each may do what those before it may.
enum class Role {
    Viewer,     // looks
    Controller, // and changes how worlds run
    Admin,      // and makes and deletes worlds, and ends the server
};

/// "viewer", "controller", "admin".
const char* name_of(Role role);
std::optional<Role> role_named(std::string_view name);

/// The least role that may send such a request. Of what somebody opened to look at the past, they may run, step and
/// seek it as viewers.
///
/// request  of a kind this server knows.
Role role_needed(v1::Request::KindCase request, bool of_own_past);

} // namespace evod::access
