#include "server/simulation/commands.h"

#include "server/base/state_hash.h"

namespace evod::simulation {

std::string to_text(const RunId& id) {
    return base::to_text(base::StateHash{.low = id.low, .high = id.high});
}

std::string to_bytes(const RunId& id) {
    return base::to_bytes(base::StateHash{.low = id.low, .high = id.high});
}

} // namespace evod::simulation
