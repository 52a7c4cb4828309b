#include "client/viewer/panels/summary.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/widgets.h"
#include "client/viewer/island/island_renderer.h"
#include "client/viewer/island/styles.h"
#include "client/viewer/panels/fitness_curve.h"
#include "client/viewer/world/status_text.h"

#include "client/viewer/text/shared_texts.h"

#include <imgui.h>

#include <algorithm>

namespace evod::viewer {

namespace {

constexpr float text_lines = 6; // room for the sentences, so that the widgets below them stay in place

} // namespace

void Summary::build_title(const ViewedWorld& world) {
    ImGui::AlignTextToFramePadding();
    const codec::ReceivedSnapshot* snapshot = world.feed.snapshot();
    ImGui::TextUnformatted(
        shown_text(world.feed.name(), world.replay.info(), snapshot != nullptr ? &snapshot->about : nullptr).c_str());
    widgets::mark("World");
}

void Summary::build(Panel::Context& context, bool complete) {
    if (complete) {
        build_experiment(context);
        history_.update(context.world, context.now);
        if (const auto clicked = build_fitness_curve(history_.generations(), history_.complete(), context.gui)) {
            context.world.show_generation(*clicked);
        }
        widgets::mark("Fitness curve");
    } else {
        ImGui::PushFont(&context.gui.label());
        build_marks(context);
        ImGui::PopFont();
    }
    build_buttons(context);
    build_speed(context.world);
}

void Summary::build_experiment(Panel::Context& context) {
    ViewedWorld& world = context.world;
    experiment_.update(world, context.now);
    ImGui::PushFont(&context.gui.label());
    const float end = ImGui::GetCursorPosY() + text_lines * ImGui::GetTextLineHeight();
    if (experiment_.text().empty()) {
        widgets::small_text(world.feed.control().known() ? "Loading the experiment …" : "No world is open yet.");
    } else {
        widgets::small_text(texts::what_it_is + (" " + experiment_.text()), palette::text);
    }
    ImGui::SetCursorPosY(std::max(ImGui::GetCursorPosY(), end));
    build_marks(context);
    ImGui::PopFont();
}

/// Explains the marks of the island in one line: each mark as it is drawn, on the ground of the island, with its name.
/// A second line names the healthiest organisms. Without bodies there is neither.
void Summary::build_marks(const Panel::Context& context) {
    if (!experiment_.has_bodies()) {
        return;
    }
    const Look look = context.island_view.options.look;
    const Gui& gui = context.gui;
    const float scale = gui.scale(), radius = 7 * scale, gap = 6 * scale, height = 26 * scale;
    const palette::IslandColours& colours = palette::of(look);
    const Styles& styles = styles_of(look);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x;
    list.AddRectFilled(corner, {corner.x + width, corner.y + height}, ink(colours.ground), 4 * scale);
    float left = corner.x + gap;
    const auto add = [&](const ShapeStyle& style, const char* name) {
        marks_.add(list, {left + radius, corner.y + height / 2}, radius, double{scale}, style);
        const float top = corner.y + (height - gui.label().FontSize) / 2 - scale;
        left = write(list, gui.label(), {left + 2 * radius + gap, top}, colours.label, name) + 2.5f * gap;
    };
    add(styles.organism, look.skin == Skin::Vivid ? "organism, arc: health" : "organism, number: health");
    add(styles.food, "food");
    add(styles.poison, "poison");
    ImGui::Dummy({width, height});
    std::string text;
    WorldFeed& feed = context.world.feed;
    if (const codec::ReceivedSnapshot* snapshot = feed.snapshot()) {
        const codec::Entities& organisms = snapshot->entities->organisms;
        for (const std::size_t i : feed.healthiest(feed.island(), HealthRanking::named_count)) {
            text += (text.empty() ? "Healthiest now: #" : ", #") + std::to_string(organisms.id[i]) + " (" +
                    std::to_string(shown_health(organisms.health(i))) + ")";
        }
    }
    widgets::small_text(text.empty() ? "No organism is alive." : text, palette::text);
}

void Summary::build_buttons(Panel::Context& context) {
    ViewedWorld& world = context.world;
    const float scale = context.gui.scale();
    const RunControl& control = world.feed.control();
    const std::string_view why = world.commands.read_only_reason();
    const bool over = control.state() == evod::v1::RUN_STATE_TERMINATED || world.replay.at_end();
    ImGui::BeginDisabled(!control.known() || !why.empty() || over);
    const char* label = control.state() == evod::v1::RUN_STATE_RUNNING  ? "Pause"
                        : control.state() == evod::v1::RUN_STATE_PAUSED ? "Resume"
                                                                        : "Run";
    if (ImGui::Button(label, {80 * scale, 0})) {
        world.commands.pause_or_resume();
    }
    widgets::mark(label);
    widgets::alias("Run or pause");
    const std::string why_not = !why.empty() ? std::string{why} + "." : over ? "The run has ended." : "";
    widgets::explain(why_not.empty() ? "Runs or pauses the world (Space)." : why_not);
    ImGui::SameLine();
    if (widgets::button("One generation")) {
        world.commands.run_generations(1);
    }
    widgets::explain(why_not.empty()
                         ? "Runs the generation to its end, then waits. The next tick breeds the next generation."
                         : why_not);
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(!control.known());
    if (widgets::button(world.replay.is_own() ? "Live" : "Replay")) {
        world.toggle_replay();
    }
    widgets::alias("Replay or live");
    widgets::explain(world.replay.is_own() ? "Returns to the live world (P)."
                                           : "Shows earlier generations of this run, with a time line (P).");
    ImGui::SameLine();
    const bool may_create = world.server.may_create();
    ImGui::BeginDisabled(!may_create);
    if (widgets::button("Fork")) {
        world.replay.fork();
    }
    ImGui::EndDisabled();
    widgets::explain(may_create ? "Creates a world that starts from the tick shown, and shows it." : no_creation_text);
    ImGui::EndDisabled();
    if (!why.empty()) {
        widgets::small_text(why, palette::stopped);
    }
}

void Summary::build_speed(ViewedWorld& world) {
    const RunControl& control = world.feed.control();
    const evod::v1::Speed& speed = control.speed();
    ImGui::BeginDisabled(!control.known() || !world.commands.may_command());
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("Speed");
    ImGui::SameLine();
    bool max = speed.max();
    const char* const as_fast = "as fast as possible";
    const float rest = ImGui::CalcTextSize(as_fast).x + ImGui::GetFrameHeight() + 3 * ImGui::GetStyle().ItemSpacing.x;
    ImGui::BeginDisabled(max);
    double factor = factor_.value_or(max ? 1 : speed.real_time_factor());
    const double least = RunControl::factor_min, most = RunControl::factor_max;
    ImGui::SetNextItemWidth(-rest);
    if (ImGui::SliderScalar("##speed", ImGuiDataType_Double, &factor, &least, &most, speed_text(factor).c_str(),
                            ImGuiSliderFlags_Logarithmic)) {
        factor_ = factor;
    }
    widgets::mark_field("speed", factor);
    widgets::explain("+ doubles and − halves the speed; 1 is real time.");
    if (ImGui::IsItemDeactivatedAfterEdit() && factor_) {
        const bool allowed = *factor_ >= least && *factor_ <= most; // the slider does not limit a typed value
        problem_ = allowed ? ""
                           : "speed: got " + shown_number(*factor_) + ", allowed " + shown_number(least) + " to " +
                                 shown_number(most) + " times real time";
        if (allowed) {
            world.commands.at_factor(*factor_);
        }
    }
    if (!ImGui::IsItemActive()) {
        factor_.reset();
    }
    ImGui::EndDisabled();
    ImGui::SameLine();
    if (widgets::checkbox(as_fast, max)) {
        world.commands.max_speed();
    }
    ImGui::EndDisabled();
    if (!problem_.empty()) {
        widgets::small_text(problem_, palette::warning);
        widgets::mark("speed is refused");
    }
    if (control.info().slowed()) {
        widgets::small_text("The server cannot keep up: simulated time runs slower, no tick is skipped.");
    }
}

} // namespace evod::viewer
