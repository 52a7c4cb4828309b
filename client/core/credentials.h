// Credentials: the options for the token and TLS of evoctl and evoview. A token comes from a file or the environment, never from
// the command line, which every user of the machine can read.
#pragma once

#include "client/core/connection.h"

#include <string>

namespace evod::command_line {
class Command;
}

namespace evod::core {

struct Credentials {
    std::string token_file; // empty: EVOD_TOKEN of the environment, if set
    bool tls = false;       // TLS even without a file
    Options::Tls files;
};

/// Adds --token-file, --ca, --tls, --cert and --key.
void add_options(command_line::Command& app, Credentials& credentials);

/// Sets the token and TLS of `options`. Fails if the token file cannot be read, or if other users can read it.
Result<void> apply(const Credentials& credentials, Options& options);

} // namespace evod::core
