// Credentials: the command-line options of evoctl and evoview for the token and TLS. A token is read from a file or
// from the environment, never from the command line, because every user of the machine can read command lines.
#pragma once

#include "client/core/connection.h"

#include <string>

namespace evod::command_line {
class Command;
}

namespace evod::core {

struct Credentials {
    std::string token_file; // empty: use the environment variable EVOD_TOKEN, if set
    bool tls = false;       // use TLS even if none of the files is given
    Options::Tls files;
};

/// Adds --token-file, --ca, --tls, --cert and --key.
void add_options(command_line::Command& app, Credentials& credentials);

/// Sets the token and TLS of `options`. Fails if the token file cannot be read, or if other users can read it.
Result<void> apply(const Credentials& credentials, Options& options);

} // namespace evod::core
