// TLS: loads the server's certificate and the authorities that sign client certificates. Requires TLS 1.2 or newer.
#pragma once

#include "server/base/result.h"

#include <boost/asio/ssl/context.hpp>

#include <memory>
#include <optional>
#include <string>

namespace evod::access {

struct TlsFiles {
    std::string certificate; // PEM file with the certificate chain
    std::string key;         // PEM file; only its owner and group may be able to read it
    // PEM file with certificate authorities, one of which must have signed the certificate of a client; nullopt:
    // clients need no certificate
    std::optional<std::string> client_ca = {};
};

/// A refusal names the option, the file and the problem.
base::Result<std::unique_ptr<boost::asio::ssl::context>> server_context(const TlsFiles& files);

} // namespace evod::access
