// Description: the message schema and the parameters of this server, for Describe.
#pragma once

#include "evod/v1/commands.pb.h"

namespace evod::network {

/// Everything but the limits, which depend on the server's options. Built on the first call.
const v1::Description& description();

} // namespace evod::network
