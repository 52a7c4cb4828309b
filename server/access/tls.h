// TLS: what the server shows, and whom it believes. TLS 1.2 and newer.
#pragma once

#include "server/base/result.h"

#include <boost/asio/ssl/context.hpp>

#include <memory>
#include <string>

namespace evod::access {

struct TlsFiles {
    std::string certificate; // PEM, with those that vouch for it; empty: no TLS
    std::string key;         // PEM, that only its owner and group can read
    std::string client_ca;   // PEM; not empty: clients must show a certificate that one of these vouches for
};

/// nullptr without a certificate. The refusal names the option, the file and what is wrong.
base::Result<std::unique_ptr<boost::asio::ssl::context>> server_context(const TlsFiles& files);

} // namespace evod::access
