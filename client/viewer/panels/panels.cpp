#include "client/viewer/panels/panels.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/widgets.h"
#include "client/viewer/panels/organism_panel.h"
#include "client/viewer/panels/parameters_panel.h"
#include "client/viewer/panels/run_panel.h"
#include "client/viewer/panels/view_panel.h"
#include "client/viewer/panels/worlds_panel.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace evod::viewer {

namespace {

constexpr std::size_t tabs_per_row = 5;

ImVec2 corner_of(Rectangle place) {
    return {static_cast<float>(place.left), static_cast<float>(place.top)};
}

ImVec2 size_of(Rectangle place) {
    return {static_cast<float>(place.width), static_cast<float>(place.height)};
}

} // namespace

// F1 shows the help, F12 collapses the sidebar. The other function keys belonged to panels that are now in the page
// (page_panels.cpp).
Panels::Panels() {
    places_.push_back({std::make_unique<WorldsPanel>(), 2});
    places_.push_back({std::make_unique<RunPanel>(), 3});
    places_.push_back({std::make_unique<ParametersPanel>(), 4});
    places_.push_back({std::make_unique<ViewPanel>(), 5});
    places_.push_back({std::make_unique<OrganismPanel>(), 6});
    for (const Place& place : places_) {
        titles_.push_back(place.panel->title());
    }
    show("Parameters");
}

std::optional<std::size_t> Panels::panel_at(unsigned function_key) const {
    const auto found = std::ranges::find(places_, function_key, &Place::function_key);
    return found == places_.end() ? std::nullopt : std::optional{static_cast<std::size_t>(found - places_.begin())};
}

bool Panels::shown(std::size_t index) const {
    return index == tab_ && !collapsed_;
}

void Panels::show(std::size_t index) {
    if (index < places_.size()) {
        tab_ = index;
        places_[index].to_front = true;
        collapsed_ = false;
    }
}

void Panels::show(std::string_view title) {
    const auto found = std::ranges::find(titles_, title);
    show(static_cast<std::size_t>(found - titles_.begin()));
}

double Panels::width(unsigned window_pixels, double scale) const {
    return collapsed_ ? std::round(sidebar_collapsed * scale) : sidebar_pixels(window_pixels, scale);
}

void Panels::build(Panel::Context context, Rectangle sidebar) {
    if (collapsed_) {
        build_collapsed(sidebar, context.gui.scale());
    } else {
        build_sidebar(context, sidebar);
    }
}

void Panels::build_collapsed(Rectangle sidebar, float scale) {
    ImGui::SetNextWindowPos(corner_of(sidebar));
    ImGui::SetNextWindowSize(size_of(sidebar));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {1 * scale, 6 * scale});
    ImGui::Begin("##collapsed", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoFocusOnAppearing);
    if (ImGui::Button("«", {24 * scale, 24 * scale})) {
        toggle_sidebar();
    }
    widgets::mark("Show the sidebar");
    widgets::explain("Shows the sidebar (F12).");
    ImGui::End();
    ImGui::PopStyleVar();
}

void Panels::build_sidebar(Panel::Context& context, Rectangle sidebar) {
    const float scale = context.gui.scale();
    ImGui::SetNextWindowPos(corner_of(sidebar));
    ImGui::SetNextWindowSize(size_of(sidebar));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {12 * scale, 8 * scale});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
    ImGui::Begin("##sidebar", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoScrollWithMouse | ImGuiWindowFlags_NoBringToFrontOnFocus |
                     ImGuiWindowFlags_NoFocusOnAppearing);
    context.gui.widget_positions().begin_panel("Sidebar");
    summary_.build_title(context.world);
    build_corner(scale);
    constexpr float summary_height = 345; // with the tabs, in pixels at scale 1
    summary_.build(context, static_cast<float>(sidebar.height) >= summary_height * scale);
    ImGui::Separator();
    context.gui.widget_positions().begin_panel("Tabs");
    build_tabs(context.gui);
    context.gui.widget_positions().begin_panel({});
    if (std::exchange(places_[tab_].to_front, false)) {
        ImGui::SetNextWindowFocus();
    }
    ImGui::BeginChild(titles_[tab_].data());
    build_panel(tab_, context);
    ImGui::EndChild();
    ImGui::End();
    ImGui::PopStyleVar(2);
}

void Panels::build_tabs(const Gui& gui) {
    const float scale = gui.scale(), gap = 4 * scale, row_width = ImGui::GetContentRegionAvail().x;
    const auto text_width = [&](std::size_t i) { return ImGui::CalcTextSize(titles_[i].data()).x; };
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {gap, gap});
    float room = 0; // of each tab of the row, around its text
    for (std::size_t i = 0; i < places_.size(); ++i) {
        const std::size_t end = std::min(i - i % tabs_per_row + tabs_per_row, places_.size());
        if (i % tabs_per_row == 0) {
            const auto count = static_cast<float>(end - i);
            room = row_width - gap * (count - 1);
            for (std::size_t k = i; k < end; ++k) {
                room -= text_width(k);
            }
            room /= count;
        }
        const bool chosen = i == tab_;
        ImGui::PushStyleColor(ImGuiCol_Button, chosen ? ink(palette::focus) : ImGui::GetColorU32(ImGuiCol_Button));
        ImGui::PushStyleColor(ImGuiCol_Text, chosen ? ink(palette::note_text) : ImGui::GetColorU32(ImGuiCol_Text));
        if (ImGui::Button(titles_[i].data(), {text_width(i) + room, 25 * scale})) {
            show(i);
        }
        ImGui::PopStyleColor(2);
        widgets::mark(titles_[i]);
        widgets::explain(std::string{titles_[i]} + " (" + key_of(i) + ")");
        if (i + 1 < end) {
            ImGui::SameLine();
        }
    }
    ImGui::PopStyleVar();
}

/// Builds the small button in the upper right corner of the sidebar.
void Panels::build_corner(float scale) {
    const float size = 24 * scale;
    ImGui::SameLine(std::max(ImGui::GetWindowContentRegionMax().x - size, 0.f));
    if (ImGui::Button("»", {size, size})) {
        toggle_sidebar();
    }
    widgets::mark("Collapse the sidebar");
    widgets::explain("Collapses the sidebar (F12).");
}

void Panels::build_panel(std::size_t index, Panel::Context& context) {
    Place& place = places_[index];
    context.just_shown = place.built != ImGui::GetFrameCount() - 1;
    context.gui.widget_positions().begin_panel(titles_[index]);
    place.panel->build(context);
    context.gui.widget_positions().begin_panel({});
    place.built = ImGui::GetFrameCount();
}

} // namespace evod::viewer
