// Authorization: whether the role of a session permits a request. The rules of each request are options in the .proto
// files.
//
// Threads      any; no state.
#pragma once

#include "server/access/role.h"
#include "server/base/result.h"

#include <string>

namespace evod::access {

/// The lowest role that may send a request with these rules. If the rules state no role, an admin is needed.
///
/// in_own_replay  true: the request names a replay that its session has opened.
Role role_needed(const v1::RequestRules& rules, bool in_own_replay);

/// Refuses with PERMISSION_DENIED if `role` may not send a request with these rules.
///
/// request        name of the request, for the refusal.
/// in_own_replay  as above.
base::Result<void> authorize(Role role, const v1::RequestRules& rules, const std::string& request, bool in_own_replay);

} // namespace evod::access
