#include "client/viewer/panes/window_renderer.h"

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

/// Returns the point of an island at a point of the screen, and what is drawn there; nullopt if the island is not
/// there.
std::optional<MouseTool::Target> target_at(Point screen, std::uint32_t island, const core::SnapshotInterpolator& view,
                                           double blend, const Camera& camera) {
    const codec::ReceivedSnapshot* snapshot = view.latest().get();
    if (snapshot == nullptr || !camera.viewport().contains(screen)) {
        return std::nullopt;
    }
    const Point place = camera.to_world(screen);
    const Rectangle whole{0, 0, snapshot->about.width_px(), snapshot->about.height_px()};
    if (!whole.contains(place)) {
        return std::nullopt;
    }
    const codec::QuantisedSnapshot& entities = *snapshot->entities;
    const auto id_of = [](const codec::Entities& of, std::optional<std::size_t> index) {
        return index ? std::optional{of.id[*index]} : std::nullopt;
    };
    const double radius_px = snapshot->about.item_radius_px();
    return MouseTool::Target{.island = island,
                             .generation = snapshot->about.generation(),
                             .x_px = place.x,
                             .y_px = place.y,
                             .organism =
                                 id_of(entities.organisms, organism_at(screen, view.organisms_at(blend), camera)),
                             .food = id_of(entities.food, item_at(screen, entities.food, radius_px, camera)),
                             .poison = id_of(entities.poison, item_at(screen, entities.poison, radius_px, camera))};
}

/// Draws a circle where the tool would place something.
void draw_preview(MouseTool::Kind kind, double item_radius_px, Point screen, const Camera& camera) {
    const Colour colour = kind == MouseTool::Kind::Food     ? palette::food
                          : kind == MouseTool::Kind::Poison ? palette::poison
                                                            : palette::organism;
    const double radius_px = kind == MouseTool::Kind::Organism ? typical_radius_px : item_radius_px;
    const auto radius = static_cast<float>(std::max(radius_px * camera.zoom(), 3.0));
    const ImVec2 centre{static_cast<float>(screen.x), static_cast<float>(screen.y)};
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.AddCircleFilled(centre, radius, ink(faint(colour, 110)));
    list.AddCircle(centre, radius, ink(colour), 0, 2);
}

} // namespace

void WindowRenderer::click_at(Pane& pane, Point screen, std::optional<std::uint32_t> organism) {
    const MouseTool& tool = panels_.tool();
    if (tool.kind() == MouseTool::Kind::Select) {
        return select(pane, organism);
    }
    const core::SnapshotInterpolator& view = pane.world.feed.view();
    if (auto target = target_at(screen, pane.world.feed.island(), view, drawn_blend(view), pane.camera())) {
        target->organism = organism;
        tool.click(pane.world, *target);
    }
}

double WindowRenderer::drawn_blend(const core::SnapshotInterpolator& view) const {
    return interpolated_ ? view.blend_at(drawn_) : 1;
}

std::optional<std::uint32_t> WindowRenderer::organism_drawn_at(Pane& pane, Point screen) const {
    const codec::ReceivedSnapshot* snapshot = pane.world.feed.snapshot();
    if (snapshot == nullptr) {
        return std::nullopt;
    }
    const core::SnapshotInterpolator& view = pane.world.feed.view();
    const auto index = organism_at(screen, view.organisms_at(drawn_blend(view)), pane.camera());
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

void WindowRenderer::draw(Panes& panes, const Frame& wanted) {
    Frame frame = wanted;
    const double sidebar = frame.interactive ? panels_.width(frame.width_pixels, gui_.scale()) : 0;
    const Rectangle worlds{0, 0, std::max(frame.width_pixels - sidebar, 1.0), double(frame.height_pixels)};
    panes.lay_out(worlds, frame.interactive, gui_.scale());
    gui_.begin(frame.width_pixels, frame.height_pixels, std::chrono::duration<double>{frame.now - drawn_}.count());
    drawn_ = frame.now;
    if (panels_.tool().dragging()) { // the sidebar has the mouse, but the islands show where the drag would end
        frame.pointed_at = Point{ImGui::GetIO().MousePos.x, ImGui::GetIO().MousePos.y};
    }
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
    Rectangle above_timelines = worlds; // notices cover no time line
    for (std::size_t i = 0; i < panes.size(); ++i) {
        above_timelines.height = std::min(above_timelines.height, worlds.height - panes[i].timeline_place().height);
    }
    overlay_.build(gui_, panels_, above_timelines, frame.now);
    if (frame.interactive) {
        panels_.build({panes.focused().world, gui_, frame.now, panes.focused().island_view},
                      {worlds.width, 0, sidebar, worlds.height});
    }
    if (panels_.tool().take_drop()) {
        drop_at_mouse(panes);
    }
    gui_.draw();
}

/// Places the organism that the user has dragged to an island.
void WindowRenderer::drop_at_mouse(Panes& panes) {
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const Point screen{mouse.x, mouse.y};
    const bool covered = ImGui::IsWindowHovered(ImGuiHoveredFlags_AnyWindow);
    if (!covered && panes.focus_at(screen)) {
        click_at(panes.focused(), screen, organism_drawn_at(panes.focused(), screen));
    }
    panels_.tool().choose(MouseTool::Kind::Select);
}

void WindowRenderer::draw_tile(Pane& pane, const Tile& tile, IslandRenderer& renderer, const Frame& frame,
                               int pane_number) {
    const bool chosen = tile.island == pane.world.feed.island();
    const double blend = frame.interpolate ? tile.view.blend_at(frame.now) : 1;
    const codec::ReceivedSnapshot* snapshot = tile.view.latest().get();
    IslandRenderer::Highlighted highlighted;
    if (snapshot != nullptr && frame.pointed_at) {
        highlighted.pointed_at = organism_at(*frame.pointed_at, tile.view.organisms_at(blend), tile.camera);
    }
    if (chosen) { // also before the first snapshot: the panels must not use the data of the island shown before
        pane.island_view.update(pane.world, tile.camera, frame.now, highlighted.pointed_at.has_value());
    }
    if (snapshot != nullptr && chosen) {
        pane.island_view.follow(pane.world, tile.camera, blend);
        if (const auto selected = pane.world.feed.selected()) {
            highlighted.selected = snapshot->entities->organisms.index_of(*selected);
        }
    }
    const IslandView& island_view = pane.island_view_of(tile);
    renderer.draw(tile.view, blend, tile.camera, frame.width_pixels, frame.height_pixels, island_view, highlighted);
    const Look look = island_view.options.look;
    if (!renderer.density_scale()) {
        const Rectangle& viewport = tile.camera.viewport();
        ImDrawList& list = *ImGui::GetBackgroundDrawList();
        list.PushClipRect(
            {static_cast<float>(viewport.left), static_cast<float>(viewport.top)},
            {static_cast<float>(viewport.left + viewport.width), static_cast<float>(viewport.top + viewport.height)});
        const auto healthiest = pane.world.feed.healthiest(tile.island, HealthRanking::named_count);
        renderer.draw_labels(tile.view, blend, tile.camera, look, highlighted, healthiest, list, gui_.label());
        list.PopClipRect();
    }
    if (pane.world.feed.all_islands()) {
        overlay_.build_tile(tile.island, gui_, tile.camera.viewport(), chosen);
    }
    if (snapshot != nullptr && chosen) {
        build_legend(legend_of(island_view, *snapshot, renderer.density_scale(), renderer.density_cell_px()),
                     tile.camera, gui_, look, marks_);
        if (island_view.options.minimap) {
            pane.minimap.build(pane.world, tile.camera, gui_, look, pane_number);
        }
    }
    if (const MouseTool& tool = panels_.tool(); tool.kind() != MouseTool::Kind::Select && frame.pointed_at) {
        if (const auto target = target_at(*frame.pointed_at, tile.island, tile.view, blend, tile.camera)) {
            if (tool.kind() != MouseTool::Kind::Remove) {
                draw_preview(tool.kind(), snapshot->about.item_radius_px(), *frame.pointed_at, tile.camera);
            }
            const std::string problem = tool.problem(tool.kind(), pane.world);
            overlay_.build_hint(problem.empty() ? tool.hint(*target) : problem, *frame.pointed_at, gui_);
        }
    } else if (highlighted.pointed_at) {
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
