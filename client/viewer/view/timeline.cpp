#include "client/viewer/view/timeline.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/palette.h"
#include "client/viewer/drawing/widgets.h"
#include "client/viewer/text/numbers.h"
#include "client/viewer/view/timeline_layout.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace evod::viewer {

namespace {

// All lengths here are in pixels at scale 1.
constexpr float line_height = 26, label_height = 13;
constexpr float timeline_edge = 12,
                line_edge = 6;  // distance from the window to the widgets; from the widgets to the ends of the line
constexpr float mark_room = 70; // minimum distance between marks

evod::v1::RunMoment moment_of_generation(std::uint64_t generation) {
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

void Timeline::build(ViewedWorld& world, const Gui& gui, Rectangle place) {
    if (world.replay.info() == nullptr || place.height <= 0) {
        return;
    }
    if (world.feed.world() != world_ || world.feed.control().run_id() != run_id_) {
        *this = Timeline{};
        world_ = world.feed.world();
        run_id_ = world.feed.control().run_id();
    }
    const float pixel = gui.scale();
    ImGui::SetNextWindowPos({static_cast<float>(place.left), static_cast<float>(place.top)});
    ImGui::SetNextWindowSize({static_cast<float>(place.width), static_cast<float>(place.height)});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {timeline_edge * pixel, 4 * pixel});
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {6 * pixel, 3 * pixel});
    ImGui::PushFont(&gui.label());
    ImGui::Begin("##timeline", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoBringToFrontOnFocus);
    build_line(world, gui, place);
    build_buttons(world, pixel);
    ImGui::End();
    ImGui::PopFont();
    ImGui::PopStyleVar(3);
}

void Timeline::find_first_ticks(ViewedWorld& world, const evod::v1::Replay& replay, std::size_t count_max) {
    first_tick_[replay.first_generation()] = replay.first_tick();
    if (const codec::ReceivedSnapshot* snapshot = world.feed.snapshot()) {
        const std::uint64_t generation = snapshot->about.generation();
        first_tick_[generation] = snapshot->about.tick() - snapshot->about.generation_tick();
        shown_generation_ = generation;
    }
    for (const std::uint64_t generation :
         marked_generations(replay.first_generation(), replay.last_generation(), count_max)) {
        // In a replay of a run file, the history ends at the tick that is shown.
        const bool known = !replay.replay_of().empty() || generation <= shown_generation_;
        if (!known || first_tick_.contains(generation) || !requested_.insert(generation).second) {
            continue;
        }
        evod::v1::Request request; // a generation begins at the end tick of the previous one
        auto& history = *request.mutable_get_history();
        history.set_world(replay.replay_of().empty() ? world.feed.world() : replay.replay_of());
        history.set_first_generation(generation - 1);
        history.set_last_generation(generation - 1);
        history.set_island(0);
        world.server.send(std::move(request), [this, generation](const core::Result<evod::v1::Response>& response) {
            if (response && response->history().generations_size() > 0) {
                first_tick_[generation] = response->history().generations(0).end_tick();
            }
        });
    }
}

void Timeline::build_line(ViewedWorld& world, const Gui& gui, Rectangle place) {
    const evod::v1::Replay replay = *world.replay.info(); // a copy, because the answer to a seek changes it
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const float pixel = gui.scale(), label_size = label_height * pixel;
    const float width = std::max(static_cast<float>(place.width) - 2 * timeline_edge * pixel, 1.f);
    ImGui::InvisibleButton("line", {width, line_height * pixel});
    widgets::mark("time line");
    const TimeScale scale{replay.first_tick(), std::max(replay.last_tick(), replay.first_tick()),
                          corner.x + line_edge * pixel, width - 2 * line_edge * pixel};
    const auto under_mouse = scale.tick_at(ImGui::GetIO().MousePos.x);
    const evod::v1::RunMoment* target = world.replay.target();
    std::uint64_t shown = world.feed.snapshot() ? world.feed.snapshot()->about.tick() : world.feed.control().tick();
    if (ImGui::IsItemActive()) {
        const bool is_target =
            target ? target->tick() == under_mouse && !target->has_generation() : shown == under_mouse;
        if (!is_target) {
            world.replay.seek(moment_of_tick(under_mouse));
        }
        shown = under_mouse;
    } else if (target && !target->has_generation()) {
        shown = target->tick();
    }
    const bool highlighted = ImGui::IsItemHovered() || ImGui::IsItemActive();
    if (highlighted) {
        ImGui::SetTooltip("tick %s", with_separators(under_mouse).c_str());
    }

    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float top = corner.y + label_size + 3 * pixel, bottom = corner.y + (line_height - 2) * pixel;
    const auto left = static_cast<float>(scale.left), right = left + static_cast<float>(scale.width);
    const auto x = std::round(static_cast<float>(scale.x_of(shown)));
    list.AddRectFilled({left, top}, {right, bottom}, ink(palette::strip_edge), 3 * pixel);
    list.AddRectFilled({left, top}, {x, bottom}, ink(palette::replay), 3 * pixel);
    const auto count_max = static_cast<std::size_t>(width / (mark_room * pixel));
    find_first_ticks(world, replay, count_max);
    std::vector<std::string> texts;
    std::vector<Label> labels;
    for (const std::uint64_t generation :
         marked_generations(replay.first_generation(), replay.last_generation(), count_max)) {
        const auto begin = first_tick_.find(generation);
        if (begin == first_tick_.end()) {
            continue;
        }
        const float at = std::round(static_cast<float>(scale.x_of(begin->second)));
        list.AddLine({at, top - 3 * pixel}, {at, bottom}, ink(palette::text_quiet));
        texts.push_back(std::to_string(generation));
        labels.push_back({at + 2 * pixel, size_of(texts.back(), gui.label()).x});
    }
    for (const std::size_t i : separate_labels(labels, 4 * pixel)) { // generations may differ much in length
        write(list, gui.label(), {static_cast<float>(labels[i].left), corner.y - pixel}, palette::text_quiet, texts[i]);
    }
    list.AddRectFilled({x - 4 * pixel, top - 3 * pixel}, {x + 4 * pixel, bottom + 2 * pixel},
                       ink(highlighted ? palette::focus : palette::text), 2 * pixel);
}

void Timeline::build_buttons(ViewedWorld& world, float pixel) {
    const evod::v1::Replay replay = *world.replay.info();
    if (widgets::button("|<")) {
        world.replay.seek(moment_of_generation(replay.first_generation()));
    }
    widgets::explain("Goes to the first tick.");
    ImGui::SameLine();
    if (widgets::button("<")) {
        world.replay.seek_generations(-1);
    }
    widgets::explain("Goes to the previous generation ([).");
    ImGui::SameLine();
    const bool runs = world.feed.control().state() == evod::v1::RUN_STATE_RUNNING;
    if (ImGui::Button(runs ? "Pause" : "Play", {ImGui::CalcTextSize("Pause").x + 20 * pixel, 0})) {
        world.commands.pause_or_resume();
    }
    widgets::mark(runs ? "Pause" : "Play");
    widgets::explain("Plays or pauses the replay (Space).");
    ImGui::SameLine();
    if (widgets::button(">")) {
        world.replay.seek_generations(1);
    }
    widgets::explain("Goes to the next generation (]).");
    ImGui::SameLine();
    if (widgets::button(">|")) {
        world.replay.seek({});
    }
    widgets::explain("Goes to the last tick.");
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("generation");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 5);
    const bool entered =
        ImGui::InputInt("##generation", &typed_generation_, 0, 0, ImGuiInputTextFlags_EnterReturnsTrue);
    widgets::mark_field("generation", typed_generation_);
    if (entered) {
        world.replay.seek(moment_of_generation(static_cast<std::uint64_t>(std::max(typed_generation_, 0))));
    } else if (!ImGui::IsItemActive()) {
        typed_generation_ = static_cast<int>(shown_generation_);
    }
    widgets::explain("Type a generation from " + std::to_string(replay.first_generation()) + " to " +
                     std::to_string(replay.last_generation()) + " and press Enter to go there.");
    if (world.replay.is_own()) {
        ImGui::SameLine();
        if (widgets::button("Live")) {
            world.replay.return_to_present();
        }
        widgets::explain("Returns to the live world (P).");
    }
}

} // namespace evod::viewer
