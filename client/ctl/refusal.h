// Refusal: a refusal of the server in the words of the command line.
#pragma once

#include "evod/v1/commands.pb.h"

#include <string>

namespace evod::command_line {
class Command;
}

namespace evod::ctl {

/// Returns the message of the server, in which the names of fields are replaced by those of options and values that the
/// user typed.
///
/// command  the subcommand that the user called; nullptr: unknown.
std::string refusal_text(const v1::Status& status, const command_line::Command* command);

} // namespace evod::ctl
