// Description: the message schema and the parameters of this server, as the answer to Describe.
#pragma once

#include "evod/v1/commands.pb.h"

namespace evod::network {

/// Returns the complete description except the limits, which depend on the server's options. The first call builds it.
const v1::Description& description();

} // namespace evod::network
