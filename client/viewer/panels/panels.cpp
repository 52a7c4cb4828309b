#include "client/viewer/panels/panels.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/widgets.h"
#include "client/viewer/panels/freezer_panel.h"
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

// F1 shows the help, F12 collapses the sidebar. The other function keys belonged to panels that are now in the page (page_panels.cpp).
Panels::Panels() {
    places_.push_back({std::make_unique<WorldsPanel>(), 2});
    places_.push_back({std::make_unique<RunPanel>(), 3});
    places_.push_back({std::make_unique<ParametersPanel>(), 4});
    places_.push_back({std::make_unique<ViewPanel>(), 5});
    places_.push_back({std::make_unique<OrganismPanel>(), 6});
    places_.push_back({std::make_unique<FreezerPanel>(), 10});
    for (const Place& place : places_) {
        titles_.push_back(place.panel->title());
    }
}

std::size_t Panels::tab() const {
    const auto found = std::ranges::find(titles_, settings_.tab);
    return found == titles_.end() ? 0 : static_cast<std::size_t>(found - titles_.begin());
}

std::optional<std::size_t> Panels::panel_at(unsigned function_key) const {
    const auto found = std::ranges::find(places_, function_key, &Place::function_key);
    return found == places_.end() ? std::nullopt : std::optional{static_cast<std::size_t>(found - places_.begin())};
}

void Panels::set(SidebarSettings settings) {
    settings_ = std::move(settings);
    settings_.tab = titles_[tab()]; // a stored title may be unknown
}

bool Panels::shown(std::size_t index) const {
    return index < places_.size() && (places_[index].detached || (index == tab() && !settings_.collapsed));
}

void Panels::show(std::size_t index) {
    if (index >= places_.size()) {
        return;
    }
    Place& place = places_[index];
    place.to_front = true;
    if (place.detached) {
        use(index);
    } else {
        settings_.tab = titles_[index];
        settings_.collapsed = false;
    }
}

void Panels::show(std::string_view title) {
    const auto found = std::ranges::find(titles_, title);
    show(static_cast<std::size_t>(found - titles_.begin()));
}

void Panels::use(std::size_t index) {
    std::erase(used_, index);
    used_.push_back(index);
}

void Panels::set_detached(std::size_t index, bool detached) {
    places_[index].detached = detached;
    std::erase(used_, index);
    if (detached) {
        used_.push_back(index);
    } else {
        show(index);
    }
}

bool Panels::close_front() {
    if (used_.empty()) {
        return false;
    }
    set_detached(used_.back(), false);
    return true;
}

bool Panels::handles(const sf::Event::KeyEvent& key) const {
    return keyboard_ && shown(*keyboard_) && !key.alt && !key.system &&
           std::ranges::any_of(keys_of(*keyboard_), [&](const Panel::Key& handled) {
               return handled.key == key.code && handled.control == key.control && handled.shift == key.shift;
           });
}

void Panels::begin_session() {
    Panels fresh;
    for (std::size_t i = 0; i < places_.size(); ++i) {
        fresh.places_[i].detached = places_[i].detached;
    }
    fresh.settings_ = std::move(settings_);
    fresh.freezer_ = std::move(freezer_);
    fresh.used_ = std::move(used_);
    *this = std::move(fresh);
}

double Panels::width(unsigned window_pixels, double scale) const {
    if (settings_.collapsed) {
        return std::round(sidebar_collapsed * scale);
    }
    return sidebar_pixels(settings_.width * scale, window_pixels, scale);
}

void Panels::build(Panel::Context context, Rectangle sidebar) {
    keyboard_.reset();
    context.freezer = &freezer_;
    context.new_world = &new_world_;
    context.tool = &tool_;
    if (context.world.take_new_world_offer()) {
        if (context.world.server.may_create()) {
            new_world_.open(true);
        } else {
            context.world.server.notice("There is no other world. " + std::string{no_creation_text});
        }
    }
    if (settings_.collapsed) {
        build_collapsed(sidebar, context.gui.scale());
    } else {
        build_sidebar(context, sidebar);
    }
    for (std::size_t i = 0; i < places_.size(); ++i) {
        if (places_[i].detached) {
            build_detached(i, context, sidebar);
        }
    }
    new_world_.build(context);
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

/// Builds the left edge of the sidebar, which the user drags to change its width.
void Panels::build_edge(Rectangle sidebar, float scale) {
    const float grip = 6 * scale;
    ImGui::SetCursorScreenPos(corner_of(sidebar));
    ImGui::InvisibleButton("##edge", {grip, static_cast<float>(sidebar.height)});
    widgets::mark("Width of the sidebar");
    const bool active = ImGui::IsItemActive();
    if (active || ImGui::IsItemHovered()) {
        ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
        const ImVec2 corner = corner_of(sidebar);
        ImGui::GetWindowDrawList()->AddRectFilled(
            corner, {corner.x + 2 * scale, corner.y + static_cast<float>(sidebar.height)}, ink(palette::focus));
    }
    if (active && ImGui::GetIO().MouseDelta.x != 0) {
        const float window = ImGui::GetIO().DisplaySize.x;
        const double wanted = window - ImGui::GetIO().MousePos.x;
        settings_.width = static_cast<float>(sidebar_pixels(wanted, static_cast<unsigned>(window), scale)) / scale;
    }
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
    const ImVec2 begin = ImGui::GetCursorPos();
    build_edge(sidebar, scale);
    ImGui::SetCursorPos(begin);
    context.gui.widget_positions().begin_panel("Sidebar");
    summary_.build_title(context.world);
    build_corner(scale);
    constexpr float summary_height = 345; // with the tabs, in pixels at scale 1
    summary_.build(context, static_cast<float>(sidebar.height) >= summary_height * scale);
    ImGui::Separator();
    context.gui.widget_positions().begin_panel("Tabs");
    build_tabs(context.gui);
    context.gui.widget_positions().begin_panel({});
    const std::size_t index = tab();
    Place& place = places_[index];
    if (place.detached) {
        widgets::small_text(std::string{titles_[index]} + " is in a window of its own.");
        if (widgets::button("Return it to the sidebar")) {
            set_detached(index, false);
        }
    } else {
        if (std::exchange(place.to_front, false)) {
            ImGui::SetNextWindowFocus();
        }
        ImGui::BeginChild(titles_[index].data());
        build_panel(index, context);
        ImGui::EndChild();
    }
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
        const bool chosen = i == tab();
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

/// Builds the small buttons in the upper right corner of the sidebar.
void Panels::build_corner(float scale) {
    const float size = 24 * scale, gap = 4 * scale;
    const bool detached = places_[tab()].detached;
    ImGui::SameLine(std::max(ImGui::GetWindowContentRegionMax().x - (detached ? size : 2 * size + gap), 0.f));
    if (!detached) {
        if (ImGui::Button("↗", {size, size})) {
            set_detached(tab(), true);
        }
        widgets::mark("Own window");
        widgets::explain(
            "Moves the panel below to a window of its own, over the worlds. Closing it returns the panel.");
        ImGui::SameLine(0, gap);
    }
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
    if (ImGui::IsWindowFocused(ImGuiFocusedFlags_ChildWindows)) {
        keyboard_ = index;
    }
}

void Panels::build_detached(std::size_t index, Panel::Context& context, Rectangle sidebar) {
    Place& place = places_[index];
    const float scale = context.gui.scale();
    const Panel::Size size = place.panel->first_size();
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    const float width = std::min(size.width * scale, window.x), height = std::min(size.height * scale, window.y);
    ImGui::SetNextWindowPos({std::max(static_cast<float>(sidebar.left) - width - 12 * scale, 0.f), 60 * scale},
                            ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowSize({width, height}, ImGuiCond_FirstUseEver);
    if (std::exchange(place.to_front, false)) {
        ImGui::SetNextWindowFocus();
    }
    bool open = true;
    if (ImGui::Begin(titles_[index].data(), &open, ImGuiWindowFlags_NoCollapse)) {
        build_panel(index, context);
    }
    if (ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows)) {
        use(index);
        keyboard_ = index;
    }
    ImGui::End();
    if (!open) {
        set_detached(index, false);
    }
}

} // namespace evod::viewer
