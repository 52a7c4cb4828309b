#include "client/viewer/drawing/widgets.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/text/lines.h"

#include <utility>

namespace evod::viewer {

void Spots::begin_frame() {
    shown_ = std::exchange(building_, {});
    panel_.clear();
}

void Spots::add(std::string_view name, Point centre) {
    if (!panel_.empty()) {
        building_.insert_or_assign(panel_ + "/" + std::string{name}, centre);
    }
    building_.insert_or_assign(std::string{name}, centre);
}

std::optional<Point> Spots::find(const std::string& name) const {
    const auto found = shown_.find(name);
    return found == shown_.end() ? std::nullopt : std::optional{found->second};
}

bool Spots::lingers(Point corner, double now_s, bool clicked) {
    constexpr double rest_s = 0.5, gap_s = 0.25; // a slow machine draws four times a second
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

/// Small text, in lines that Dear ImGui would break within a number.
void write_lines(std::string_view text, float width_max) {
    const std::string lines = in_lines(text, width_max, [](std::string_view line) {
        return ImGui::CalcTextSize(line.data(), line.data() + line.size()).x;
    });
    ImGui::TextUnformatted(lines.data(), lines.data() + lines.size());
}

} // namespace

void mark(std::string_view name) {
    auto* spots = static_cast<Spots*>(ImGui::GetIO().UserData);
    if (spots != nullptr && ImGui::IsItemVisible()) {
        const ImVec2 least = ImGui::GetItemRectMin(), most = ImGui::GetItemRectMax();
        spots->add(name, {(least.x + most.x) / 2.0, (least.y + most.y) / 2.0});
    }
}

bool button(const char* label) {
    const bool pressed = ImGui::Button(label);
    mark(label);
    return pressed;
}

bool window_pressed() {
    constexpr ImGuiHoveredFlags in_any_case = ImGuiHoveredFlags_AllowWhenBlockedByActiveItem; // a field that is left
    return ImGui::IsWindowHovered(in_any_case) && (ImGui::IsMouseClicked(0) || ImGui::IsMouseClicked(1));
}

void say(std::string_view text, Colour colour) {
    ImGui::PushStyleColor(ImGuiCol_Text, ink(colour));
    write_lines(text, ImGui::GetContentRegionAvail().x);
    ImGui::PopStyleColor();
}

bool wants_note() {
    auto* spots = static_cast<Spots*>(ImGui::GetIO().UserData);
    const ImVec2 corner = ImGui::GetItemRectMin();
    const auto clicked = [](ImGuiMouseButton button) {
        return ImGui::IsMouseDown(button) || ImGui::IsMouseReleased(button);
    };
    return spots != nullptr && ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled) &&
           spots->lingers({corner.x, corner.y}, ImGui::GetTime(), clicked(0) || clicked(1));
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
