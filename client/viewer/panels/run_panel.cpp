#include "client/viewer/panels/run_panel.h"

#include "client/viewer/drawing/widgets.h"
#include "client/viewer/watch/readout.h"

#include <imgui.h>

#include <algorithm>
#include <charconv>

namespace evod::viewer {

namespace {

const char* outcome_words(evod::v1::Outcome outcome) {
    switch (outcome) {
    case evod::v1::OUTCOME_GENERATION_LIMIT:
        return "the generation limit is reached";
    case evod::v1::OUTCOME_TARGET_FITNESS:
        return "the target fitness is reached";
    case evod::v1::OUTCOME_STAGNATION:
        return "nothing better came for too long";
    case evod::v1::OUTCOME_EXTINCTION:
        return "everyone has died";
    default:
        return "a criterion holds";
    }
}

} // namespace

void RunPanel::build(Context& context) {
    Watch& watch = context.watch;
    const RunControl& control = watch.control();
    if (!control.known()) {
        widgets::say("No world is shown yet.");
        return;
    }
    const float scale = context.gui.scale();
    build_state(watch);
    const std::string_view why = watch.why_only_watching();
    if (!why.empty()) {
        widgets::say(why, palette::stopped);
    }
    ImGui::BeginDisabled(!why.empty());
    ImGui::Separator();
    build_run(watch, scale);
    ImGui::Separator();
    build_speed(watch);
    ImGui::Separator();
    build_reset(watch, scale);
    ImGui::EndDisabled();
}

void RunPanel::build_state(const Watch& watch) {
    const RunControl& control = watch.control();
    const evod::v1::WorldInfo& told = control.told();
    std::string state = state_word(control.state(), watch.storage());
    if (control.state() == evod::v1::RUN_STATE_TERMINATED) {
        state += std::string{": "} + outcome_words(control.outcome());
    } else if (told.has_run_until_generation() && control.state() == evod::v1::RUN_STATE_RUNNING) {
        state += " until generation " + with_separators(told.run_until_generation());
    }
    ImGui::TextWrapped("%s: %s", control.world().c_str(), state.c_str());
    std::string where = "tick " + with_separators(control.tick());
    if (const wire::Picture* picture = watch.picture()) {
        where = "generation " + with_separators(picture->about.generation()) + ", " + where;
    }
    const std::string seed = "seed " + std::to_string(told.seed());
    widgets::say(where + (told.name().empty() ? "" : ", " + seed));
    widgets::mark(seed);
}

void RunPanel::build_run(Watch& watch, float scale) {
    const evod::v1::RunState state = watch.control().state();
    const bool over = state == evod::v1::RUN_STATE_TERMINATED;
    ImGui::BeginDisabled(over);
    const char* label = state == evod::v1::RUN_STATE_RUNNING  ? "Pause"
                        : state == evod::v1::RUN_STATE_PAUSED ? "Go on"
                                                              : "Run";
    if (ImGui::Button(label, {90 * scale, 0})) {
        watch.pause_or_resume();
    }
    widgets::mark(label);
    ImGui::SameLine();
    if (widgets::button("One tick")) {
        watch.step(1);
    }
    const float field = 110 * scale;
    ImGui::SetNextItemWidth(field);
    ImGui::InputInt("##ticks", &ticks_, 0);
    widgets::mark("ticks");
    ticks_ = std::max(ticks_, 1);
    ImGui::SameLine();
    if (widgets::button("Step ticks")) {
        watch.step(static_cast<std::uint64_t>(ticks_));
    }
    widgets::explain("So many ticks, then it pauses.");
    ImGui::SetNextItemWidth(field);
    ImGui::InputInt("##generations", &generations_, 0);
    widgets::mark("generations");
    generations_ = std::max(generations_, 1);
    ImGui::SameLine();
    if (widgets::button("Run generations")) {
        watch.run_generations(static_cast<std::uint64_t>(generations_));
    }
    widgets::explain("So many generations to their end, then it waits.");
    ImGui::EndDisabled();
}

void RunPanel::build_speed(Watch& watch) {
    const evod::v1::Speed& speed = watch.control().speed();
    bool max = speed.max();
    if (ImGui::Checkbox("as fast as the server can", &max)) {
        watch.max_speed();
    }
    widgets::mark("as fast as the server can");
    ImGui::BeginDisabled(speed.max());
    double factor = factor_.value_or(speed.max() ? 1 : speed.real_time_factor());
    const double least = RunControl::factor_min, most = RunControl::factor_max;
    ImGui::SetNextItemWidth(-ImGui::CalcTextSize("Real time").x - 4 * ImGui::GetStyle().FramePadding.x);
    if (ImGui::SliderScalar("##speed", ImGuiDataType_Double, &factor, &least, &most, "%.3g × real time",
                            ImGuiSliderFlags_Logarithmic)) {
        factor_ = factor;
    }
    widgets::mark("speed");
    if (ImGui::IsItemDeactivatedAfterEdit() && factor_) {
        watch.at_factor(*factor_);
    }
    if (!ImGui::IsItemActive()) {
        factor_.reset();
    }
    ImGui::EndDisabled();
    ImGui::SameLine();
    if (widgets::button("Real time")) {
        watch.real_time();
    }
    if (watch.control().told().slowed()) {
        widgets::say("The server's machine cannot keep up: the clock goes slower, no tick is left out.");
    }
}

void RunPanel::build_reset(Watch& watch, float scale) {
    if (watch.recording() != nullptr) {
        widgets::say("This world shows the past, which stays as it was.");
        return;
    }
    ImGui::SetNextItemWidth(200 * scale);
    ImGui::InputTextWithHint("##seed", "the same seed again", seed_.data(), seed_.size(),
                             ImGuiInputTextFlags_CharsDecimal);
    widgets::mark("seed");
    ImGui::SameLine();
    if (widgets::button("Reset …")) {
        ImGui::OpenPopup("reset");
    }
    widgets::explain("Begins the run again at generation 1, with the parameters last set.");
    if (!problem_.empty()) {
        widgets::say(problem_, palette::warning);
    }
    if (!ImGui::BeginPopup("reset")) {
        return;
    }
    const std::string seed = seed_.data();
    ImGui::Text("Begin %s again at generation 1, %s?", watch.control().world().c_str(),
                seed.empty() ? "with the same seed" : ("with the seed " + seed).c_str());
    if (widgets::button("Reset the world")) {
        std::uint64_t number = 0;
        const auto [end, error] = std::from_chars(seed.data(), seed.data() + seed.size(), number);
        if (seed.empty()) {
            watch.reset(std::nullopt);
            problem_.clear();
        } else if (error == std::errc{} && end == seed.data() + seed.size()) {
            watch.reset(number);
            problem_.clear();
        } else {
            problem_ = "seed: \"" + seed + "\" is no whole number from 0 to 18446744073709551615";
        }
        ImGui::CloseCurrentPopup();
    }
    ImGui::SameLine();
    if (widgets::button("Keep it")) {
        ImGui::CloseCurrentPopup();
    }
    ImGui::EndPopup();
}

} // namespace evod::viewer
