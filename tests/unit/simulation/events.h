// The events of a world, filtered by kind, for tests.
#pragma once

#include "server/simulation/world.h"

#include <utility>
#include <variant>
#include <vector>

namespace evod::simulation {

/// The events of one kind since events were last taken; the others are dropped.
template <class Kind>
std::vector<Kind> events(World& world) {
    std::vector<Kind> found;
    for (EventKind& event : world.take_events()) {
        if (auto* kind = std::get_if<Kind>(&event)) {
            found.push_back(std::move(*kind));
        }
    }
    return found;
}

} // namespace evod::simulation
