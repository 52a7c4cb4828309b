#include "client/viewer/overlay.h"

#include "client/viewer/palette.h"
#include "client/viewer/readout.h"
#include "client/viewer/scene.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace evod::viewer {

namespace {

constexpr float top_strip = 38, bottom_strip = 30; // heights in pixels
constexpr float edge = 14;                         // between text and the window's edge
constexpr std::chrono::seconds notice_shown{6};
constexpr std::size_t notices_max = 4;

ImU32 ink(Colour colour) {
    return IM_COL32(colour.red, colour.green, colour.blue, colour.alpha);
}

ImVec2 size_of(const std::string& text, const ImFont& font, float wrap_width = 0) {
    return font.CalcTextSizeA(font.FontSize, 1e9f, wrap_width, text.data(), text.data() + text.size());
}

/// Writes with the upper left corner at a whole pixel; returns where the text ends.
float write(ImDrawList& list, const ImFont& font, ImVec2 place, Colour colour, const std::string& text,
            float wrap_width = 0) {
    place = {std::floor(place.x), std::floor(place.y)};
    list.AddText(&font, font.FontSize, place, ink(colour), text.data(), text.data() + text.size(), wrap_width);
    return place.x + size_of(text, font, wrap_width).x;
}

/// A rounded sheet with text, its upper edge at `top`, centred; returns its lower edge.
float sheet(ImDrawList& list, const ImFont& font, float centre_x, float top, Colour paper, const std::string& text) {
    constexpr float inside = 12;
    const float wrap_width = std::max(ImGui::GetIO().DisplaySize.x - 6 * inside, 100.f);
    const ImVec2 size = size_of(text, font, wrap_width);
    const ImVec2 corner{std::floor(centre_x - size.x / 2 - inside), std::floor(top)};
    const ImVec2 other{corner.x + size.x + 2 * inside, corner.y + size.y + 2 * inside};
    list.AddRectFilled(corner, other, ink(paper), 6);
    write(list, font, {corner.x + inside, corner.y + inside}, palette::note_text, text, wrap_width);
    return other.y;
}

Colour state_colour(const Watch& watch) {
    const bool runs = watch.control().state() == evod::v1::RUN_STATE_RUNNING && !link::worlds_wait(watch.storage());
    return runs ? palette::running : palette::stopped;
}

} // namespace

Rectangle viewport_of(unsigned width_pixels, unsigned height_pixels) {
    return {0, top_strip, double(width_pixels), std::max(double(height_pixels) - top_strip - bottom_strip, 1.0)};
}

void Overlay::notice(std::string text, Clock::time_point now) {
    std::erase_if(notices_, [&](const Notice& shown) { return shown.text == text; });
    notices_.push_back({std::move(text), now + notice_shown});
    if (notices_.size() > notices_max) {
        notices_.pop_front();
    }
}

void Overlay::build(const Watch& watch, const Gui& gui, Clock::time_point now) {
    build_strips(watch, gui);
    build_connection(watch, gui);
    build_notices(gui, now);
    if (help_) {
        build_help();
    }
}

void Overlay::build_strips(const Watch& watch, const Gui& gui) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    const float bottom = window.y - bottom_strip;
    list.AddRectFilled({0, 0}, {window.x, top_strip}, ink(palette::strip));
    list.AddRectFilled({0, top_strip - 1}, {window.x, top_strip}, ink(palette::strip_edge));
    list.AddRectFilled({0, bottom}, window, ink(palette::strip));
    list.AddRectFilled({0, bottom}, {window.x, bottom + 1}, ink(palette::strip_edge));
    const wire::Picture* picture = watch.picture();
    if (picture == nullptr) {
        return;
    }
    const ImFont& text = gui.text();
    const float title_end = write(list, gui.title(), {edge, (top_strip - gui.title().FontSize) / 2 - 1}, palette::text,
                                  title(picture->about));

    const std::string state = shown_state(watch.control().state(), watch.storage());
    const std::string help = "H help";
    const std::string place = place_and_speed(picture->about, watch.control());
    const float top_line = (top_strip - text.FontSize) / 2 - 1;
    const float help_begin = window.x - edge - size_of(help, text).x;
    const float state_begin = help_begin - 2 * edge - size_of(state, text).x;
    const float place_begin = state_begin - 2 * edge - size_of(place, text).x;
    write(list, text, {help_begin, top_line}, palette::text_quiet, help);
    write(list, text, {state_begin, top_line}, state_colour(watch), state);
    if (place_begin > title_end + edge) {
        write(list, text, {place_begin, top_line}, palette::text, place);
    }

    float x = edge;
    for (const std::string& piece : statistics(picture->about, watch.last_generation())) {
        if (x + size_of(piece, text).x > window.x - edge) {
            break;
        }
        x = write(list, text, {x, bottom + (bottom_strip - text.FontSize) / 2 - 1}, palette::text, piece) + 26;
    }
}

void Overlay::build_connection(const Watch& watch, const Gui& gui) {
    const link::ConnectionStatus status = watch.connection_status();
    const std::string server = link::to_text(watch.server());
    const std::string trouble = shown_storage(watch.storage());
    std::string text;
    if (status.state == link::State::Failed) {
        text = "No connection to " + server + ": " + status.reason;
    } else if (status.state != link::State::Connected) {
        text = "Connecting to " + server + " …" + (status.reason.empty() ? "" : "\n" + status.reason + "; retrying");
    } else if (const auto refusal = watch.refusal()) {
        text = *refusal + "\nW shows another world, Tab another island";
    } else if (watch.picture() == nullptr) {
        text = "Waiting for the first picture …" + (trouble.empty() ? "" : "\n" + trouble);
    } else if (!trouble.empty()) {
        text = trouble;
    } else {
        return;
    }
    const bool bad = status.state == link::State::Failed || watch.refusal() ||
                     (status.state == link::State::Connected && !trouble.empty());
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    sheet(*ImGui::GetForegroundDrawList(), gui.text(), window.x / 2,
          watch.picture() == nullptr ? window.y * 0.42f : top_strip + 16, bad ? palette::warning : palette::note, text);
}

void Overlay::build_notices(const Gui& gui, Clock::time_point now) {
    while (!notices_.empty() && notices_.front().until < now) {
        notices_.pop_front();
    }
    std::string text;
    for (const Notice& notice : notices_) {
        text += (text.empty() ? "" : "\n") + notice.text;
    }
    if (!text.empty()) {
        const ImVec2 window = ImGui::GetIO().DisplaySize;
        const float height = size_of(text, gui.text()).y;
        sheet(*ImGui::GetForegroundDrawList(), gui.text(), window.x / 2, window.y - bottom_strip - height - 40,
              palette::note, text);
    }
}

void Overlay::build_organism(const wire::Picture& picture, std::size_t organism, Point screen, const Gui& gui) {
    char text[96];
    std::snprintf(text, sizeof text, "organism %u\nhealth %.1f\nradius %.1f px", picture.organisms.id[organism],
                  double{picture.organisms.health[organism]}, double{picture.organisms.radius_px[organism]});
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    const ImVec2 size = size_of(text, gui.label());
    const ImVec2 corner{std::min(static_cast<float>(screen.x) + 16, window.x - size.x - 20),
                        std::min(static_cast<float>(screen.y) + 16, window.y - bottom_strip - size.y - 20)};
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    list.AddRectFilled(corner, {corner.x + size.x + 16, corner.y + size.y + 12}, ink(palette::note), 5);
    write(list, gui.label(), {corner.x + 8, corner.y + 6}, palette::note_text, text);
}

void Overlay::build_help() {
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({window.x / 2, window.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {18, 14});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 6);
    ImGui::PushStyleVar(ImGuiStyleVar_CellPadding, {10, 4});
    ImGui::Begin("Keys", &help_,
                 ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings);
    if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
        for (const HelpLine& line : help_lines()) {
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(line.keys.data(), line.keys.data() + line.keys.size());
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(line.text.data(), line.text.data() + line.text.size());
        }
        ImGui::EndTable();
    }
    ImGui::End();
    ImGui::PopStyleVar(3);
}

} // namespace evod::viewer
