#include "client/viewer/panels/summary.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/widgets.h"
#include "client/viewer/panels/plots/plot.h"
#include "client/viewer/panels/plots/run_history.h"
#include "client/viewer/world/status_text.h"

#include <imgui.h>

#include <algorithm>

namespace evod::viewer {

namespace {

constexpr float curve_height = 84; // pixels at scale 1

/// Explains the marks of the island in one line: each mark as it is drawn, followed by its name.
void build_marks(float scale) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float line = ImGui::GetTextLineHeight(), radius = 5 * scale;
    const auto centre = [&] {
        const ImVec2 place = ImGui::GetCursorScreenPos();
        ImGui::Dummy({3 * radius, line});
        ImGui::SameLine(0, 2 * scale);
        return ImVec2{place.x + radius, place.y + line / 2};
    };
    list.AddCircle(centre(), radius, ink(palette::organism), 0, 2 * scale);
    ImGui::TextUnformatted("organism, with its health");
    ImGui::SameLine(0, 12 * scale);
    list.AddCircleFilled(centre(), radius * 0.8f, ink(palette::food));
    ImGui::TextUnformatted("food");
    ImGui::SameLine(0, 12 * scale);
    list.AddCircleFilled(centre(), radius * 0.8f, ink(palette::poison));
    ImGui::TextUnformatted("poison");
}

} // namespace

void Summary::build_title(const ViewedWorld& world) {
    const evod::v1::Replay* replay = world.replay.info();
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(replay != nullptr ? replay_label(*replay).c_str() : ("World " + world.feed.name()).c_str());
    widgets::mark("World");
}

void Summary::build(Panel::Context& context, bool complete) {
    if (complete) {
        build_experiment(context);
        build_curve(context);
    }
    build_buttons(context.world, context.gui.scale());
    build_speed(context.world);
}

void Summary::build_experiment(Panel::Context& context) {
    ViewedWorld& world = context.world;
    experiment_.update(world, context.now);
    const float scale = context.gui.scale();
    ImGui::PushFont(&context.gui.label());
    if (experiment_.text().empty()) {
        widgets::small_text(world.feed.control().known() ? "Loading the experiment …" : "No world is open yet.");
    } else {
        widgets::small_text(experiment_.text(), palette::text);
    }
    build_marks(scale);
    ImGui::PopFont();
}

void Summary::build_curve(const Panel::Context& context) {
    const HistoryTable& table = context.history->table();
    const auto generations = table.column(std::nullopt, "generation");
    const auto mean = table.column(std::nullopt, "fitness_mean"), best = table.column(std::nullopt, "fitness_best");
    Plot plot;
    plot.series = {{.name = "best", .colour = palette::series_orange, .x = generations, .y = best},
                   {.name = "mean", .colour = palette::series_blue, .x = generations, .y = mean}};
    if (generations.empty()) {
        plot.title = context.history->history().complete() ? "Fitness: the curve begins when the first generation ends"
                                                           : "Fitness: loading the earlier generations …";
    } else {
        plot.title = print("Fitness by generation: best %.3g, mean %.3g in generation %.0f", best.back(), mean.back(),
                           generations.back());
    }
    const Range range = joined(range_of(best), range_of(mean)).value_or(Range{0, 1});
    ImGui::PushFont(&context.gui.label());
    curve_widget(plot, with_room({std::min(range.min, 0.0), range.max}, 0.25), curve_height * context.gui.scale());
    ImGui::PopFont();
    widgets::mark("Fitness curve");
}

void Summary::build_buttons(ViewedWorld& world, float scale) {
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
    widgets::explain("Space");
    ImGui::SameLine();
    if (widgets::button("One generation")) {
        world.commands.run_generations(1);
    }
    widgets::explain("Runs until the generation has ended and the next one is bred, then waits.");
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(!control.known());
    if (widgets::button(world.replay.is_own() ? "Live" : "Replay")) {
        world.toggle_replay();
    }
    widgets::explain(world.replay.is_own() ? "Returns to the live world (P)."
                                           : "Shows earlier generations of this run, with a time line (P).");
    ImGui::SameLine();
    fork_.build(world);
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
    if (ImGui::SliderScalar("##speed", ImGuiDataType_Double, &factor, &least, &most,
                            factor < 1000 ? "%.3g × real time" : "%.0f × real time", ImGuiSliderFlags_Logarithmic)) {
        factor_ = factor;
    }
    widgets::mark("speed");
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
