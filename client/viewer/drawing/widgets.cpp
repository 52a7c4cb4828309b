#include "client/viewer/drawing/widgets.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/text/lines.h"
#include "proto/text/number_text.h"

#include <imgui_internal.h> // ImGuiLastItemData, the window's clip rectangle

#include <algorithm>

namespace evod::viewer {

void WidgetPositions::end_frame(unsigned hovered) {
    shown_ = std::exchange(building_, {});
    hovered_id_ = hovered;
    panel_.clear();
    wanted_.clear();
}

void WidgetPositions::add(MarkedWidget widget) {
    widget.panel = panel_;
    building_.push_back(std::move(widget));
}

void WidgetPositions::add_choice(std::string_view drop_down, std::string_view choice, std::string_view alias,
                                 MarkedWidget widget) {
    const auto owner = std::ranges::find_if(building_, [&](const MarkedWidget& built) {
        return built.kind == MarkedWidget::Kind::DropDown && built.panel == panel_ && built.name == drop_down;
    });
    if (owner != building_.end()) {
        owner->choices.emplace_back(choice);
    }
    widget.name = std::string{drop_down} + ": " + std::string{choice};
    if (!alias.empty()) {
        widget.aliases = {std::string{drop_down} + ": " + std::string{alias}};
    }
    add(std::move(widget));
}

void WidgetPositions::add_alias(std::string_view alias) {
    if (!building_.empty()) {
        building_.back().aliases.emplace_back(alias);
    }
}

void WidgetPositions::explain(unsigned id, std::string_view note) {
    if (id != 0 && !building_.empty() && building_.back().id == id) {
        building_.back().note = note;
    }
}

std::vector<const MarkedWidget*> WidgetPositions::find(std::string_view name) const {
    std::vector<const MarkedWidget*> found;
    for (const MarkedWidget& widget : shown_) {
        std::string_view in_panel = name; // without the panel of the widget
        if (!widget.panel.empty() && name.starts_with(widget.panel + "/")) {
            in_panel.remove_prefix(widget.panel.size() + 1);
        }
        const auto is_named = [&](const std::string& own) { return own == name || own == in_panel; };
        if (is_named(widget.name) || std::ranges::any_of(widget.aliases, is_named)) {
            found.push_back(&widget);
        }
    }
    return found;
}

bool WidgetPositions::is_wanted(std::string_view name) const {
    return !wanted_.empty() && (name == wanted_ || panel_ + "/" + std::string{name} == wanted_);
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

/// Returns the register of widgets; null if the current window draws nothing.
WidgetPositions* positions() {
    return ImGui::GetCurrentWindow()->SkipItems ? nullptr : static_cast<WidgetPositions*>(ImGui::GetIO().UserData);
}

/// Completes and registers the description of a widget.
///
/// place  the part of the widget that reacts to clicks
/// flags  of Dear ImGui, which contain whether the widget is disabled
void add(MarkedWidget widget, ImRect place, ImGuiItemFlags flags) {
    if (WidgetPositions* all = positions()) {
        const ImVec2 centre = place.GetCenter();
        widget.place = {place.Min.x, place.Min.y, place.GetWidth(), place.GetHeight()};
        widget.enabled = (flags & ImGuiItemFlags_Disabled) == 0;
        // A widget may be wider than its column of a table, so the column's clip rectangle counts only vertically.
        const ImGuiWindow& window = *ImGui::GetCurrentWindow();
        widget.visible = window.InnerClipRect.Contains({centre.x, window.InnerClipRect.Min.y}) &&
                         centre.y >= window.ClipRect.Min.y && centre.y < window.ClipRect.Max.y;
        if (!widget.visible && all->is_wanted(widget.name)) {
            ImGui::SetScrollHereY();
        }
        all->add(std::move(widget));
    }
}

/// Registers the widget that was drawn last.
void add_last(MarkedWidget widget) {
    const ImGuiLastItemData& last = ImGui::GetCurrentContext()->LastItemData;
    widget.id = last.ID;
    add(std::move(widget), last.NavRect, last.InFlags);
}

} // namespace

void mark(std::string_view name) {
    add_last({.name = std::string{name}});
}

void alias(std::string_view name) {
    if (WidgetPositions* all = positions()) {
        all->add_alias(name);
    }
}

void mark_field(std::string_view name, std::string value) {
    add_last({.kind = MarkedWidget::Kind::Field, .name = std::string{name}, .value = std::move(value)});
}

void mark_field(std::string_view name, double value) {
    mark_field(name, text::number_text(value));
}

bool button(const char* label) {
    const bool pressed = ImGui::Button(label);
    mark(label);
    return pressed;
}

void end_popup_with_cancel() {
    ImGui::SameLine();
    if (button("Cancel")) {
        ImGui::CloseCurrentPopup();
    }
    ImGui::EndPopup();
}

bool checkbox(const char* label, bool& on, std::string_view name) {
    const bool changed = ImGui::Checkbox(label, &on);
    add_last({.kind = MarkedWidget::Kind::CheckBox,
              .name = std::string{name.empty() ? label : name},
              .value = on ? "on" : "off"});
    return changed;
}

bool begin_drop_down(const char* label, const char* chosen, std::string_view name) {
    // After an open list is drawn, Dear ImGui's "last widget" is the list. The widget is therefore registered before.
    const ImVec2 least = ImGui::GetCursorScreenPos();
    add({.kind = MarkedWidget::Kind::DropDown,
         .name = std::string{name.empty() ? label : name},
         .id = ImGui::GetID(label),
         .value = chosen},
        {least, {least.x + ImGui::CalcItemWidth(), least.y + ImGui::GetFrameHeight()}},
        ImGui::GetCurrentContext()->CurrentItemFlags);
    return ImGui::BeginCombo(label, chosen, ImGuiComboFlags_HeightLargest);
}

bool choice(std::string_view drop_down, const std::string& name, bool chosen, std::string_view alias) {
    const bool taken = ImGui::Selectable(name.c_str(), chosen);
    if (WidgetPositions* all = positions()) {
        const ImGuiLastItemData& last = ImGui::GetCurrentContext()->LastItemData;
        const ImRect& place = last.NavRect;
        all->add_choice(drop_down, name, alias,
                        {.place = {place.Min.x, place.Min.y, place.GetWidth(), place.GetHeight()}, .id = last.ID});
    }
    return taken;
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
    if (WidgetPositions* all = positions()) {
        all->explain(ImGui::GetItemID(), text);
    }
    if (wants_note()) {
        note(text);
    }
}

} // namespace widgets
} // namespace evod::viewer
