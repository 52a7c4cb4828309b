// Stop: the exception that ends a call of evoctl; main turns it into an exit code.
#pragma once

#include "evod/v1/commands.pb.h"

#include <string>

namespace evod::ctl {

enum class ExitCode {
    Ok = 0,
    Refused = 1,      // the server refused the command, or the awaited event did not happen
    Usage = 2,        // evoctl or the server (INVALID_ARGUMENT) found an error in the arguments
    NoConnection = 3, // there is no server, or it did not reply
    TokenNeeded = 4,  // the server requires a valid token
};

struct Stop {
    ExitCode code;
    std::string text;       // the message for stderr; may be empty
    v1::Status status = {}; // the server's refusal, if the server refused the command
};

} // namespace evod::ctl
