#include "client/core/credentials.h"

#include "proto/command_line/command.h"
#include "proto/files/input_file.h"

#include <sys/stat.h>

#include <cstdlib>
#include <sstream>
#include <utility>

namespace evod::core {

void add_options(command_line::Command& app, Credentials& credentials) {
    app.add_option("--token-file", &credentials.token_file,
                   "File with the token; default: the environment variable EVOD_TOKEN");
    app.add_option("--ca", &credentials.files.ca,
                   "PEM file with the certificate authority of the server, or the server's own evod.crt; turns TLS on")
        .environment("EVOD_CA");
    app.add_flag("--tls", &credentials.tls, "Use TLS; this system must trust the certificate of the server");
    app.add_option("--cert", &credentials.files.certificate,
                   "PEM file with the client's certificate, if the server requires one");
    app.add_option("--key", &credentials.files.key,
                   "PEM file with the private key for --cert, if it is not in the --cert file itself");
}

Result<void> apply(const Credentials& credentials, Options& options) {
    if (!credentials.files.key.empty() && credentials.files.certificate.empty()) {
        return Error{.kind = Error::Kind::Usage,
                     .what =
                         "--key: " + credentials.files.key + " requires the certificate of this key: give --cert too"};
    }
    if (credentials.tls || !credentials.files.ca.empty() || !credentials.files.certificate.empty()) {
        options.tls = credentials.files;
    }
    const std::string& path = credentials.token_file;
    if (path.empty()) {
        const char* token = std::getenv("EVOD_TOKEN");
        options.token = token == nullptr ? "" : token;
        return {};
    }
    const auto refused = [&](const std::string& why) {
        return Error{.kind = Error::Kind::Usage, .what = "--token-file: " + path + ": " + why};
    };
    const auto file = files::InputFile::open(path, "a token file");
    if (!file) {
        return refused(file.error().why);
    }
    if ((file->about().st_mode & 077) != 0) {
        return refused("other users can read the file: run chmod 600 on it");
    }
    auto text = file->read(files::token_bytes_max);
    if (text && text->starts_with("\xef\xbb\xbf")) { // a byte order mark, which editors may write
        text->erase(0, 3);
    }
    if (!text) {
        return refused(text.error().why);
    }
    std::istringstream{*std::move(text)} >> options.token;
    if (options.token.empty()) {
        return refused("the file contains no token");
    }
    return {};
}

} // namespace evod::core
