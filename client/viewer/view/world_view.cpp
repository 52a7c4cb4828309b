#include "client/viewer/view/world_view.h"

#include "client/viewer/drawing/window_layout.h"

#include <algorithm>
#include <utility>

namespace evod::viewer {

std::vector<Tile> WorldView::tiles() {
    std::vector<Tile> tiles;
    const std::uint32_t count = world.feed.all_islands() ? world.feed.island_count() : 1;
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t island = world.feed.all_islands() ? i : world.feed.island();
        tiles.push_back({island, world.feed.view_of(island), camera_of(island)});
    }
    return tiles;
}

const IslandView& WorldView::island_view_of(const Tile& tile) {
    if (tile.island == world.feed.island()) {
        return island_view;
    }
    others_.options = island_view.options;
    return others_;
}

void WorldView::lay_out(Rectangle place, bool with_timeline, double scale) {
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

void WorldView::update_island(core::SnapshotInterpolator::Clock::time_point now, bool points_at) {
    island_data.update(world, island_view.needs(points_at), now);
    if (const auto& snapshot = world.feed.view().latest()) {
        island_view.add(camera(), snapshot);
        update_stream(now);
    }
}

void WorldView::update_stream(core::SnapshotInterpolator::Clock::time_point now) {
    const codec::ReceivedSnapshot& snapshot = *world.feed.snapshot();
    const bool other_place = streamed_place_ != world.feed.place_number();
    const bool other_run = streamed_run_ != snapshot.about.run_id();
    if (other_place || other_run || world.feed.all_islands()) { // a view would restrict the snapshots of all islands
        region_ = {};
        in_part_ = false;
    }
    if (!other_place && other_run && !streamed_run_.empty()) { // the world was reset
        world.feed.set_view(std::nullopt);
    }
    streamed_place_ = world.feed.place_number();
    streamed_run_ = snapshot.about.run_id();
    in_part_ = in_part_ || std::max(snapshot.about.organism_count(), snapshot.about.live().organism_count()) >=
                               StreamedRegion::organisms_min;
    if (!in_part_ || world.feed.all_islands()) {
        return;
    }
    if (auto view = region_.update(camera(), island_view.detail(camera(), snapshot), now)) {
        world.feed.set_view(std::move(view));
    }
}

void WorldView::choose_island_at(Point screen) {
    for (const Tile& tile : tiles()) {
        if (tile.camera.viewport().contains(screen)) {
            world.feed.choose_island(tile.island);
            return;
        }
    }
}

Camera& WorldView::camera_at(Point screen) {
    for (const Tile& tile : tiles()) {
        if (tile.camera.viewport().contains(screen)) {
            return tile.camera;
        }
    }
    return camera();
}

} // namespace evod::viewer
