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

/// A rounded sheet with text, its upper edge at `top`, in the middle of `place`; returns its lower edge.
float sheet(ImDrawList& list, const ImFont& font, Rectangle place, float top, Colour paper, const std::string& text) {
    constexpr float inside = 12;
    const auto centre_x = static_cast<float>(place.centre().x);
    const float wrap_width = std::max(static_cast<float>(place.width) - 6 * inside, 100.f);
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

Rectangle viewport_of(Rectangle place) {
    return {place.left, place.top + top_strip, place.width, std::max(place.height - top_strip - bottom_strip, 1.0)};
}

void Overlay::notice(std::string text, Clock::time_point now) {
    std::erase_if(notices_, [&](const Notice& shown) { return shown.text == text; });
    notices_.push_back({std::move(text), now + notice_shown});
    if (notices_.size() > notices_max) {
        notices_.pop_front();
    }
}

void Overlay::build_world(const Watch& watch, const Gui& gui, Rectangle place, bool focused) {
    build_strips(watch, gui, place, focused);
    build_connection(watch, gui, place);
}

void Overlay::build(const Gui& gui, Clock::time_point now) {
    build_notices(gui, now);
    if (help_) {
        build_help();
    }
}

void Overlay::build_strips(const Watch& watch, const Gui& gui, Rectangle place, bool focused) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const auto left = static_cast<float>(place.left), right = left + static_cast<float>(place.width);
    const auto top = static_cast<float>(place.top), end = top + static_cast<float>(place.height);
    const float bottom = end - bottom_strip;
    list.AddRectFilled({left, top}, {right, top + top_strip}, ink(palette::strip));
    list.AddRectFilled({left, top + top_strip - 1}, {right, top + top_strip}, ink(palette::strip_edge));
    list.AddRectFilled({left, bottom}, {right, end}, ink(palette::strip));
    list.AddRectFilled({left, bottom}, {right, bottom + 1}, ink(palette::strip_edge));
    if (focused) {
        list.AddRectFilled({left, top}, {right, top + 3}, ink(palette::focus));
    }
    const wire::Picture* picture = watch.picture();
    if (picture == nullptr) {
        return;
    }
    const ImFont& text = gui.text();
    float title_begin = left + edge;
    const float top_line = top + (top_strip - text.FontSize) / 2 - 1;
    if (watch.recording() != nullptr) {
        const std::string mark = past_mark(*watch.recording());
        const float mark_end = title_begin + size_of(mark, text).x + 16;
        list.AddRectFilled({title_begin, top + 7}, {mark_end, top + top_strip - 8}, ink(palette::past), 4);
        write(list, text, {title_begin + 8, top_line}, palette::text, mark);
        title_begin = mark_end + edge;
    }
    const float title_end = write(list, gui.title(), {title_begin, top + (top_strip - gui.title().FontSize) / 2 - 1},
                                  palette::text, title(picture->about));

    const std::string state = shown_state(watch.control().state(), watch.storage());
    const std::string help = "H help";
    const float help_begin = right - edge - size_of(help, text).x;
    const float state_begin = help_begin - 2 * edge - size_of(state, text).x;
    write(list, text, {help_begin, top_line}, palette::text_quiet, help);
    if (state_begin > title_end + edge) {
        write(list, text, {state_begin, top_line}, state_colour(watch), state);
    }
    for (const std::string& about : {place_and_speed(picture->about, watch.control()), picture->about.world()}) {
        const float about_begin = state_begin - 2 * edge - size_of(about, text).x;
        if (about_begin > title_end + edge) {
            write(list, text, {about_begin, top_line}, palette::text, about);
            break;
        }
    }

    float x = left + edge;
    for (const std::string& piece : statistics(picture->about, watch.last_generation())) {
        if (x + size_of(piece, text).x > right - edge) {
            break;
        }
        x = write(list, text, {x, bottom + (bottom_strip - text.FontSize) / 2 - 1}, palette::text, piece) + 26;
    }
}

void Overlay::build_connection(const Watch& watch, const Gui& gui, Rectangle place) {
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
    const double below = watch.picture() == nullptr ? place.height * 0.42 : top_strip + 16;
    sheet(*ImGui::GetForegroundDrawList(), gui.text(), place, static_cast<float>(place.top + below),
          bad ? palette::warning : palette::note, text);
}

void Overlay::build_tile(std::uint32_t island, const Gui& gui, Rectangle place, bool chosen) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const std::string text = "island " + std::to_string(island);
    const ImVec2 size = size_of(text, gui.label());
    const ImVec2 corner{static_cast<float>(place.left), static_cast<float>(place.top)};
    list.AddRectFilled(corner, {corner.x + size.x + 12, corner.y + size.y + 4},
                       ink(chosen ? palette::focus : palette::note), 3);
    write(list, gui.label(), {corner.x + 6, corner.y + 2}, palette::note_text, text);
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
        sheet(*ImGui::GetForegroundDrawList(), gui.text(), {0, 0, window.x, window.y},
              window.y - bottom_strip - height - 40, palette::note, text);
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
