#include "client/viewer/shell/waiting.h"

#include <algorithm>
#include <stdexcept>

namespace evod::viewer {

std::string quoted(const std::string& world) {
    return world.empty() ? "the world" : "the world \"" + world + "\"";
}

std::string standing(const Watch& watch) {
    const auto status = watch.connection_status();
    if (status.state != core::State::Connected) {
        return status.reason.empty() ? "no connection to " + core::to_text(watch.server()) : status.reason;
    }
    const RunControl& control = watch.control();
    if (!control.known()) {
        return core::to_text(watch.server()) + " has shown no picture of " + quoted(watch.world());
    }
    return quoted(control.world()) + " is " + watch.state_words() + " at tick " + std::to_string(control.tick());
}

void check_hope(const Watch& watch) {
    if (watch.connection_status().state == core::State::Failed) {
        throw std::runtime_error{standing(watch)};
    }
    if (const auto refusal = watch.refusal()) {
        throw std::runtime_error{*refusal};
    }
}

bool all_have_pictures(Panes& panes) {
    panes.update(core::WorldView::Clock::now());
    bool all = true;
    for (std::size_t i = 0; i < panes.size(); ++i) {
        const std::vector<Tile> tiles = panes[i].tiles();
        all = all && panes[i].watch.all_answered() && !panes[i].watch.refusal() &&
              std::ranges::all_of(tiles, [](const Tile& tile) { return tile.view.latest() != nullptr; });
    }
    return all;
}

} // namespace evod::viewer
