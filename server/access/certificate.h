// Certificates: creates a self-signed key pair for a laboratory without its own certificate authority.
#pragma once

#include "server/base/result.h"

#include <string>
#include <vector>

namespace evod::access {

constexpr int certificate_days = 825;

/// Writes a key (EC P-256) and a self-signed certificate in PEM: `evod.key`, readable by its owner only, and
/// `evod.crt`, which clients use with --ca. Refused if one of the files exists.
///
/// hosts   names or IP addresses under which clients reach the server; at least one.
/// folder  must exist.
base::Result<void> make_certificate(const std::vector<std::string>& hosts, const std::string& folder);

} // namespace evod::access
