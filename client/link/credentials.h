// Credentials: how programs of ours are told who they come as, and whom to believe: by file or environment, never by
// a token on a command line, which everybody on the machine can read.
#pragma once

#include "client/link/connection.h"

#include <string>

namespace evod::link {

struct Credentials {
    std::string token_file; // empty: the environment's EVOD_TOKEN, if there is one
    bool tls = false;       // also without a file
    Options::Tls files;
};

/// The options of a command line, of CLI11.
template <class App>
void add_options(App& app, Credentials& credentials) {
    app.add_option("--token-file", credentials.token_file,
                   "File with the token to come in with; without it the environment's EVOD_TOKEN");
    app.add_option("--ca", credentials.files.ca,
                   "TLS; PEM file of who vouches for the server: its own evod.crt, perhaps")
        ->envname("EVOD_CA");
    app.add_flag("--tls", credentials.tls, "TLS with a server whose certificate this system trusts");
    app.add_option("--cert", credentials.files.certificate,
                   "PEM file of a certificate of ours, if the server wants one");
    app.add_option("--key", credentials.files.key, "PEM file with its key, if that is not in the same file");
}

/// Fills in the token and TLS. Refused where the token file cannot be read, or others can read it.
Result<void> apply(const Credentials& credentials, Options& options);

} // namespace evod::link
