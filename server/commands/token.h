// `evod token`: makes, lists and revokes tokens. A server that runs takes notice within a second.
#pragma once

#include "server/access/role.h"

#include <string>

namespace evod::command_line {
class Command;
}

namespace evod::commands {

// Each returns the exit status: 0, or 1 with a sentence on stderr. folder: that of the token file.

/// The secret goes to stdout, alone, and what to do with it to stderr.
int add_token(const std::string& folder, const std::string& name, access::Role role);
int list_tokens(const std::string& folder);
int revoke_token(const std::string& folder, const std::string& name);

void add_token_command(command_line::Command& app);

} // namespace evod::commands
