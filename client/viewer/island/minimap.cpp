#include "client/viewer/island/minimap.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/widgets.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace evod::viewer {

namespace {

constexpr std::size_t cells_max = 60; // along the island's longer side

ImVec2 vector(Point point) {
    return {static_cast<float>(point.x), static_cast<float>(point.y)};
}

} // namespace

Rectangle MinimapPlace::visible_part(const Rectangle& visible) const {
    const Point corner = to_screen({visible.left, visible.top});
    const Point other = to_screen({visible.left + visible.width, visible.top + visible.height});
    const auto across = [this](double x) { return std::clamp(x, screen.left, screen.left + screen.width); };
    const auto down = [this](double y) { return std::clamp(y, screen.top, screen.top + screen.height); };
    return {across(corner.x), down(corner.y), across(other.x) - across(corner.x), down(other.y) - down(corner.y)};
}

MinimapPlace minimap_place(const Rectangle& viewport, double island_width, double island_height, double scale) {
    MinimapPlace place;
    const double margin = MinimapPlace::margin_pixels * scale;
    place.zoom = scale * MinimapPlace::side_pixels_max / std::max(island_width, island_height);
    const double width = island_width * place.zoom, height = island_height * place.zoom;
    place.screen = {viewport.left + viewport.width - width - margin, viewport.top + viewport.height - height - margin,
                    width, height};
    return place;
}

bool is_whole_island_visible(const Camera& camera, double island_width, double island_height) {
    const Rectangle visible = camera.visible();
    return visible.contains({0, 0}) && visible.contains({island_width, island_height});
}

void Minimap::build(ViewedWorld& world, Camera& camera, const Gui& gui, Look look) {
    const std::shared_ptr<const codec::ReceivedSnapshot> snapshot =
        world.feed.overview() != nullptr ? world.feed.overview() : world.feed.view().latest();
    const double width = snapshot->about.width_px(), height = snapshot->about.height_px();
    if (is_whole_island_visible(camera, width, height)) {
        return;
    }
    if (snapshot != counted_) {
        grid_ = overview_of(*snapshot, cells_max);
        counted_ = snapshot;
    }
    const float pixel = gui.scale();
    const MinimapPlace place = minimap_place(camera.viewport(), width, height, double{pixel});
    const ImVec2 size{static_cast<float>(place.screen.width), static_cast<float>(place.screen.height)};
    const ImVec2 corner = vector({place.screen.left, place.screen.top});
    ImGui::SetNextWindowPos(corner);
    ImGui::SetNextWindowSize(size);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
    ImGui::Begin("##minimap", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoFocusOnAppearing |
                     ImGuiWindowFlags_NoBringToFrontOnFocus);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImVec2 other{corner.x + size.x, corner.y + size.y};
    const palette::IslandColours& colours = palette::of(look);
    list.AddRectFilled(corner, other, ink(colours.ground));
    const ColourScale scale = density_scale(std::span{&grid_, 1}, palette::Ramp::Viridis);
    const auto cell = static_cast<float>(grid_.cell_px * place.zoom);
    for (std::size_t i = 0; i < grid_.counts.size(); ++i) {
        if (grid_.counts[i] > 0) {
            Colour colour = colours.body;
            colour.alpha = static_cast<std::uint8_t>(60 + 195 * std::min(scale.share(grid_.counts[i]), 1.0));
            const ImVec2 from{corner.x + static_cast<float>(i % grid_.columns) * cell,
                              corner.y + static_cast<float>(i / grid_.columns) * cell};
            list.AddRectFilled(from, {std::min(from.x + cell, other.x), std::min(from.y + cell, other.y)}, ink(colour));
        }
    }
    list.PushClipRectFullScreen(); // half of each line lies outside the minimap's window
    list.AddRect(corner, other, ink(colours.wall));
    const Rectangle part = place.visible_part(camera.visible());
    // Draw the frame at least this large, so that it is easy to find.
    const ImVec2 middle = vector(part.centre());
    const ImVec2 half{std::max(static_cast<float>(part.width) / 2, 3 * pixel),
                      std::max(static_cast<float>(part.height) / 2, 3 * pixel)};
    list.AddRect({middle.x - half.x, middle.y - half.y}, {middle.x + half.x, middle.y + half.y}, ink(colours.selected),
                 0, 0, 2 * pixel);
    list.PopClipRect();
    ImGui::InvisibleButton("there", size);
    widgets::mark("minimap");
    if (ImGui::IsItemActive()) {
        const ImVec2 mouse = ImGui::GetIO().MousePos;
        camera.look_at(place.to_world({mouse.x, mouse.y}));
    }
    ImGui::End();
    ImGui::PopStyleVar(2);
}

} // namespace evod::viewer
