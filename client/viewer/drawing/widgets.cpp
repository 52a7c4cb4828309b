#include "client/viewer/drawing/widgets.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/text/lines.h"

#include <utility>

namespace evod::viewer {

void WidgetPositions::begin_frame() {
    shown_ = std::exchange(building_, {});
    panel_.clear();
}

/// Calls `act` for both names of a widget: "Panel/name" and "name".
template <class Do>
void WidgetPositions::for_each_name(std::string_view name, Do act) {
    if (!panel_.empty()) {
        act(panel_ + "/" + std::string{name});
    }
    act(std::string{name});
}

void WidgetPositions::add(std::string_view name, Point centre) {
    for_each_name(name, [&](std::string full) {
        building_.insert_or_assign(std::move(full), Widget{.centre = centre, .choices = {}});
    });
}

void WidgetPositions::add_drop_down(std::string_view name, Point centre) {
    for_each_name(name, [&](std::string full) {
        building_.insert_or_assign(std::move(full), Widget{.centre = centre, .choices = {{}}});
    });
}

void WidgetPositions::add_choice(std::string_view drop_down, std::string_view choice, Point centre) {
    add(std::string{drop_down} + ": " + std::string{choice}, centre);
    for_each_name(drop_down, [&](const std::string& full) {
        if (const auto spot = building_.find(full); spot != building_.end() && spot->second.choices) {
            spot->second.choices->emplace_back(choice);
        }
    });
}

std::optional<Point> WidgetPositions::find(const std::string& name) const {
    const auto found = shown_.find(name);
    return found == shown_.end() ? std::nullopt : std::optional{found->second.centre};
}

const std::vector<std::string>* WidgetPositions::choices(const std::string& name) const {
    const auto found = shown_.find(name);
    return found == shown_.end() || !found->second.choices ? nullptr : &*found->second.choices;
}

bool WidgetPositions::mouse_rests(Point corner, double now_s, bool clicked) {
    constexpr double rest_s = 0.5,
                     gap_s = 0.25; // gap_s is long, because a slow machine draws only four frames per second
    if (corner != hovered_ || now_s - hovered_last_s_ > gap_s) {
        hovered_ = corner;
        hovered_since_s_ = now_s;
        clicked_ = false;
    }
    hovered_last_s_ = now_s;
    clicked_ = clicked_ || clicked;
    return !clicked_ && now_s - hovered_since_s_ >= rest_s;
}

namespace widgets {

namespace {

/// Writes small text. Breaks the lines here, because Dear ImGui would also break them within numbers.
void write_lines(std::string_view text, float width_max) {
    const std::string lines = in_lines(text, width_max, [](std::string_view line) {
        return ImGui::CalcTextSize(line.data(), line.data() + line.size()).x;
    });
    ImGui::TextUnformatted(lines.data(), lines.data() + lines.size());
}

/// Returns the register of widgets; null if no part of this rectangle is visible.
WidgetPositions* positions_of(ImVec2 least, ImVec2 most) {
    return ImGui::IsRectVisible(least, most) ? static_cast<WidgetPositions*>(ImGui::GetIO().UserData) : nullptr;
}

Point middle(ImVec2 least, ImVec2 most) {
    return {(least.x + most.x) / 2.0, (least.y + most.y) / 2.0};
}

} // namespace

void mark(std::string_view name) {
    const ImVec2 least = ImGui::GetItemRectMin(), most = ImGui::GetItemRectMax();
    if (WidgetPositions* positions = positions_of(least, most)) {
        positions->add(name, middle(least, most));
    }
}

bool button(const char* label) {
    const bool pressed = ImGui::Button(label);
    mark(label);
    return pressed;
}

bool checkbox(const char* label, bool& on) {
    const bool changed = ImGui::Checkbox(label, &on);
    mark(label);
    return changed;
}

bool begin_drop_down(const char* label, const char* chosen, std::string_view name) {
    // After an open list is drawn, Dear ImGui's "last widget" is the list. The position is therefore read before.
    const ImVec2 least = ImGui::GetCursorScreenPos();
    const ImVec2 most{least.x + ImGui::CalcItemWidth(), least.y + ImGui::GetFrameHeight()};
    if (WidgetPositions* positions = positions_of(least, most)) {
        positions->add_drop_down(name.empty() ? label : name, middle(least, most));
    }
    return ImGui::BeginCombo(label, chosen, ImGuiComboFlags_HeightLargest);
}

bool choice(std::string_view drop_down, const std::string& name, bool chosen) {
    const bool taken = ImGui::Selectable(name.c_str(), chosen);
    const ImVec2 least = ImGui::GetItemRectMin(), most = ImGui::GetItemRectMax();
    if (WidgetPositions* positions = positions_of(least, most)) {
        positions->add_choice(drop_down, name, middle(least, most));
    }
    return taken;
}

bool window_pressed() {
    constexpr ImGuiHoveredFlags in_any_case =
        ImGuiHoveredFlags_AllowWhenBlockedByActiveItem; // for example, while a field is being edited
    return ImGui::IsWindowHovered(in_any_case) && (ImGui::IsMouseClicked(0) || ImGui::IsMouseClicked(1));
}

void small_text(std::string_view text, Colour colour) {
    ImGui::PushStyleColor(ImGuiCol_Text, ink(colour));
    write_lines(text, ImGui::GetContentRegionAvail().x);
    ImGui::PopStyleColor();
}

bool wants_note() {
    auto* positions = static_cast<WidgetPositions*>(ImGui::GetIO().UserData);
    const ImVec2 corner = ImGui::GetItemRectMin();
    const auto clicked = [](ImGuiMouseButton button) {
        return ImGui::IsMouseDown(button) || ImGui::IsMouseReleased(button);
    };
    return positions != nullptr && ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled) &&
           positions->mouse_rests({corner.x, corner.y}, ImGui::GetTime(), clicked(0) || clicked(1));
}

void note(std::string_view text) {
    ImGui::BeginTooltip();
    write_lines(text, ImGui::GetFontSize() * 26);
    ImGui::EndTooltip();
}

void explain(std::string_view text) {
    if (wants_note()) {
        note(text);
    }
}

} // namespace widgets
} // namespace evod::viewer
