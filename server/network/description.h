// Description: the server tells what it is: its messages, its parameters, its limits.
#pragma once

#include "evod/v1/commands.pb.h"

namespace evod::network {

/// Made on the first call, and the same ever after.
const v1::Description& description();

} // namespace evod::network
