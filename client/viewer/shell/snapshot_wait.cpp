#include "client/viewer/shell/snapshot_wait.h"

#include <algorithm>
#include <stdexcept>

namespace evod::viewer {

std::string quoted(const std::string& world) {
    return world.empty() ? "the world" : "the world \"" + world + "\"";
}

std::string progress_text(const ViewedWorld& world) {
    const auto status = world.server.status();
    if (status.state != core::State::Connected) {
        return status.reason.empty() ? "no connection to " + core::to_text(world.server.endpoint()) : status.reason;
    }
    const RunControl& control = world.feed.control();
    if (!control.known()) {
        return core::to_text(world.server.endpoint()) + " has sent no snapshot of " + quoted(world.feed.world());
    }
    return quoted(control.world()) + " is " + world.state_text() + " at tick " + std::to_string(control.tick());
}

void check_reachable(const ViewedWorld& world) {
    if (world.server.status().state == core::State::Failed) {
        throw std::runtime_error{progress_text(world)};
    }
    if (const auto refusal = world.refusal()) {
        throw std::runtime_error{*refusal};
    }
}

bool has_all_snapshots(WorldView& view) {
    view.world.update(core::SnapshotInterpolator::Clock::now());
    return view.world.all_answered() && !view.world.refusal() &&
           std::ranges::all_of(view.tiles(), [](const Tile& tile) { return tile.view.latest() != nullptr; });
}

} // namespace evod::viewer
