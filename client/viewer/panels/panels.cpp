#include "client/viewer/panels/panels.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/widgets.h"
#include "client/viewer/drawing/window_layout.h"
#include "client/viewer/panels/breeding/breeding_panel.h"
#include "client/viewer/panels/organism_panel.h"
#include "client/viewer/panels/parameters_panel.h"
#include "client/viewer/panels/physics/physics_panel.h"
#include "client/viewer/panels/plots/plots_panel.h"
#include "client/viewer/panels/run_panel.h"
#include "client/viewer/panels/view_panel.h"
#include "client/viewer/panels/worlds_panel.h"

#include <imgui.h>

#include <algorithm>
#include <string>

namespace evod::viewer {

std::string panel_key(std::size_t index) {
    return index < panel_key_count ? "F" + std::to_string(index + 2) : "";
}

Panels::Panels() {
    places_.push_back({std::make_unique<WorldsPanel>()});
    places_.push_back({std::make_unique<RunPanel>()});
    places_.push_back({std::make_unique<ParametersPanel>()});
    places_.push_back({std::make_unique<ViewPanel>()});
    places_.push_back({std::make_unique<OrganismPanel>()});
    places_.push_back({std::make_unique<PlotsPanel>()});
    places_.push_back({std::make_unique<BreedingPanel>()});
    places_.push_back({std::make_unique<PhysicsPanel>()});
    for (const Place& place : places_) {
        titles_.push_back(place.panel->title());
    }
}

void Panels::toggle(std::size_t index) {
    if (index < places_.size()) {
        places_[index].shown = !places_[index].shown;
        use(index);
    }
}

void Panels::use(std::size_t index) {
    std::erase(used_, index);
    used_.push_back(index);
}

void Panels::show(std::string_view title) {
    for (std::size_t i = 0; i < places_.size(); ++i) {
        if (titles_[i] == title && !places_[i].shown) {
            toggle(i);
        }
    }
}

bool Panels::close_front() {
    const auto last = std::find_if(used_.rbegin(), used_.rend(), [this](std::size_t i) { return places_[i].shown; });
    if (last == used_.rend()) {
        return false;
    }
    places_[*last].shown = false;
    return true;
}

bool Panels::handles(const sf::Event::KeyEvent& key) const {
    return keyboard_ && shown(*keyboard_) && places_[*keyboard_].panel->takes_keys() && !key.alt && !key.system &&
           std::ranges::any_of(keys_of(*keyboard_), [&](const Panel::Key& handled) {
               return handled.key == key.code && handled.control == key.control && handled.shift == key.shift;
           });
}

void Panels::begin_session() {
    Panels fresh;
    for (std::size_t i = 0; i < places_.size(); ++i) {
        fresh.places_[i].shown = places_[i].shown;
        fresh.places_[i].at = places_[i].at;
        fresh.places_[i].put_at = places_[i].put_at;
    }
    fresh.room_ = room_;
    fresh.used_ = std::move(used_);
    *this = std::move(fresh);
}

void Panels::build_strip(const Gui& gui) {
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    const float scale = gui.scale();
    const Rectangle strip = panel_strip_of(static_cast<unsigned>(window.x), scale);
    ImGui::SetNextWindowPos({0, static_cast<float>(strip.top)});
    ImGui::SetNextWindowSize({window.x, static_cast<float>(strip.height)});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {10 * scale, 1 * scale});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0);
    ImGui::PushStyleVar(ImGuiStyleVar_FrameBorderSize, 0);
    ImGui::PushStyleVar(ImGuiStyleVar_FrameRounding, 4 * scale);
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {6 * scale, 2 * scale});
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {4 * scale, 0});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, ink(palette::strip));
    ImGui::Begin("##panels", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoFocusOnAppearing);
    const auto name_of = [&](std::size_t i) { return panel_key(i) + " " + std::string{titles_[i]}; };
    float width = 20 * scale;
    for (std::size_t i = 0; i < places_.size(); ++i) {
        width += ImGui::CalcTextSize(name_of(i).c_str()).x + 16 * scale;
    }
    for (std::size_t i = 0; i < places_.size(); ++i) {
        // If the names do not fit into the strip, the buttons show only the keys, and resting the mouse on a button
        // shows the name.
        const std::string name = width <= window.x || panel_key(i).empty() ? name_of(i) : panel_key(i);
        ImGui::PushStyleColor(ImGuiCol_Button,
                              places_[i].shown ? ImGui::GetStyleColorVec4(ImGuiCol_ButtonHovered) : ImVec4{0, 0, 0, 0});
        if (ImGui::Button(name.c_str())) {
            toggle(i);
        }
        ImGui::PopStyleColor();
        widgets::mark(titles_[i]);
        if (name != name_of(i)) {
            widgets::explain(titles_[i]);
        }
        ImGui::SameLine();
    }
    ImGui::End();
    ImGui::PopStyleColor();
    ImGui::PopStyleVar(7);
}

Rectangle Panels::place_for(std::size_t index, float scale) const {
    const Panel::Size size = places_[index].panel->first_size();
    const double margin = 8 * scale;
    const PlaceWanted wanted{.width = std::min<double>(size.width * scale, std::max(room_.width - 2 * margin, 1.0)),
                             .height = std::min<double>(size.height * scale, std::max(room_.height - 2 * margin, 1.0)),
                             .at_right = index % 2 == 0};
    std::vector<Rectangle> taken;
    for (std::size_t i = 0; i < places_.size(); ++i) {
        if (i != index && places_[i].shown && places_[i].at.width > 0) {
            taken.push_back(places_[i].at);
        }
    }
    if (const auto free = free_place(wanted, room_, taken, margin)) {
        return *free;
    }
    // Cascade the panels: each pair is placed a little lower and farther inside, so that every title bar stays visible.
    const double step = margin + 26 * scale * static_cast<double>(index / 2 % 6);
    const double right = room_.left + room_.width - wanted.width, bottom = room_.top + room_.height - wanted.height;
    return {wanted.at_right ? std::max(right - step, room_.left) : std::min(room_.left + step, right),
            std::max(std::min(room_.top + step, bottom - margin), room_.top), wanted.width, wanted.height};
}

void Panels::build(Panel::Context context, Rectangle room) {
    build_strip(context.gui);
    keyboard_.reset();
    if (room != room_) {
        room_ = room;
        for (Place& place : places_) {
            if (place.at == place.put_at) { // the user has not moved it
                place.at = {};
            }
        }
    }
    for (std::size_t i = 0; i < places_.size(); ++i) {
        Place& place = places_[i];
        if (!place.shown) {
            continue;
        }
        const std::string title{place.panel->title()};
        const bool was_shown = place.built == ImGui::GetFrameCount() - 1;
        const bool is_put = place.at.width <= 0 || (!was_shown && place.at == place.put_at);
        if (is_put) {
            const Rectangle to = place_for(i, context.gui.scale());
            ImGui::SetNextWindowPos({static_cast<float>(to.left), static_cast<float>(to.top)});
            ImGui::SetNextWindowSize({static_cast<float>(to.width), static_cast<float>(to.height)});
        }
        if (ImGui::Begin(title.c_str(), &place.shown, ImGuiWindowFlags_NoCollapse)) {
            context.just_shown = !was_shown;
            context.gui.widget_positions().begin_panel(title);
            place.panel->build(context);
            context.gui.widget_positions().begin_panel({});
            place.built = ImGui::GetFrameCount();
        }
        const ImVec2 corner = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
        place.at = {corner.x, corner.y, size.x, size.y};
        place.put_at = is_put ? place.at : place.put_at;
        if (ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows)) {
            use(i);
            keyboard_ = i;
        }
        ImGui::End();
    }
}

} // namespace evod::viewer
