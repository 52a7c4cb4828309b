// ForEachWorld: one request as requests for each world.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/base/result.h"

#include <optional>
#include <string>
#include <string_view>

namespace evod::protocol {

/// Whether the action also concerns the forks of the members.
bool acts_on_forks(const v1::Request& for_each_world);

/// The action as a request for one world, with the same request_id and client_key.
v1::Request request_for(const v1::Request& for_each_world, const std::string& world);

/// Returns what is wrong in a ForEachWorld, whatever the worlds are; nullopt if nothing is.
std::optional<base::Refusal> refusal_of_action(const v1::Request& for_each_world);

/// The client_key in the journal of one world: that of the request, and the name of the world. It is longer than the
/// keys of clients.
std::string key_for(std::string_view client_key, std::string_view world);
/// The client_key of the ForEachWorld to which a key in a journal belongs; nullopt: the key belongs to another command.
std::optional<std::string> key_of_batch(std::string_view key);

} // namespace evod::protocol
