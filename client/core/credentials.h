// Credentials: how programs of ours are told who they come as, and whom to believe: by file or environment, never by
// a token on a command line, which everybody on the machine can read.
#pragma once

#include "client/core/connection.h"

#include <string>

namespace evod::command_line {
class Command;
}

namespace evod::core {

struct Credentials {
    std::string token_file; // empty: the environment's EVOD_TOKEN, if there is one
    bool tls = false;       // also without a file
    Options::Tls files;
};

/// Adds --token-file, --ca, --tls, --cert and --key.
void add_options(command_line::Command& app, Credentials& credentials);

/// Fills in the token and TLS. Refused where the token file cannot be read, or others can read it.
Result<void> apply(const Credentials& credentials, Options& options);

} // namespace evod::core
