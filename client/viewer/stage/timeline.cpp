#include "client/viewer/stage/timeline.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/palette.h"
#include "client/viewer/drawing/widgets.h"
#include "client/viewer/watch/past.h"
#include "client/viewer/watch/readout.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace evod::viewer {

namespace {

// In pixels at scale 1.
constexpr float line_height = 26, label_height = 13;
constexpr float timeline_edge = 12, line_edge = 6; // from the window to the widgets, and on to the ends of the line
constexpr float mark_room = 70;                    // from mark to mark, at least

evod::v1::RunMoment beginning_of(std::uint64_t generation) {
    evod::v1::RunMoment moment;
    moment.set_generation(generation);
    return moment;
}

evod::v1::RunMoment moment_of_tick(std::uint64_t tick) {
    evod::v1::RunMoment moment;
    moment.set_tick(tick);
    return moment;
}

} // namespace

void Timeline::build(Watch& watch, const Gui& gui, Rectangle place, int number) {
    if (watch.replay() == nullptr || place.height <= 0) {
        return;
    }
    if (watch.world() != world_ || watch.control().run_id() != run_id_) {
        *this = Timeline{};
        world_ = watch.world();
        run_id_ = watch.control().run_id();
    }
    const float pixel = gui.scale();
    ImGui::SetNextWindowPos({static_cast<float>(place.left), static_cast<float>(place.top)});
    ImGui::SetNextWindowSize({static_cast<float>(place.width), static_cast<float>(place.height)});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {timeline_edge * pixel, 4 * pixel});
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {6 * pixel, 3 * pixel});
    ImGui::PushFont(&gui.label());
    const std::string name = "##timeline " + std::to_string(number);
    ImGui::Begin(name.c_str(), nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoBringToFrontOnFocus);
    pressed_ = widgets::window_pressed();
    build_line(watch, gui, place);
    build_buttons(watch, pixel);
    ImGui::End();
    ImGui::PopFont();
    ImGui::PopStyleVar(3);
}

void Timeline::learn_beginnings(Watch& watch, const evod::v1::Replay& recording, std::size_t count_max) {
    begin_tick_[recording.first_generation()] = recording.first_tick();
    if (const codec::DecodedSnapshot* picture = watch.picture()) {
        const std::uint64_t generation = picture->about.generation();
        begin_tick_[generation] = picture->about.tick() - picture->about.generation_tick();
        shown_generation_ = generation;
    }
    for (const std::uint64_t generation :
         marked_generations(recording.first_generation(), recording.last_generation(), count_max)) {
        // A replay knows only what ended before the moment that it shows.
        const bool known = !recording.replay_of().empty() || generation <= shown_generation_;
        if (!known || begin_tick_.contains(generation) || !asked_.insert(generation).second) {
            continue;
        }
        evod::v1::Request request; // it begins where the one before ends
        auto& history = *request.mutable_get_history();
        history.set_world(recording.replay_of().empty() ? watch.world() : recording.replay_of());
        history.set_first_generation(generation - 1);
        history.set_last_generation(generation - 1);
        history.set_island(0);
        watch.ask(std::move(request), [this, generation](const core::Result<evod::v1::Response>& response) {
            if (response && response->history().generations_size() > 0) {
                begin_tick_[generation] = response->history().generations(0).end_tick();
            }
        });
    }
}

void Timeline::build_line(Watch& watch, const Gui& gui, Rectangle place) {
    const evod::v1::Replay recording = *watch.replay(); // a seek that is answered changes it
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const float pixel = gui.scale(), label_size = label_height * pixel;
    const float width = std::max(static_cast<float>(place.width) - 2 * timeline_edge * pixel, 1.f);
    ImGui::InvisibleButton("line", {width, line_height * pixel});
    widgets::mark("time line");
    const TimeScale scale{recording.first_tick(), std::max(recording.last_tick(), recording.first_tick()),
                          corner.x + line_edge * pixel, width - 2 * line_edge * pixel};
    const auto under_mouse = scale.tick_at(ImGui::GetIO().MousePos.x);
    const evod::v1::RunMoment* sought = watch.sought();
    std::uint64_t shown = watch.picture() ? watch.picture()->about.tick() : watch.control().tick();
    if (ImGui::IsItemActive()) {
        const bool asked = sought ? sought->tick() == under_mouse && !sought->has_generation() : shown == under_mouse;
        if (!asked) {
            watch.seek(moment_of_tick(under_mouse));
        }
        shown = under_mouse;
    } else if (sought && !sought->has_generation()) {
        shown = sought->tick();
    }
    const bool held = ImGui::IsItemHovered() || ImGui::IsItemActive();
    if (held) {
        ImGui::SetTooltip("tick %s", with_separators(under_mouse).c_str());
    }

    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float top = corner.y + label_size + 3 * pixel, bottom = corner.y + (line_height - 2) * pixel;
    const auto left = static_cast<float>(scale.left), right = left + static_cast<float>(scale.width);
    const auto x = std::round(static_cast<float>(scale.x_of(shown)));
    list.AddRectFilled({left, top}, {right, bottom}, ink(palette::strip_edge), 3 * pixel);
    list.AddRectFilled({left, top}, {x, bottom}, ink(palette::past), 3 * pixel);
    const auto count_max = static_cast<std::size_t>(width / (mark_room * pixel));
    learn_beginnings(watch, recording, count_max);
    std::vector<std::string> texts;
    std::vector<Label> labels;
    for (const std::uint64_t generation :
         marked_generations(recording.first_generation(), recording.last_generation(), count_max)) {
        const auto begin = begin_tick_.find(generation);
        if (begin == begin_tick_.end()) {
            continue;
        }
        const float at = std::round(static_cast<float>(scale.x_of(begin->second)));
        list.AddLine({at, top - 3 * pixel}, {at, bottom}, ink(palette::text_quiet));
        texts.push_back(std::to_string(generation));
        labels.push_back({at + 2 * pixel, size_of(texts.back(), gui.label()).x});
    }
    for (const std::size_t i : labels_apart(labels, 4 * pixel)) { // generations may be of very different lengths
        write(list, gui.label(), {static_cast<float>(labels[i].left), corner.y - pixel}, palette::text_quiet, texts[i]);
    }
    list.AddRectFilled({x - 4 * pixel, top - 3 * pixel}, {x + 4 * pixel, bottom + 2 * pixel},
                       ink(held ? palette::focus : palette::text), 2 * pixel);
}

void Timeline::build_buttons(Watch& watch, float pixel) {
    const evod::v1::Replay recording = *watch.replay();
    if (widgets::button("|<")) {
        watch.seek(beginning_of(recording.first_generation()));
    }
    widgets::explain("to the beginning");
    ImGui::SameLine();
    if (widgets::button("<")) {
        watch.turn_generations(-1);
    }
    widgets::explain("the generation before: [");
    ImGui::SameLine();
    const bool runs = watch.control().state() == evod::v1::RUN_STATE_RUNNING;
    if (ImGui::Button(runs ? "Pause" : "Play", {ImGui::CalcTextSize("Pause").x + 20 * pixel, 0})) {
        watch.pause_or_resume();
    }
    widgets::mark(runs ? "Pause" : "Play");
    widgets::explain("Space");
    ImGui::SameLine();
    if (widgets::button(">")) {
        watch.turn_generations(1);
    }
    widgets::explain("the next generation: ]");
    ImGui::SameLine();
    if (widgets::button(">|")) {
        watch.seek({});
    }
    widgets::explain("to the last moment that is known");
    ImGui::SameLine();
    if (widgets::button("-")) {
        watch.slower();
    }
    widgets::explain("half as fast");
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(shown_speed(watch.control().speed()).c_str());
    ImGui::SameLine();
    if (widgets::button("+")) {
        watch.faster();
    }
    widgets::explain("twice as fast");
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("generation");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 5);
    const bool entered =
        ImGui::InputInt("##generation", &typed_generation_, 0, 0, ImGuiInputTextFlags_EnterReturnsTrue);
    widgets::mark("generation");
    if (entered) {
        watch.seek(beginning_of(static_cast<std::uint64_t>(std::max(typed_generation_, 0))));
    } else if (!ImGui::IsItemActive()) {
        typed_generation_ = static_cast<int>(shown_generation_);
    }
    widgets::explain(std::to_string(recording.first_generation()) + " to " +
                     std::to_string(recording.last_generation()) + "; Enter goes there");
    ImGui::SameLine();
    build_fork(watch);
    if (watch.opened_past()) {
        ImGui::SameLine();
        if (widgets::button("Present")) {
            watch.return_to_present();
        }
        widgets::explain("back to the world that lives: P");
    }
}

void Timeline::build_fork(Watch& watch) {
    const bool may = watch.may_create();
    ImGui::BeginDisabled(!may);
    if (widgets::button("Fork …")) {
        ImGui::OpenPopup("fork");
    }
    ImGui::EndDisabled();
    widgets::explain(may ? "a new world that begins with this moment" : "only the role admin may make worlds");
    if (ImGui::BeginPopup("fork")) {
        ImGui::TextUnformatted("A new world from the moment that is shown. Its name:");
        if (ImGui::IsWindowAppearing()) {
            ImGui::SetKeyboardFocusHere();
        }
        const bool entered =
            ImGui::InputText("##name", fork_name_.data(), fork_name_.size(), ImGuiInputTextFlags_EnterReturnsTrue);
        widgets::mark("Its name");
        ImGui::SameLine();
        const bool named = fork_name_[0] != '\0';
        ImGui::BeginDisabled(!named);
        if ((widgets::button("Fork") || entered) && named) {
            watch.fork(fork_name_.data());
            ImGui::CloseCurrentPopup();
        }
        ImGui::EndDisabled();
        ImGui::EndPopup();
    }
}

} // namespace evod::viewer
