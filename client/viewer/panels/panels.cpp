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

bool Panels::take(const sf::Event::KeyEvent& key) const {
    return keyboard_ && shown(*keyboard_) && places_[*keyboard_].panel->takes_keys() && !key.alt && !key.system &&
           std::ranges::any_of(keys_of(*keyboard_), [&](const Panel::Key& its) {
               return its.key == key.code && its.control == key.control && its.shift == key.shift;
           });
}

void Panels::begin_session() {
    Panels fresh;
    for (std::size_t i = 0; i < places_.size(); ++i) {
        fresh.places_[i].shown = places_[i].shown;
    }
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
        // Where not all names fit, the keys do, and the names come up at the mouse.
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

void Panels::build(Panel::Context context) {
    build_strip(context.gui);
    const float scale = context.gui.scale();
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    const Rectangle island =
        viewport_of(below_panel_strip(static_cast<unsigned>(window.x), static_cast<unsigned>(window.y), scale), scale);
    keyboard_.reset();
    for (std::size_t i = 0; i < places_.size(); ++i) {
        Place& place = places_[i];
        if (!place.shown) {
            continue;
        }
        const std::string title{place.panel->title()};
        const Panel::Size size = place.panel->first_size();
        const float width = std::min(size.width * scale, window.x),
                    height = std::min(size.height * scale, static_cast<float>(island.height) - 16 * scale);
        // In turn at the right and at the left, each pair a little lower and further in: every title can be seen.
        const float margin = 8 * scale, step = margin + 26 * scale * static_cast<float>(i / 2 % 6);
        const float top = static_cast<float>(island.top), bottom = top + static_cast<float>(island.height);
        ImGui::SetNextWindowSize({width, height}, ImGuiCond_FirstUseEver);
        ImGui::SetNextWindowPos({i % 2 == 0 ? std::max(window.x - width - step, 0.f) : step,
                                 std::min(top + step, bottom - height - margin)},
                                ImGuiCond_FirstUseEver);
        const bool was_shown = place.built == ImGui::GetFrameCount() - 1;
        if (ImGui::Begin(title.c_str(), &place.shown, ImGuiWindowFlags_NoCollapse)) {
            context.shown_anew = !was_shown;
            context.gui.spots().begin_panel(title);
            place.panel->build(context);
            context.gui.spots().begin_panel({});
            place.built = ImGui::GetFrameCount();
        }
        if (ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows)) {
            use(i);
            keyboard_ = i;
        }
        ImGui::End();
    }
}

} // namespace evod::viewer
