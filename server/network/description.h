// Description: the server tells what it is: its messages and its parameters.
#pragma once

#include "evod/v1/commands.pb.h"

namespace evod::network {

/// All but the limits, which depend on how the server was started. Made on the first call, and the same ever after.
const v1::Description& description();

} // namespace evod::network
