#include "client/viewer/stage/stage.h"

#include "client/viewer/drawing/offscreen.h"
#include "client/viewer/drawing/palette.h"
#include "client/viewer/drawing/window_layout.h"
#include "client/viewer/panels/organism_panel.h"
#include "client/viewer/scene/legend.h"

#include <GL/gl.h>
#include <imgui.h>

#include <algorithm>

namespace evod::viewer {

namespace {

std::optional<std::size_t> index_of(std::optional<std::uint32_t> id, const codec::DecodedSnapshot& picture) {
    const auto& ids = picture.organisms.id;
    const auto place = id ? std::ranges::lower_bound(ids, *id) : ids.end();
    return place != ids.end() && *place == *id ? std::optional{static_cast<std::size_t>(place - ids.begin())}
                                               : std::nullopt;
}

/// What the strips and time lines of a window leave.
Rectangle room_for_panels(Panes& panes, const Stage::Frame& frame, double scale) {
    Rectangle room = below_panel_strip(frame.width_pixels, frame.height_pixels, scale);
    for (std::size_t i = 0; i < panes.size(); ++i) {
        const Rectangle& place = panes[i].place();
        room.height = std::min(room.height, place.top + place.height - room.top);
    }
    return viewport_of(room, scale);
}

void clear(Colour colour, const Stage::Frame& frame) {
    glViewport(0, 0, static_cast<int>(frame.width_pixels), static_cast<int>(frame.height_pixels));
    glClearColor(colour.red / 255.f, colour.green / 255.f, colour.blue / 255.f, 1);
    glClear(GL_COLOR_BUFFER_BIT);
}

} // namespace

void Stage::select_at(Pane& pane, Point screen) {
    Watch& watch = pane.watch;
    if (const codec::DecodedSnapshot* picture = watch.picture()) {
        const auto index = organism_at(screen, *picture, watch.view().organisms_at(pane.blend), pane.camera());
        watch.select(index ? std::optional{picture->organisms.id[*index]} : std::nullopt);
        if (index) {
            panels_.show(OrganismPanel::name);
        }
    }
}

Captured Stage::captured(const sf::Event& event) const {
    Captured captured = gui_.captured();
    captured.keyboard |= event.type == sf::Event::KeyPressed && panels_.take(event.key);
    return captured;
}

void Stage::draw(Panes& panes, const Frame& frame) {
    panes.lay_out(frame.width_pixels, frame.height_pixels, frame.interactive, gui_.scale());
    gui_.begin(frame.width_pixels, frame.height_pixels, std::chrono::duration<double>{frame.now - drawn_}.count());
    drawn_ = frame.now;
    clear(palette::strip_edge, frame); // between panes and tiles
    std::size_t scene = 0;
    for (std::size_t i = 0; i < panes.size(); ++i) {
        Pane& pane = panes[i];
        gui_.spots().begin_panel(i == 0 ? "left" : "right");
        for (const Tile& tile : pane.tiles()) {
            if (scenes_.size() <= scene) {
                scenes_.push_back(std::make_unique<Scene>());
            }
            draw_tile(pane, tile, *scenes_[scene++], frame, static_cast<int>(i));
        }
        overlay_.build_world(pane.watch, gui_, pane.place(), frame.interactive && panes.has_focus(pane));
        pane.timeline.build(pane.watch, gui_, pane.timeline_place(), static_cast<int>(i));
        gui_.spots().begin_panel({});
        const bool line = pane.timeline.take_press(), map = pane.minimap.take_press();
        if (line || map) {
            panes.focus(i);
        }
    }
    overlay_.build(gui_, panels_, frame.now);
    if (frame.interactive) {
        panels_.build({panes.focused().watch, gui_, frame.now, panes.focused().sight},
                      room_for_panels(panes, frame, gui_.scale()));
    }
    gui_.draw();
}

void Stage::draw_tile(Pane& pane, const Tile& tile, Scene& scene, const Frame& frame, int pane_number) {
    const bool chosen = tile.island == pane.watch.island();
    const double blend = frame.glide ? tile.view.blend_at(frame.now) : 1;
    const codec::DecodedSnapshot* picture = tile.view.latest().get();
    Scene::Marked marked;
    if (picture != nullptr && chosen) {
        pane.blend = blend;
        pane.sight.update(pane.watch, tile.camera, frame.now);
        pane.sight.follow(pane.watch, tile.camera, blend);
        marked.selected = index_of(pane.watch.selected(), *picture);
    }
    if (picture != nullptr && frame.pointed_at) {
        marked.pointed_at = organism_at(*frame.pointed_at, *picture, tile.view.organisms_at(blend), tile.camera);
    }
    const Sight& sight = pane.sight_of(tile);
    scene.draw(tile.view, blend, tile.camera, frame.width_pixels, frame.height_pixels, sight, marked);
    if (!sight.shows_density(tile.camera)) {
        const Rectangle& seen = tile.camera.viewport();
        ImDrawList& list = *ImGui::GetBackgroundDrawList();
        list.PushClipRect({static_cast<float>(seen.left), static_cast<float>(seen.top)},
                          {static_cast<float>(seen.left + seen.width), static_cast<float>(seen.top + seen.height)});
        scene.draw_labels(tile.view, blend, tile.camera, list, gui_.label());
        list.PopClipRect();
    }
    if (pane.watch.all_islands()) {
        overlay_.build_tile(tile.island, gui_, tile.camera.viewport(), chosen);
    }
    if (picture != nullptr && chosen) {
        build_legend(legend_of(sight, *picture, scene.density_scale(), scene.density_cell_px()), tile.camera, gui_);
        if (sight.shown.minimap) {
            pane.minimap.build(pane.watch, tile.camera, gui_, pane_number);
        }
    }
    if (marked.pointed_at) {
        overlay_.build_organism(*picture, *marked.pointed_at, *frame.pointed_at, gui_);
    }
}

void Stage::draw(const std::function<void(const Gui&)>& build, const Frame& frame) {
    gui_.begin(frame.width_pixels, frame.height_pixels, std::chrono::duration<double>{frame.now - drawn_}.count());
    drawn_ = frame.now;
    clear(palette::background, frame);
    build(gui_);
    gui_.draw();
}

sf::Image Stage::capture(const Frame& frame, const std::function<void()>& draw) {
    return draw_off_screen(frame.width_pixels, frame.height_pixels, draw);
}

} // namespace evod::viewer
