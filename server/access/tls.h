// TLS: the server's certificate, and the authorities for client certificates. TLS 1.2 and newer.
#pragma once

#include "server/base/result.h"

#include <boost/asio/ssl/context.hpp>

#include <memory>
#include <string>

namespace evod::access {

struct TlsFiles {
    std::string certificate; // PEM with its chain; empty: no TLS
    std::string key;         // PEM; only owner and group may be able to read it
    std::string client_ca;   // PEM; not empty: clients need a certificate signed by one of these
};

/// nullptr without a certificate. A refusal names the option, the file and the problem.
base::Result<std::unique_ptr<boost::asio::ssl::context>> server_context(const TlsFiles& files);

} // namespace evod::access
