// Session requests: which requests have a meaning only in the session in which they were made, because they contain the
// id of a subscription, of an export or of a replay. Another session may use the same id for something else.
#pragma once

#include "evod/v1/commands.pb.h"

#include <string>

namespace evod::core {

/// Returns the name of the replay that a request names as its world: "default@3". Empty if it names none.
std::string replay_in(const evod::v1::Request& request);

/// Returns whether the request must not be sent in a later session.
bool ends_with_session(const evod::v1::Request& request);

/// Returns the answer to a request that names a replay of an earlier session, as the server states it if it does not
/// know the replay.
evod::v1::Status replay_has_ended(const std::string& replay);

} // namespace evod::core
