// Authorization: whether a user may send a request. The rules of each request are options in the .proto files.
//
// Threads      any; no state.
#pragma once

#include "server/access/role.h"
#include "server/base/result.h"
#include "server/simulation/commands.h"

#include <string>

namespace evod::access {

/// Who sends a request.
struct Requester {
    std::string user; // empty: no token
    Role role = Role::Viewer;
    bool in_own_replay = false; // the request names a replay that the session has opened
};

/// What matters about the world that a request names.
struct RequestedWorld {
    const simulation::Ownership& ownership;
    bool frozen = false; // as in the rules of its class
};

/// The lowest role that may send a request with these rules, whatever world it names. If the rules state no role, an
/// admin is needed.
Role role_needed(const v1::RequestRules& rules, bool in_own_replay);

/// Whether the requester is the owner of the world or the teacher of its class.
bool owns(const Requester& requester, const simulation::Ownership& ownership);

/// Refuses with PERMISSION_DENIED if neither the role of the requester nor the owner of the world permits the request,
/// and with FAILED_PRECONDITION if the requester is only the owner, and the world is frozen.
///
/// request  name of the request, for the refusal.
/// world    nullptr: it is not known yet. The request is then permitted if it depends on the world.
base::Result<void> may(const Requester& requester, const v1::RequestRules& rules, const std::string& request,
                       const RequestedWorld* world);

} // namespace evod::access
