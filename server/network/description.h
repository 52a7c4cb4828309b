// Description: the message schema and the parameters of this server, as the answer to Describe.
#pragma once

#include "evod/v1/commands.pb.h"

namespace evod::network {

/// The complete description except the limits, which depend on the server's options. It is built on the first call.
const v1::Description& description();

} // namespace evod::network
