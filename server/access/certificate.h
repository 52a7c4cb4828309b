// Certificates: a self-signed pair for a laboratory without an authority of its own.
#pragma once

#include "server/base/result.h"

#include <string>
#include <vector>

namespace evod::access {

constexpr int certificate_days = 825;

/// A key (EC P-256) and a certificate that vouches for itself, in PEM: `evod.key`, for its owner alone, and `evod.crt`,
/// which clients are given with --ca. Refused where one of the files is there already.
///
/// hosts   names or IP addresses under which clients will reach the server; at least one.
/// folder  is there.
base::Result<void> make_certificate(const std::vector<std::string>& hosts, const std::string& folder);

} // namespace evod::access
