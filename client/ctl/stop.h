// Stop: the exception that ends a call of evoctl; main turns it into an exit code.
#pragma once

#include "evod/v1/commands.pb.h"

#include <string>

namespace evod::ctl {

enum class ExitCode {
    Ok = 0,
    Refused = 1,      // by the server; or the awaited event did not happen
    Usage = 2,        // wrong usage, found by evoctl or by the server (INVALID_ARGUMENT)
    NoConnection = 3, // no server, or no reply
    TokenNeeded = 4,  // the server requires a valid token
};

struct Stop {
    ExitCode code;
    std::string text;       // for stderr; may be empty
    v1::Status status = {}; // the server's refusal, if that is the reason
};

} // namespace evod::ctl
