// Certificates: creates a private key and a self-signed certificate, for users without a certificate authority.
#pragma once

#include "server/base/result.h"

#include <string>
#include <vector>

namespace evod::access {

constexpr int certificate_days = 825;

/// Writes a private key (EC P-256) and a self-signed certificate as PEM files: `evod.key`, which only its owner can
/// read, and `evod.crt`, which clients name with --ca. Refuses to overwrite existing files.
///
/// hosts   the names or IP addresses with which clients connect to the server; at least one.
/// folder  an existing folder.
base::Result<void> create_certificate(const std::vector<std::string>& hosts, const std::string& folder);

} // namespace evod::access
