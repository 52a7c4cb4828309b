#include "client/viewer/panes/pane.h"

#include "client/viewer/drawing/window_layout.h"

#include <algorithm>
#include <utility>

namespace evod::viewer {

// ---- one pane --------------------------------------------------------------------------------------------------

std::vector<Tile> Pane::tiles() {
    std::vector<Tile> tiles;
    const std::uint32_t count = world.feed.all_islands() ? world.feed.island_count() : 1;
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t island = world.feed.all_islands() ? i : world.feed.island();
        tiles.push_back({island, world.feed.view_of(island), camera_of(island)});
    }
    return tiles;
}

const IslandView& Pane::island_view_of(const Tile& tile) {
    if (tile.island == world.feed.island()) {
        return island_view;
    }
    others_.options = island_view.options;
    return others_;
}

void Pane::lay_out(Rectangle place, bool with_timeline, double scale) {
    const double height = with_timeline && world.replay.info() ? Timeline::height_pixels * scale : 0;
    place_ = {place.left, place.top, place.width, std::max(place.height - height, 1.0)};
    timeline_place_ = {place.left, place.top + place_.height, place.width, height};
    const std::vector<Tile> all = tiles();
    double aspect = 1;
    for (const Tile& tile : all) {
        if (const auto& snapshot = tile.view.latest()) {
            tile.camera.set_island(snapshot->about.width_px(), snapshot->about.height_px());
            aspect = snapshot->about.width_px() / std::max(snapshot->about.height_px(), 1.0);
        }
    }
    const std::vector<Rectangle> places = in_tiles(viewport_of(place_, scale), all.size(), aspect);
    for (std::size_t i = 0; i < all.size(); ++i) {
        all[i].camera.set_viewport(places[i], scale);
    }
}

// ---- all panes -------------------------------------------------------------------------------------------------

Panes::Panes(WantedWorld wanted, const std::optional<std::string>& beside, const ViewOptions& view)
    : wanted_{std::move(wanted)} {
    panes_.push_back(std::make_unique<Pane>(wanted_, view));
    wanted_.replay_generation.reset();
    if (beside) {
        wanted_.world = *beside;
        panes_.push_back(std::make_unique<Pane>(wanted_, view));
    }
}

void Panes::update(core::SnapshotInterpolator::Clock::time_point now) {
    for (const auto& pane : panes_) {
        pane->world.update(now);
    }
    if (!next_world_.empty()) { // opened here, because panes must not change while they are updated
        open_beside(std::exchange(next_world_, {}), 0);
    }
    for (std::size_t i = 0; i < panes_.size(); ++i) {
        if (std::string world = panes_[i]->world.take_beside(); !world.empty()) {
            show_beside(i, std::move(world));
        }
    }
}

void Panes::lay_out(Rectangle place, bool with_timelines, double scale) {
    const auto columns = side_by_side(place, panes_.size());
    for (std::size_t i = 0; i < panes_.size(); ++i) {
        panes_[i]->lay_out(columns[i], with_timelines, scale);
    }
}

bool Panes::focus_at(Point screen) {
    for (std::size_t i = 0; i < panes_.size(); ++i) {
        if (!panes_[i]->place().contains(screen)) {
            continue;
        }
        focus_ = i;
        for (const Tile& tile : panes_[i]->tiles()) {
            if (tile.camera.viewport().contains(screen)) {
                panes_[i]->world.feed.choose_island(tile.island);
                break;
            }
        }
        return true;
    }
    return false;
}

Camera& Panes::camera_at(Point screen) {
    for (const auto& pane : panes_) {
        for (const Tile& tile : pane->tiles()) {
            if (tile.camera.viewport().contains(screen)) {
                return tile.camera;
            }
        }
    }
    return focused().camera();
}

void Panes::toggle_beside() {
    const std::uint64_t number = ++next_request_number_;
    if (panes_.size() > 1) {
        panes_.erase(panes_.begin() + static_cast<std::ptrdiff_t>(1 - focus_));
        focus_ = 0;
        return;
    }
    ViewedWorld& shown = focused().world;
    const std::string beside =
        !shown.replay.forked().empty() ? shown.replay.forked() : shown.replay.present().value_or(shown.feed.world());
    if (beside != shown.feed.world()) {
        open_beside(beside, shown.feed.island());
        return;
    }
    shown.find_next_world([this, number, &shown](const std::optional<std::string>& world) {
        if (number != next_request_number_) { // the key was pressed again while the request was pending
            return;
        }
        if (world) {
            next_world_ = *world;
        } else {
            shown.offer_new_world();
        }
    });
}

/// Shows a world in the other half than the pane with this index.
void Panes::show_beside(std::size_t pane, std::string world) {
    const ViewedWorld& shown = panes_[pane]->world;
    const std::uint32_t island = world == shown.replay.forked() ? shown.feed.island() : 0;
    if (panes_.size() > 1) {
        panes_[1 - pane]->world.show(std::move(world), island);
    } else {
        open_beside(std::move(world), island);
    }
}

void Panes::open_beside(std::string world, std::uint32_t island) {
    wanted_.world = std::move(world);
    wanted_.island = island;
    wanted_.all_islands = focused().world.feed.all_islands();
    panes_.push_back(std::make_unique<Pane>(wanted_, focused().island_view.options));
    focus_ = 1;
}

void Panes::link_cameras(const Camera& leader) {
    if (!linked_) {
        return;
    }
    for (const auto& pane : panes_) {
        for (const Tile& tile : pane->tiles()) {
            if (&tile.camera != &leader) {
                tile.camera.follow(leader);
            }
        }
    }
}

} // namespace evod::viewer
