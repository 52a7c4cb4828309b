#include "client/viewer/panels/run_panel.h"

#include "client/core/client_types.h"
#include "client/viewer/drawing/widgets.h"
#include "client/viewer/world/status_text.h"

#include <imgui.h>

#include <algorithm>
#include <initializer_list>
#include <limits>

namespace evod::viewer {

namespace {

const char* outcome_words(evod::v1::Outcome outcome) {
    switch (outcome) {
    case evod::v1::OUTCOME_GENERATION_LIMIT:
        return "generation limit reached";
    case evod::v1::OUTCOME_TARGET_FITNESS:
        return "target fitness reached";
    case evod::v1::OUTCOME_STAGNATION:
        return "fitness has stagnated";
    case evod::v1::OUTCOME_EXTINCTION:
        return "all organisms of a species have died";
    default:
        return "a termination criterion is met";
    }
}

constexpr std::uint64_t count_max = 1'000'000'000'000; // maximum number of ticks or generations per command

/// Builds a field for a number. number_in() checks the number when the user presses the button beside the field.
template <std::size_t size>
void number_field(const char* name, std::array<char, size>& field, float width, const char* hint = "") {
    ImGui::SetNextItemWidth(width);
    ImGui::InputTextWithHint((std::string{"##"} + name).c_str(), hint, field.data(), field.size(),
                             ImGuiInputTextFlags_CharsDecimal);
    widgets::mark_field(name, field.data());
    ImGui::SameLine();
}

/// Shows `problem` if it begins with the name of one of these fields.
void show_problem(const std::string& problem, std::initializer_list<std::string_view> fields) {
    const std::string_view field = std::string_view{problem}.substr(0, problem.find(':'));
    if (!problem.empty() && std::ranges::find(fields, field) != fields.end()) {
        widgets::small_text(problem, palette::warning);
        widgets::mark(std::string{field} + " is refused");
    }
}

} // namespace

void RunPanel::build(Context& context) {
    ViewedWorld& world = context.world;
    const RunControl& control = world.feed.control();
    if (!control.known()) {
        widgets::small_text("No world is open yet.");
        return;
    }
    const float scale = context.gui.scale();
    build_state(world);
    const std::string_view why = world.commands.read_only_reason();
    if (!why.empty()) {
        widgets::small_text(why, palette::stopped);
    }
    ImGui::BeginDisabled(!why.empty());
    ImGui::Separator();
    build_run(world, scale);
    ImGui::Separator();
    build_reset(world, scale);
    ImGui::EndDisabled();
}

void RunPanel::build_state(const ViewedWorld& world) {
    const RunControl& control = world.feed.control();
    const evod::v1::WorldInfo& info = control.info();
    const evod::v1::AwaitedFitness* awaited = control.awaited_fitness();
    std::string state = world.replay.at_end() ? world.state_text()
                                              : state_word(control.state(), world.feed.storage(), awaited != nullptr);
    if (control.state() == evod::v1::RUN_STATE_TERMINATED) {
        state += std::string{": "} + outcome_words(control.outcome());
    } else if (info.has_run_until_generation() && control.state() == evod::v1::RUN_STATE_RUNNING) {
        state += " until generation " + with_separators(info.run_until_generation());
    }
    widgets::small_text(control.world() + ": " + state, palette::text);
    if (awaited != nullptr) {
        widgets::small_text("Waits for fitness from a client; " + core::to_text(*awaited, info.island_count()),
                            palette::stopped);
    }
    std::string where = "tick " + with_separators(control.tick());
    if (const codec::ReceivedSnapshot* snapshot = world.feed.snapshot()) {
        where = "generation " + with_separators(snapshot->about.generation()) + ", " + where;
    }
    const std::string seed = "seed " + std::to_string(info.seed());
    widgets::small_text(where + (info.name().empty() ? "" : ", " + seed));
    widgets::mark(seed);
}

void RunPanel::build_run(ViewedWorld& world, float scale) {
    const evod::v1::RunState state = world.feed.control().state();
    const bool over = state == evod::v1::RUN_STATE_TERMINATED || world.replay.at_end();
    ImGui::BeginDisabled(over);
    if (widgets::button("One tick")) {
        world.commands.step(1);
    }
    const float field = 110 * scale;
    number_field("ticks", ticks_, field);
    if (widgets::button("Step ticks")) {
        if (const auto ticks = number_in("ticks", ticks_.data(), 1, count_max, problem_)) {
            world.commands.step(*ticks);
        }
    }
    widgets::explain("Runs this many ticks, then pauses.");
    number_field("generations", generations_, field);
    if (widgets::button("Run generations")) {
        if (const auto generations = number_in("generations", generations_.data(), 1, count_max, problem_)) {
            world.commands.run_generations(*generations);
        }
    }
    widgets::explain("Runs this many generations to their end, then waits.");
    ImGui::EndDisabled();
    show_problem(problem_, {"ticks", "generations"});
}

void RunPanel::build_reset(ViewedWorld& world, float scale) {
    if (world.replay.info() != nullptr) {
        widgets::small_text("This world is a replay and cannot be changed.");
        return;
    }
    number_field("seed", seed_, 200 * scale, "empty: the same seed");
    if (widgets::button("Reset …")) {
        ImGui::OpenPopup("reset");
    }
    widgets::explain("Starts a new run at generation 1 with the current parameter settings.");
    show_problem(problem_, {"seed"});
    if (!ImGui::BeginPopup("reset")) {
        return;
    }
    const std::string seed = seed_.data();
    ImGui::Text("Restart %s at generation 1 %s?", world.feed.control().world().c_str(),
                seed.empty() ? "with the same seed" : ("with seed " + seed).c_str());
    if (widgets::button("Reset the world")) {
        constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
        if (seed.empty()) {
            problem_.clear();
            world.commands.reset(std::nullopt);
        } else if (const auto number = number_in("seed", seed, 0, most, problem_)) {
            world.commands.reset(*number);
        }
        ImGui::CloseCurrentPopup();
    }
    widgets::end_popup_with_cancel();
}

} // namespace evod::viewer
