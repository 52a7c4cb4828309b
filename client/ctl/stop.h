// Stop: the end of a call of evoctl, thrown from wherever it is seen and turned into an exit code in main.
#pragma once

#include "evod/v1/commands.pb.h"

#include <string>

namespace evod::ctl {

enum class ExitCode {
    Ok = 0,
    Refused = 1,      // by the server; or what was waited for did not come about
    Usage = 2,        // this call makes no sense, whether evoctl finds that or the server (INVALID_ARGUMENT)
    NoConnection = 3, // no server, or no answer
    TokenNeeded = 4,  // the server is there, and wants a token that it knows
};

struct Stop {
    ExitCode code;
    std::string text;       // for stderr; empty: nothing to say
    v1::Status status = {}; // of the server's refusal; empty: it was none
};

} // namespace evod::ctl
