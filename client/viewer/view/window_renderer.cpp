#include "client/viewer/view/window_renderer.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/offscreen.h"
#include "client/viewer/drawing/palette.h"
#include "client/viewer/drawing/window_layout.h"
#include "client/viewer/island/legend.h"
#include "client/viewer/panels/organism_panel.h"

#include <GL/gl.h>
#include <imgui.h>

#include <algorithm>

namespace evod::viewer {

namespace {

void clear(Colour colour, const WindowRenderer::Frame& frame) {
    glViewport(0, 0, static_cast<int>(frame.width_pixels), static_cast<int>(frame.height_pixels));
    glClearColor(colour.red / 255.f, colour.green / 255.f, colour.blue / 255.f, 1);
    glClear(GL_COLOR_BUFFER_BIT);
}

} // namespace

double WindowRenderer::drawn_blend(const core::SnapshotInterpolator& view) const {
    return interpolated_ ? view.blend_at(drawn_) : 1;
}

std::optional<std::uint32_t> WindowRenderer::organism_drawn_at(WorldView& view, Point screen) const {
    const codec::ReceivedSnapshot* snapshot = view.world.feed.snapshot();
    if (snapshot == nullptr) {
        return std::nullopt;
    }
    const core::SnapshotInterpolator& island = view.world.feed.view();
    const auto index = organism_at(screen, island.organisms_at(drawn_blend(island)), view.camera());
    return index ? std::optional{snapshot->entities->organisms.id[*index]} : std::nullopt;
}

void WindowRenderer::select(WorldView& view, std::optional<std::uint32_t> organism) {
    view.world.feed.select(organism);
    if (organism) {
        panels_.show(OrganismPanel::name);
    }
}

void WindowRenderer::draw(WorldView& view, const Frame& frame) {
    const double sidebar = frame.interactive ? panels_.width(frame.width_pixels, gui_.scale()) : 0;
    const Rectangle place{0, 0, std::max(frame.width_pixels - sidebar, 1.0), double(frame.height_pixels)};
    view.lay_out(place, frame.interactive, gui_.scale());
    gui_.begin(frame.width_pixels, frame.height_pixels, std::chrono::duration<double>{frame.now - drawn_}.count());
    drawn_ = frame.now;
    interpolated_ = frame.interpolate;
    clear(palette::strip_edge, frame); // visible between tiles
    std::size_t renderer_index = 0;
    for (const Tile& tile : view.tiles()) {
        if (island_renderers_.size() <= renderer_index) {
            island_renderers_.push_back(std::make_unique<IslandRenderer>());
        }
        draw_tile(view, tile, *island_renderers_[renderer_index++], frame);
    }
    overlay_.build_world(view.world, gui_, view.place());
    gui_.widget_positions().begin_panel("Time line");
    view.timeline.build(view.world, gui_, view.timeline_place());
    gui_.widget_positions().begin_panel({});
    overlay_.build(gui_, panels_, view.place(), frame.now);
    if (frame.interactive) {
        panels_.build({view.world, gui_, frame.now, view.island_view, view.island_data},
                      {place.width, 0, sidebar, place.height});
    }
    gui_.draw();
}

void WindowRenderer::draw_tile(WorldView& view, const Tile& tile, IslandRenderer& renderer, const Frame& frame) {
    const bool chosen = tile.island == view.world.feed.island();
    const double blend = frame.interpolate ? tile.view.blend_at(frame.now) : 1;
    const codec::ReceivedSnapshot* snapshot = tile.view.latest().get();
    IslandRenderer::Highlighted highlighted;
    if (snapshot != nullptr && frame.pointed_at) {
        highlighted.pointed_at = organism_at(*frame.pointed_at, tile.view.organisms_at(blend), tile.camera);
    }
    if (chosen) { // also before the first snapshot: the panels must not use the data of the island shown before
        view.update_island(frame.now, highlighted.pointed_at.has_value());
    }
    if (snapshot != nullptr && chosen) {
        view.island_view.follow(view.island_data, tile.view, tile.camera, blend);
        if (const auto selected = view.world.feed.selected()) {
            highlighted.selected = snapshot->entities->organisms.index_of(*selected);
        }
    }
    const IslandView& island_view = view.island_view_of(tile);
    renderer.draw(tile.view, blend, tile.camera, frame.width_pixels, frame.height_pixels, island_view, highlighted);
    const Look look = island_view.options.look;
    if (!renderer.density_scale()) {
        const Rectangle& viewport = tile.camera.viewport();
        ImDrawList& list = *ImGui::GetBackgroundDrawList();
        list.PushClipRect(
            {static_cast<float>(viewport.left), static_cast<float>(viewport.top)},
            {static_cast<float>(viewport.left + viewport.width), static_cast<float>(viewport.top + viewport.height)});
        const auto healthiest = view.world.feed.healthiest(tile.island, HealthRanking::named_count);
        renderer.draw_labels(tile.view, blend, tile.camera, look, highlighted, healthiest, list, gui_.label());
        list.PopClipRect();
    }
    if (view.world.feed.all_islands()) {
        overlay_.build_tile(tile.island, gui_, tile.camera.viewport(), chosen);
    }
    if (snapshot != nullptr && chosen) {
        build_legend(legend_of(island_view, *snapshot, renderer.density_scale(), renderer.density_cell_px()),
                     tile.camera, gui_, look, marks_);
        if (island_view.options.minimap) {
            view.minimap.build(view.world, tile.camera, gui_, look);
        }
    }
    if (highlighted.pointed_at) {
        overlay_.build_organism(*snapshot, *highlighted.pointed_at, *frame.pointed_at, gui_);
    }
}

sf::Image WindowRenderer::capture(WorldView& view, const Frame& frame) {
    return draw_off_screen(frame.width_pixels, frame.height_pixels, [&] { draw(view, frame); });
}

} // namespace evod::viewer
