#include "client/viewer/panes/tour.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/palette.h"
#include "client/viewer/drawing/widgets.h"

#include <imgui.h>
#include <imgui_internal.h> // BringWindowToDisplayFront()

#include <algorithm>
#include <iterator>
#include <string>

namespace evod::viewer {

namespace {

struct Callout {
    const char* widget; // the widget that it explains; empty: the island
    const char *title, *text;
};
constexpr Callout callouts[] = {
    {"", "The island",
     "Here the organisms live, seek food and avoid poison. The legend in the sidebar explains the marks. Click an "
     "organism to inspect it; the wheel zooms."},
    {"Sidebar/Run or pause", "Run and pause",
     "Starts and pauses the world, like the space bar. \"One generation\" runs it to the end of the generation."},
    {"Sidebar/speed", "Speed",
     "Drag to run the world faster or slower. The key M switches to the maximum speed and back."},
    {"Sidebar/Fitness curve", "Fitness",
     "The fitness of the best organism and the mean of all, generation by generation. The curves rise while the "
     "population evolves."},
    {"Tabs/Parameters", "Panels",
     "Parameters changes the experiment while it runs. Plots draws its statistics. The page in a browser also shows "
     "how "
     "the parents of a generation were picked; Ctrl+C copies a link to it."},
    {"Sidebar/Replay or live", "Earlier generations",
     "Replay returns to any moment of the run; the world itself continues. The key H lists all keys and shows this "
     "tour "
     "again."},
};

// The following lengths are in pixels at scale 1.
constexpr float callout_width = 300, callout_distance = 26, frame_gap = 4, arrow_max = 45;

/// Frames the widget and draws an arrow to it. If other widgets are in between, draws a line below them instead.
void point_at(Rectangle widget, ImVec2 from, float scale) {
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    const ImVec2 least{static_cast<float>(widget.left), static_cast<float>(widget.top)},
        most{least.x + static_cast<float>(widget.width), least.y + static_cast<float>(widget.height)};
    const float gap = frame_gap * scale, size = 9 * scale;
    list.AddRect({least.x - gap, least.y - gap}, {most.x + gap, most.y + gap}, ink(palette::focus), 6 * scale, 0,
                 3 * scale);
    if (least.x - from.x > arrow_max * scale) {
        const float below = most.y + gap;
        list.AddLine({from.x, below}, {least.x + gap, below}, ink(palette::focus), 3 * scale);
        return;
    }
    const float x = least.x - gap - 2 * scale, y = std::clamp(from.y, least.y, most.y);
    list.AddTriangleFilled({x - size * 1.6f, y - size}, {x - size * 1.6f, y + size}, {x, y}, ink(palette::focus));
    list.AddLine(from, {x - size * 1.6f, y}, ink(palette::focus), 3 * scale);
}

} // namespace

void Tour::next() {
    step_ = *step_ + 1 < std::size(callouts) ? std::optional{*step_ + 1} : std::nullopt;
}

void Tour::back() {
    step_ = *step_ == 0 ? 0 : *step_ - 1;
}

bool Tour::handle(sf::Keyboard::Key key) {
    if (!shown()) {
        return false;
    }
    switch (key) {
    case sf::Keyboard::Right:
    case sf::Keyboard::Enter:
        next();
        return true;
    case sf::Keyboard::Left:
        back();
        return true;
    case sf::Keyboard::Escape:
        skip();
        return true;
    default:
        return false;
    }
}

void Tour::build(const Gui& gui, Rectangle worlds) {
    if (!shown()) {
        return;
    }
    const Callout& callout = callouts[*step_];
    const float scale = gui.scale();
    std::optional<Rectangle> widget;
    if (const auto found = gui.widget_positions().find(callout.widget); !found.empty() && found.front()->visible) {
        widget = found.front()->place;
    }
    // At the edge of the sidebar beside its widget, or in the middle of the worlds.
    const double right = worlds.left + worlds.width - callout_distance * scale; // the sidebar stays free
    const Point anchor = widget ? Point{std::min(widget->left, right), widget->centre().y} : worlds.centre();
    ImGui::SetNextWindowPos({static_cast<float>(anchor.x), static_cast<float>(anchor.y)}, ImGuiCond_Always,
                            widget ? ImVec2{1, 0.3f} : ImVec2{0.5f, 0.5f});
    ImGui::SetNextWindowSize({callout_width * scale, 0});
    Colour background = palette::note;
    background.alpha = 255; // readable over the marks of an island
    ImGui::PushStyleColor(ImGuiCol_WindowBg, ink(background));
    ImGui::PushStyleColor(ImGuiCol_Text, ink(palette::note_text));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {16 * scale, 12 * scale});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 8 * scale);
    ImGui::Begin("##tour", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoFocusOnAppearing);
    ImGui::BringWindowToDisplayFront(ImGui::GetCurrentWindow());
    gui.widget_positions().begin_panel("Tour");
    ImGui::PushFont(&gui.title());
    ImGui::TextUnformatted(callout.title);
    ImGui::PopFont();
    widgets::mark(callout.title);
    widgets::small_text(callout.text, palette::note_text);
    ImGui::Dummy({0, 4 * scale});
    const std::string count = std::to_string(*step_ + 1) + " of " + std::to_string(std::size(callouts));
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(count.c_str());
    const bool last = *step_ + 1 == std::size(callouts);
    ImGui::SameLine(ImGui::GetContentRegionMax().x - 152 * scale);
    ImGui::PushStyleColor(ImGuiCol_Button, 0);
    ImGui::BeginDisabled(*step_ == 0);
    const bool wants_back = widgets::button("Back");
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(last);
    const bool wants_skip = widgets::button("Skip");
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::PushStyleColor(ImGuiCol_Button, ink(palette::focus));
    const bool wants_next = widgets::button(last ? "Done" : "Next");
    ImGui::PopStyleColor(2);
    const ImVec2 corner = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
    gui.widget_positions().begin_panel({});
    ImGui::End();
    ImGui::PopStyleVar(2);
    ImGui::PopStyleColor(2);
    if (widget) {
        const auto y = static_cast<float>(widget->centre().y);
        point_at(*widget, {corner.x + size.x, std::clamp(y, corner.y, corner.y + size.y)}, scale);
    }
    if (wants_skip) {
        skip();
    } else if (wants_next) {
        next();
    } else if (wants_back) {
        back();
    }
}

} // namespace evod::viewer
