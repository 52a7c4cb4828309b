// Random worlds: requests to create small worlds of every kind.
#pragma once

#include "evod/v1/commands.pb.h"
#include "tests/histories/draws.h"

#include <string>

namespace evod::histories {

/// Returns a request that is accepted.
v1::Request random_world(const std::string& name, Draws& draws);

} // namespace evod::histories
