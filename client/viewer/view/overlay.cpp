#include "client/viewer/view/overlay.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/palette.h"
#include "client/viewer/drawing/widgets.h"
#include "client/viewer/drawing/window_layout.h"
#include "client/viewer/view/keys.h"
#include "client/viewer/world/status_text.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace evod::viewer {

namespace {

// The following lengths are in pixels at scale 1.
constexpr float edge = 14;         // distance between text and the window's edge
constexpr float help_width = 1060; // width of the help with two columns: keys of the window, keys of the panels
constexpr std::size_t notices_max = 4;

/// Draws a rounded box with text, horizontally centred in `place` with its upper edge at `top`. Returns its lower edge.
float text_box(ImDrawList& list, const Gui& gui, Rectangle place, float top, Colour background,
               const std::string& text) {
    const ImFont& font = gui.text();
    const float inside = 12 * gui.scale();
    const auto centre_x = static_cast<float>(place.centre().x);
    const float wrap_width = std::max(static_cast<float>(place.width) - 6 * inside, 100.f);
    const ImVec2 size = size_of(text, font, wrap_width);
    const ImVec2 corner{std::floor(centre_x - size.x / 2 - inside), std::floor(top)};
    const ImVec2 other{corner.x + size.x + 2 * inside, corner.y + size.y + 2 * inside};
    list.AddRectFilled(corner, other, ink(background), 6 * gui.scale());
    write(list, font, {corner.x + inside, corner.y + inside}, palette::note_text, text, wrap_width);
    return other.y;
}

Colour state_colour(const ViewedWorld& world) {
    const bool runs = world.server.connected() && world.feed.control().state() == evod::v1::RUN_STATE_RUNNING &&
                      !core::worlds_wait(world.feed.storage()) && world.feed.control().awaited_fitness() == nullptr;
    return runs ? palette::running : palette::stopped;
}

} // namespace

void Overlay::notice(std::string text, Clock::time_point now) {
    std::erase_if(notices_, [&](const Notice& shown) { return shown.text == text; });
    notices_.push_back({std::move(text), now + notice_shown});
    if (notices_.size() > notices_max) {
        notices_.pop_front();
    }
}

void Overlay::build_world(const ViewedWorld& world, const Gui& gui, Rectangle place) {
    build_strips(world, gui, place);
    build_connection(world, gui, place);
}

void Overlay::build(const Gui& gui, const Panels& panels, Rectangle worlds, Clock::time_point now) {
    build_notices(gui, worlds, now);
    if (help_) {
        build_help(gui, panels);
    }
}

void Overlay::build_strips(const ViewedWorld& world, const Gui& gui, Rectangle place) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const float scale = gui.scale(), margin = edge * scale, title_height = std::round(top_strip * scale);
    const auto left = static_cast<float>(place.left), right = left + static_cast<float>(place.width);
    const auto top = static_cast<float>(place.top), end = top + static_cast<float>(place.height);
    const float bottom = end - std::round(bottom_strip * scale);
    list.AddRectFilled({left, top}, {right, top + title_height}, ink(palette::strip));
    list.AddRectFilled({left, top + title_height - 1}, {right, top + title_height}, ink(palette::strip_edge));
    list.AddRectFilled({left, bottom}, {right, end}, ink(palette::strip));
    list.AddRectFilled({left, bottom}, {right, bottom + 1}, ink(palette::strip_edge));
    const codec::ReceivedSnapshot* snapshot = world.feed.snapshot();
    if (snapshot == nullptr) {
        return;
    }
    const ImFont& text = gui.text();
    float title_begin = left + margin;
    const float top_line = top + (title_height - text.FontSize) / 2 - 1;
    if (world.replay.info() != nullptr) {
        const std::string mark = replay_label(*world.replay.info());
        const float mark_end = title_begin + size_of(mark, text).x + 16 * scale;
        list.AddRectFilled({title_begin, top + 7 * scale}, {mark_end, top + title_height - 8 * scale},
                           ink(palette::replay), 4 * scale);
        write(list, text, {title_begin + 8 * scale, top_line}, palette::text, mark);
        title_begin = mark_end + margin;
    }
    const float title_end = write(list, gui.title(), {title_begin, top + (title_height - gui.title().FontSize) / 2 - 1},
                                  palette::text, generation_title(snapshot->about));

    const std::string state = world.state_text();
    const std::string help = "H help";
    const float help_begin = right - margin - size_of(help, text).x;
    const float state_begin = help_begin - 2 * margin - size_of(state, text).x;
    write(list, text, {help_begin, top_line}, palette::text_quiet, help);
    if (state_begin > title_end + margin) {
        write(list, text, {state_begin, top_line}, state_colour(world), state);
    }
    // The label of a replay has the name of the live world.
    const std::string name = world.replay.present().value_or(snapshot->about.world());
    const std::string where = world.server.connected()
                                  ? place_and_speed_text(name, snapshot->about, world.feed.control())
                                  : place_text(name, snapshot->about); // the speed is unknown
    for (const std::string& about : {where, name}) {
        const float about_begin = state_begin - 2 * margin - size_of(about, text).x;
        if (about_begin > title_end + margin) {
            write(list, text, {about_begin, top_line}, palette::text, about);
            break;
        }
    }

    float x = left + margin;
    for (const std::string& piece : statistics_texts(snapshot->about, world.feed.last_generation())) {
        if (x + size_of(piece, text).x > right - margin) {
            break;
        }
        x = write(list, text, {x, bottom + (end - bottom - text.FontSize) / 2 - 1}, palette::text, piece) + 26 * scale;
    }
}

void Overlay::build_connection(const ViewedWorld& world, const Gui& gui, Rectangle place) {
    const core::ConnectionStatus status = world.server.status();
    const std::string server = core::to_text(world.server.endpoint());
    const std::string problem = storage_text(world.feed.storage());
    std::string text;
    if (status.state == core::State::Failed) {
        text = "No connection to " + server + "\n" + world.server.problem();
    } else if (status.state != core::State::Connected) {
        const std::string why = world.server.problem();
        text = "Connecting to " + server + " …" + (why.empty() ? "" : "\n" + why + "; retrying");
    } else if (const auto refusal = world.refusal()) {
        text = *refusal + "\nW shows another world, Tab another island";
    } else if (world.feed.snapshot() == nullptr) {
        text = "Waiting for the first snapshot …" + (problem.empty() ? "" : "\n" + problem);
    } else if (!problem.empty()) {
        text = problem;
    } else {
        return;
    }
    const bool is_warning = status.state == core::State::Failed || world.refusal() ||
                            (status.state == core::State::Connected && !problem.empty());
    const double below = world.feed.snapshot() == nullptr ? place.height * 0.42 : (top_strip + 16) * gui.scale();
    text_box(*ImGui::GetForegroundDrawList(), gui, place, static_cast<float>(place.top + below),
             is_warning ? palette::warning : palette::note, text);
}

void Overlay::build_tile(std::uint32_t island, const Gui& gui, Rectangle place, bool chosen) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const float scale = gui.scale();
    const std::string text = "island " + std::to_string(island);
    const ImVec2 size = size_of(text, gui.label());
    const ImVec2 corner{static_cast<float>(place.left), static_cast<float>(place.top)};
    list.AddRectFilled(corner, {corner.x + size.x + 12 * scale, corner.y + size.y + 4 * scale},
                       ink(chosen ? palette::focus : palette::note), 3 * scale);
    write(list, gui.label(), {corner.x + 6 * scale, corner.y + 2 * scale}, palette::note_text, text);
}

void Overlay::build_notices(const Gui& gui, Rectangle worlds, Clock::time_point now) {
    while (!notices_.empty() && notices_.front().until < now) {
        notices_.pop_front();
    }
    std::string text;
    for (const Notice& notice : notices_) {
        text += (text.empty() ? "" : "\n") + notice.text;
    }
    if (!text.empty()) {
        // Above the title of the help, otherwise above the statistics.
        const float height = size_of(text, gui.text()).y;
        const float top =
            help_ ? 4 * gui.scale() : static_cast<float>(worlds.height) - (bottom_strip + 40) * gui.scale() - height;
        text_box(*ImGui::GetForegroundDrawList(), gui, worlds, top, palette::note, text);
    }
}

void Overlay::build_hint(const std::string& text, Point screen, const Gui& gui) {
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    const ImVec2 size = size_of(text, gui.label());
    const float scale = gui.scale();
    const ImVec2 corner{
        std::min(static_cast<float>(screen.x) + 16 * scale, window.x - size.x - 20 * scale),
        std::min(static_cast<float>(screen.y) + 16 * scale, window.y - (bottom_strip + 20) * scale - size.y)};
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    list.AddRectFilled(corner, {corner.x + size.x + 16 * scale, corner.y + size.y + 12 * scale}, ink(palette::note),
                       5 * scale);
    write(list, gui.label(), {corner.x + 8 * scale, corner.y + 6 * scale}, palette::note_text, text);
}

void Overlay::build_organism(const codec::ReceivedSnapshot& snapshot, std::size_t organism, Point screen,
                             const Gui& gui) {
    const codec::Entities& organisms = snapshot.entities->organisms;
    build_hint(print("organism %u\nhealth %.1f\nradius %.1f px", organisms.id[organism],
                     double{organisms.health(organism)}, double{organisms.radius_px(organism)}),
               screen, gui);
}

void Overlay::build_help(const Gui& gui, const Panels& panels) {
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    const float scale = gui.scale();
    ImGui::SetNextWindowPos({window.x / 2, window.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {18 * scale, 14 * scale});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 6 * scale);
    ImGui::PushStyleVar(ImGuiStyleVar_CellPadding, {10 * scale, 2 * scale});
    ImGui::Begin("Keys", &help_,
                 ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_HorizontalScrollbar);
    const auto build_lines = [](const char* name, std::span<const HelpLine> lines) {
        if (ImGui::BeginTable(name, 2, ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_NoHostExtendX)) {
            for (const HelpLine& line : lines) {
                for (const std::string& text : {line.keys, line.text}) {
                    ImGui::TableNextColumn();
                    ImGui::TextUnformatted(text.c_str());
                }
            }
            ImGui::EndTable();
        }
    };
    build_lines("of the window", help_lines());
    widgets::mark("Keys");
    if (window.x >= help_width * scale) {
        ImGui::SameLine(0, 16 * scale);
    }
    build_lines("of the panels", help_lines(panels));
    ImGui::End();
    ImGui::PopStyleVar(3);
}

} // namespace evod::viewer
