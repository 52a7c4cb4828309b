#include "client/viewer/panels/breeding/breeding_panel.h"

#include "client/viewer/drawing/widgets.h"
#include "client/viewer/panels/breeding/caption.h"
#include "client/viewer/panels/breeding/descendant_drawing.h"
#include "client/viewer/panels/breeding/selection_drawing.h"
#include "client/viewer/world/status_text.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace evod::viewer {

namespace {

// Minimum times for which a breeding stays on the screen: while the panel follows a fast world, and after the breeding
// was played to its end.
constexpr std::chrono::milliseconds shown_min{500}, shown_after_playing{1500};

/// Reserves a rectangle of the panel's window to draw in, as wide as that window.
Sheet sheet_of(const Gui& gui, float height) {
    const Sheet sheet{*ImGui::GetWindowDrawList(),
                      gui.label(),
                      ImGui::GetCursorScreenPos(),
                      {std::max(ImGui::GetContentRegionAvail().x, 1.f), std::max(height, 1.f)}};
    ImGui::Dummy(sheet.size);
    return sheet;
}

std::string shown(const std::optional<double>& number, std::string_view unit) {
    return number ? with_unit(*number, unit) : "–";
}

/// Returns whether the panel may pause the world after each generation: the session may command it, and it is not a
/// replay.
bool may_hold(const ViewedWorld& world) {
    return world.commands.may_command() && world.replay.info() == nullptr;
}

GenerationHold::Run run_of(const ViewedWorld& world) {
    return {world.feed.control().world(), world.feed.control().run_id()};
}

bool pressed(ImGuiKey key) {
    return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key));
}

} // namespace

std::span<const Panel::Key> BreedingPanel::keys() const {
    using Keyboard = sf::Keyboard;
    static constexpr Key keys[] = {
        {Keyboard::Space, "play, stop"},
        {Keyboard::Enter, ""},
        {Keyboard::Left, "one step back"},
        {Keyboard::Right, "one step forward"},
        {Keyboard::PageUp, "to the previous stage"},
        {Keyboard::PageDown, "to the next stage"},
        {Keyboard::Home, "to the beginning"},
        {Keyboard::End, "to the end"},
    };
    return keys;
}

void BreedingPanel::build(Context& context) {
    if (context.world.feed.snapshot() == nullptr) {
        ImGui::TextUnformatted("Waiting for the first snapshot …");
        return;
    }
    choose(context);
    request(context);
    hold_world(context.world);
    build_generation(context);
    if (!error_.empty()) {
        widgets::small_text(error_, palette::text);
        if (widgets::button("Retry")) {
            error_.clear();
            poll_.make_due();
        }
    }
    if (!shown_) {
        if (newest_ == 0) {
            widgets::small_text("No generation has bred yet. The first one breeds when it ends and the next begins.",
                                palette::text);
        } else if (error_.empty()) {
            ImGui::TextUnformatted("Loading …");
        }
        return;
    }
    build_transport(context.gui);
    take_keys();
    const Moment moment = stepper_.moment();
    const bool here = moment.stage == BreedingStage::Picking    ? shown_->pick(moment.index) != nullptr
                      : moment.stage == BreedingStage::Breeding ? shown_->descendant(moment.index) != nullptr
                                                                : true;
    if (here) { // otherwise playing waits until the row has arrived
        stepper_.advance(double{ImGui::GetIO().DeltaTime});
    }
    const float theory_width = std::floor(ImGui::GetContentRegionAvail().x * 0.4f);
    ImGui::BeginChild("stage", {-theory_width - 8, 0});
    build_stage(context);
    ImGui::EndChild();
    ImGui::SameLine();
    ImGui::BeginChild("theory", {0, 0});
    build_theory(context.gui);
    ImGui::EndChild();
}

// ---- which generation is shown, and what to request --------------------------------------------------------------

void BreedingPanel::choose(const Context& context) {
    const evod::v1::SnapshotFrame& about = context.world.feed.snapshot()->about;
    BreedingRecord::Key key{about.world(), about.run_id(), about.island(), 0};
    newest_ = about.generation() - std::min<std::uint64_t>(about.generation(), 1);
    const auto is_of = [&](const std::optional<BreedingRecord>& record) {
        return record && record->key().world == key.world && record->key().run_id == key.run_id &&
               record->key().island == key.island;
    };
    if (!is_of(shown_)) {
        shown_.reset();
        comparison_.reset();
        stepper_.load(0, 0);
    }
    if (!is_of(next_)) {
        next_.reset();
    }
    if (newest_ == 0) {
        return;
    }
    if (stepper_.playing()) {
        next_change_ = context.now + shown_after_playing;
    }
    // Wait for a pending answer before requesting a newer generation. In a fast world there is always a newer one, so
    // the panel would never show a generation.
    const bool idle = !next_ || !error_.empty();
    const bool settled = !stepper_.playing() && (stepper_.at_begin() || stepper_.at_end());
    if (follow_ && idle && settled && context.now >= next_change_) {
        chosen_ = newest_;
    }
    chosen_ = std::clamp<std::uint64_t>(chosen_, 1, newest_);
    key.generation = chosen_;
    const auto& current = next_ ? next_ : shown_;
    if (!current || current->key() != key) {
        next_.emplace(key);
        poll_.reset();
        error_.clear();
        next_change_ = context.now + shown_min;
    }
}

void BreedingPanel::request(const Context& context) {
    auto& record = next_ ? next_ : shown_;
    if (!poll_.due(context.world, context.now) || !record || !error_.empty()) {
        return;
    }
    if (auto wanted = record->wanted(next_ ? Moment{} : stepper_.moment())) {
        evod::v1::Request request;
        *request.mutable_get_breeding() = std::move(*wanted);
        poll_.send(context.world, std::move(request), context.now, [this](const evod::v1::Response* response) {
            if (response != nullptr) {
                receive(response->breeding());
            } else {
                error_ = poll_.problem();
            }
        });
    }
}

void BreedingPanel::receive(const evod::v1::Breeding& breeding) {
    if (next_) {
        next_->add(breeding);
        if (next_->known()) {
            show_next();
        } else {
            error_ =
                "The server sent the breeding of a generation other than " + with_separators(next_->key().generation);
        }
    } else if (shown_) {
        shown_->add(breeding);
    }
    if (shown_ && !comparison_) {
        comparison_ = compare(*shown_);
    }
}

void BreedingPanel::show_next() {
    const bool at_end = shown_ && stepper_.at_end() && !stepper_.at_begin();
    shown_ = std::exchange(next_, std::nullopt);
    comparison_.reset();
    stepper_.load(shown_->pick_count(), shown_->descendant_count());
    if (play_each_) {
        stepper_.play();
    } else if (at_end) {
        stepper_.to_end(); // the user skipped the steps of the previous breeding
    }
}

void BreedingPanel::hold_world(ViewedWorld& world) {
    if (!may_hold(world)) {
        hold_.release();
    }
    switch (hold_.update(run_of(world), world.feed.control().state(), world.feed.control().stepping())) {
    case GenerationHold::Action::None:
        break;
    case GenerationHold::Action::RunOneGeneration:
        world.commands.run_generations(1);
        break;
    case GenerationHold::Action::RunOneTick:
        world.commands.step(1);
        break;
    }
}

// ---- widgets ---------------------------------------------------------------------------------------------------

void BreedingPanel::build_generation(const Context& context) {
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("Generation");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(130 * context.gui.scale());
    const std::uint64_t one = 1;
    std::uint64_t wanted = chosen_;
    const bool changed = ImGui::InputScalar("##generation", ImGuiDataType_U64, &wanted, &one, nullptr);
    widgets::mark("Generation");
    if (changed && newest_ > 0) {
        follow_ = false;
        chosen_ = std::clamp<std::uint64_t>(wanted, 1, newest_);
    }
    widgets::explain("Generation of the parents; the panel shows any generation that has bred");
    ImGui::SameLine();
    ImGui::Checkbox("the newest", &follow_);
    widgets::mark("the newest");
    widgets::explain("Shows each new breeding once the previous one has been stepped through or skipped");
    ImGui::SameLine();
    ImGui::Checkbox("play each", &play_each_);
    widgets::mark("play each");
    widgets::explain("Plays each breeding from the start when it appears");
    if (may_hold(context.world)) {
        ImGui::SameLine();
        bool held = hold_.on();
        if (ImGui::Checkbox("hold the world", &held)) {
            held ? hold_.hold(run_of(context.world)) : hold_.release();
        }
        widgets::mark("hold the world");
        widgets::explain(
            "While this panel is open, pauses the world after each generation, one tick into the next. Resuming runs "
            "one more generation.");
    }
    if (const auto selected = context.world.feed.selected();
        shown_ && selected && shown_->key().generation == newest_ && *selected < shown_->descendant_count()) {
        ImGui::SameLine();
        if (widgets::button("birth of the selected organism")) {
            stepper_.go_to(1 + shown_->pick_count() + *selected);
        }
    }
    if (shown_) {
        widgets::small_text("Generation " + with_separators(shown_->key().generation) + ": " +
                            breeding_summary(*shown_));
    }
}

void BreedingPanel::build_transport(const Gui& gui) {
    const auto button = [](const char* text, const char* what) {
        const bool hit = ImGui::Button(text);
        widgets::mark(std::string_view{text}.substr(0, std::string_view{text}.find('#')));
        widgets::explain(what);
        ImGui::SameLine();
        return hit;
    };
    if (button("|<", "To the beginning (Home)")) {
        stepper_.to_begin();
    }
    if (button("<<", "To the previous stage (Page Up)")) {
        stepper_.previous_stage();
    }
    if (button("<", "One step back (left)")) {
        stepper_.back();
    }
    if (button(stepper_.playing() ? "Stop###play" : "Play###play", "Plays or stops (Space, Enter)")) {
        stepper_.play_or_stop();
    }
    if (button(">", "One step forward (right)")) {
        stepper_.step();
    }
    if (button(">>", "To the next stage (Page Down)")) {
        stepper_.next_stage();
    }
    if (button(">|", "To the end (End)")) {
        stepper_.to_end();
    }
    ImGui::SetNextItemWidth(120 * gui.scale());
    auto speed = static_cast<float>(stepper_.speed());
    if (ImGui::SliderFloat("##speed", &speed, static_cast<float>(Stepper::speed_min),
                           static_cast<float>(Stepper::speed_max), "%.3g steps/s", ImGuiSliderFlags_Logarithmic)) {
        stepper_.set_speed(double{speed});
    }
    widgets::mark("steps/s");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1);
    auto position = static_cast<int>(stepper_.position());
    if (ImGui::SliderInt("##position", &position, 0, static_cast<int>(stepper_.last_position()), "step %d")) {
        stepper_.go_to(static_cast<std::uint32_t>(std::max(position, 0)));
    }
    widgets::mark("step");
}

void BreedingPanel::take_keys() {
    if (!ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows) || ImGui::IsAnyItemActive()) {
        return;
    }
    if (pressed(ImGuiKey_LeftArrow)) {
        stepper_.back();
    } else if (pressed(ImGuiKey_RightArrow)) {
        stepper_.step();
    } else if (pressed(ImGuiKey_PageUp)) {
        stepper_.previous_stage();
    } else if (pressed(ImGuiKey_PageDown)) {
        stepper_.next_stage();
    } else if (pressed(ImGuiKey_Home)) {
        stepper_.to_begin();
    } else if (pressed(ImGuiKey_End)) {
        stepper_.to_end();
    } else if (pressed(ImGuiKey_Space) || pressed(ImGuiKey_Enter)) {
        stepper_.play_or_stop();
    }
}

void BreedingPanel::build_stage(const Context& context) {
    const Gui& gui = context.gui;
    const Moment moment = stepper_.moment();
    ImGui::BeginChild("caption", {0, 3 * ImGui::GetTextLineHeightWithSpacing()});
    widgets::small_text(caption(*shown_, moment), palette::text);
    ImGui::EndChild();
    const float height = ImGui::GetContentRegionAvail().y - 8;
    const float strip = 14 * gui.scale();
    switch (moment.stage) {
    case BreedingStage::Scaling:
        if (comparison_) {
            draw_ranking(sheet_of(gui, height), *shown_, *comparison_, {}, nullptr);
        }
        break;
    case BreedingStage::Picking: {
        const evod::v1::Pick* pick = shown_->pick(moment.index);
        const Sheet sheet = sheet_of(gui, height - strip - 34 * gui.scale());
        if (pick != nullptr && pick->has_turns()) {
            draw_wheel(sheet, *shown_, moment.index);
        } else if (pick != nullptr && pick->has_tournament() && !pick->contestants().empty()) {
            draw_tournament(sheet, *shown_, moment.index);
        } else if (comparison_) {
            draw_ranking(sheet, *shown_, *comparison_, copies_after(*shown_, moment.index + 1), pick);
        }
        draw_picks(sheet_of(gui, strip), *shown_, moment.index);
        widgets::small_text("picks in order; light: the fittest organism, dark: the lowest rank");
        break;
    }
    case BreedingStage::Breeding:
        draw_descendants(sheet_of(gui, strip), *shown_, &moment.index);
        widgets::small_text("black: elite, dark: survivors, light: children");
        if (const evod::v1::Descendant* descendant = shown_->descendant(moment.index)) {
            widgets::small_text("blue: genes of the first parent, orange: genes of the second parent, "
                                "grey: blended, dashed: cuts, framed: mutated or clamped");
            const float used = draw_family(sheet_of(gui, 1), *descendant, context.world.feed.gene_names());
            ImGui::Dummy({1, used}); // reserves the height of the family drawing, so that the panel can scroll
        }
        break;
    case BreedingStage::Done:
        draw_descendants(sheet_of(gui, strip), *shown_, nullptr);
        widgets::small_text("black: elite, dark: survivors, light: children");
        if (comparison_) {
            draw_ranking(sheet_of(gui, height - 50 * gui.scale()), *shown_, *comparison_, comparison_->copies, nullptr);
        }
        break;
    }
}

void BreedingPanel::build_theory(const Gui& gui) {
    ImGui::TextUnformatted("Theory");
    if (!comparison_) {
        const evod::v1::Breeding& breeding = shown_->breeding();
        widgets::small_text(breeding.contender_count() > BreedingRecord::rows_kept_max
                                ? "Theory needs all organisms; only the first " +
                                      with_separators(BreedingRecord::rows_kept_max) + " are requested."
                                : with_separators(static_cast<std::uint64_t>(breeding.contenders_size())) + " of " +
                                      with_separators(breeding.contender_count()) + " organisms received …");
        return;
    }
    const Moment moment = stepper_.moment();
    const std::uint32_t picks = shown_->breeding().pick_count();
    const bool picking = moment.stage == BreedingStage::Picking && picks > 0;
    const std::uint32_t made = picking ? moment.index + 1 : moment.stage == BreedingStage::Scaling ? 0 : picks;
    draw_copies(sheet_of(gui, std::min(300.f * gui.scale(), ImGui::GetContentRegionAvail().y * 0.6f)), *comparison_,
                picking || made == 0 ? copies_after(*shown_, made) : comparison_->copies,
                picking ? double(made) / picks : 1);
    widgets::small_text(print("%zu of %zu ranks deviate by more than two standard errors", comparison_->beyond_two,
                              comparison_->organisms.size()),
                        palette::text);
    for (const Prediction& prediction : comparison_->predictions) {
        ImGui::Separator();
        widgets::small_text(print("%.*s: expected %s, observed %s", static_cast<int>(prediction.name.size()),
                                  prediction.name.data(), shown(prediction.expected, prediction.unit).c_str(),
                                  shown(prediction.observed, prediction.unit).c_str()),
                            palette::text);
        if (const auto off = prediction.deviation()) {
            widgets::small_text(print("%+.2f standard errors", *off), palette::text);
        }
        widgets::small_text(std::string{prediction.sentence} + " (" + std::string{prediction.source} + ")");
    }
}

} // namespace evod::viewer
