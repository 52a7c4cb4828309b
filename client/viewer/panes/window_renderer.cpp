#include "client/viewer/panes/window_renderer.h"

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

std::optional<std::uint32_t> WindowRenderer::organism_drawn_at(Pane& pane, Point screen) const {
    const codec::ReceivedSnapshot* snapshot = pane.world.feed.snapshot();
    if (snapshot == nullptr) {
        return std::nullopt;
    }
    const core::SnapshotInterpolator& view = pane.world.feed.view();
    const double blend = interpolated_ ? view.blend_at(drawn_) : 1;
    const auto index = organism_at(screen, view.organisms_at(blend), pane.camera(), gui_.scale());
    return index ? std::optional{snapshot->entities->organisms.id[*index]} : std::nullopt;
}

void WindowRenderer::select(Pane& pane, std::optional<std::uint32_t> organism) {
    pane.world.feed.select(organism);
    if (organism) {
        panels_.show(OrganismPanel::name);
    }
}

Captured WindowRenderer::captured(const sf::Event& event) const {
    Captured captured = gui_.captured();
    captured.keyboard |= event.type == sf::Event::KeyPressed && panels_.handles(event.key);
    return captured;
}

void WindowRenderer::draw(Panes& panes, const Frame& frame) {
    const double sidebar = frame.interactive ? panels_.width(frame.width_pixels, gui_.scale()) : 0;
    const Rectangle worlds{0, 0, std::max(frame.width_pixels - sidebar, 1.0), double(frame.height_pixels)};
    panes.lay_out(worlds, frame.interactive, gui_.scale());
    gui_.begin(frame.width_pixels, frame.height_pixels, std::chrono::duration<double>{frame.now - drawn_}.count());
    drawn_ = frame.now;
    interpolated_ = frame.interpolate;
    clear(palette::strip_edge, frame); // visible between panes and tiles
    std::size_t renderer_index = 0;
    for (std::size_t i = 0; i < panes.size(); ++i) {
        Pane& pane = panes[i];
        gui_.widget_positions().begin_panel(i == 0 ? "left" : "right");
        for (const Tile& tile : pane.tiles()) {
            if (island_renderers_.size() <= renderer_index) {
                island_renderers_.push_back(std::make_unique<IslandRenderer>());
            }
            draw_tile(pane, tile, *island_renderers_[renderer_index++], frame, static_cast<int>(i));
        }
        overlay_.build_world(pane.world, gui_, pane.place(), frame.interactive && panes.has_focus(pane));
        pane.timeline.build(pane.world, gui_, pane.timeline_place(), static_cast<int>(i));
        gui_.widget_positions().begin_panel({});
        const bool timeline_pressed = pane.timeline.take_press(), minimap_pressed = pane.minimap.take_press();
        if (timeline_pressed || minimap_pressed) {
            panes.focus(i);
        }
    }
    overlay_.build(gui_, panels_, frame.now);
    if (frame.interactive) {
        panels_.build({panes.focused().world, gui_, frame.now, panes.focused().island_view},
                      {worlds.width, 0, sidebar, worlds.height});
    }
    gui_.draw();
}

void WindowRenderer::draw_tile(Pane& pane, const Tile& tile, IslandRenderer& renderer, const Frame& frame,
                               int pane_number) {
    const bool chosen = tile.island == pane.world.feed.island();
    const double blend = frame.interpolate ? tile.view.blend_at(frame.now) : 1;
    const codec::ReceivedSnapshot* snapshot = tile.view.latest().get();
    IslandRenderer::Highlighted highlighted;
    if (snapshot != nullptr && chosen) {
        pane.island_view.update(pane.world, tile.camera, frame.now);
        pane.island_view.follow(pane.world, tile.camera, blend);
        if (const auto selected = pane.world.feed.selected()) {
            highlighted.selected = snapshot->entities->organisms.index_of(*selected);
        }
    }
    if (snapshot != nullptr && frame.pointed_at) {
        highlighted.pointed_at =
            organism_at(*frame.pointed_at, tile.view.organisms_at(blend), tile.camera, gui_.scale());
    }
    const IslandView& island_view = pane.island_view_of(tile);
    renderer.draw(tile.view, blend, tile.camera, frame.width_pixels, frame.height_pixels, island_view, highlighted);
    if (!island_view.shows_density(tile.camera)) {
        const Rectangle& viewport = tile.camera.viewport();
        ImDrawList& list = *ImGui::GetBackgroundDrawList();
        list.PushClipRect(
            {static_cast<float>(viewport.left), static_cast<float>(viewport.top)},
            {static_cast<float>(viewport.left + viewport.width), static_cast<float>(viewport.top + viewport.height)});
        renderer.draw_labels(tile.view, blend, tile.camera, list, gui_.label());
        list.PopClipRect();
    }
    if (pane.world.feed.all_islands()) {
        overlay_.build_tile(tile.island, gui_, tile.camera.viewport(), chosen);
    }
    if (snapshot != nullptr && chosen) {
        build_legend(legend_of(island_view, *snapshot, renderer.density_scale(), renderer.density_cell_px()),
                     tile.camera, gui_);
        if (island_view.options.minimap) {
            pane.minimap.build(pane.world, tile.camera, gui_, pane_number);
        }
    }
    if (highlighted.pointed_at) {
        overlay_.build_organism(*snapshot, *highlighted.pointed_at, *frame.pointed_at, gui_);
    }
}

void WindowRenderer::draw(const std::function<void(const Gui&)>& build, const Frame& frame) {
    gui_.begin(frame.width_pixels, frame.height_pixels, std::chrono::duration<double>{frame.now - drawn_}.count());
    drawn_ = frame.now;
    clear(palette::background, frame);
    build(gui_);
    gui_.draw();
}

sf::Image WindowRenderer::capture(const Frame& frame, const std::function<void()>& draw) {
    return draw_off_screen(frame.width_pixels, frame.height_pixels, draw);
}

} // namespace evod::viewer
