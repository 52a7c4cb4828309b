#include "client/viewer/panels/breeding/breeding_panel.h"

#include "client/viewer/drawing/imgui_keys.h"
#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/widgets.h"
#include "client/viewer/panels/breeding/caption.h"
#include "client/viewer/panels/breeding/descendant_drawing.h"
#include "client/viewer/panels/breeding/selection_drawing.h"
#include "client/viewer/panels/breeding/wheel_layout.h"
#include "client/viewer/text/numbers.h"
#include "client/viewer/world/status_text.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace evod::viewer {

namespace {

// Minimum times for which a breeding stays on the screen: while the panel follows a fast world, and after the breeding
// was played to its end.
constexpr std::chrono::milliseconds shown_min{500}, shown_after_playing{1500};
// Least width in pixels at scale 1 of a panel that shows the step and the theory side by side.
constexpr float columns_width_min = 560;

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
    constexpr double rounding_error = 1e-12; // the numbers are sums of shares
    return number ? three_digits(std::abs(*number) < rounding_error ? 0 : *number) + (unit.empty() ? "" : " ") +
                        std::string{unit}
                  : "–";
}

/// Continues the line if an item of this width fits into it.
void same_line_if_fits(float width) {
    ImGui::SameLine();
    if (ImGui::GetContentRegionAvail().x < width) {
        ImGui::NewLine();
    }
}

float check_box_width(const char* label) {
    return ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x + ImGui::CalcTextSize(label).x;
}

/// Returns whether the panel may pause the world after each generation: the session may command it, and it is not a
/// replay.
bool may_hold(const ViewedWorld& world) {
    return world.commands.may_command() && world.replay.info() == nullptr;
}

GenerationHold::Run run_of(const ViewedWorld& world) {
    return {world.feed.control().world(), world.feed.control().run_id()};
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
    if (const auto wanted = context.island_view.take_wanted_pick()) {
        follow_ = false;
        chosen_ = wanted->generation;
        sought_ = wanted->id;
        theory_shown_ = false;
    }
    choose(context);
    seek_pick();
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
        if (last_ == 0) {
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
    bets_closed_ = bets_closed_ || stepper_.moment().stage != BreedingStage::Scaling;
    const float width = ImGui::GetContentRegionAvail().x;
    const bool both = width >= columns_width_min * context.gui.scale();
    if (!both) {
        for (const bool theory : {false, true}) {
            if (ImGui::RadioButton(theory ? "Theory" : "Step", theory_shown_ == theory)) {
                theory_shown_ = theory;
            }
            widgets::mark(theory ? "Theory" : "Step");
            ImGui::SameLine(0, 16 * context.gui.scale());
        }
        ImGui::NewLine();
    }
    if (both || !theory_shown_) {
        ImGui::BeginChild("stage", {both ? std::floor(width * 0.6f) - 8 : 0, 0});
        build_stage(context);
        ImGui::EndChild();
    }
    if (both) {
        ImGui::SameLine();
    }
    if (both || theory_shown_) {
        ImGui::BeginChild("theory", {0, 0});
        build_theory(context.gui);
        ImGui::EndChild();
    }
}

// ---- which generation is shown, and what to request --------------------------------------------------------------

void BreedingPanel::choose(const Context& context) {
    const evod::v1::SnapshotFrame& about = context.world.feed.snapshot()->about;
    BreedingRecord::Key key{about.world(), about.run_id(), about.island(), 0};
    newest_ = about.generation() - std::min<std::uint64_t>(about.generation(), 1);
    const evod::v1::Replay* replay = context.world.replay.info();
    last_ = replay != nullptr ? std::max(newest_ + 1, replay->last_generation()) - 1 : newest_;
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
    if (last_ == 0) {
        return;
    }
    if (stepper_.playing()) {
        next_change_ = context.now + shown_after_playing;
    }
    // Wait for a pending answer before requesting a newer generation. In a fast world there is always a newer one, so
    // the panel would never show a generation.
    const bool idle = !next_ || !error_.empty();
    const bool bets_open = !bets_.organisms().empty() && !bets_closed_;
    const bool settled = !stepper_.playing() && !bets_open && (stepper_.at_begin() || stepper_.at_end());
    if (follow_ && newest_ > 0 && idle && settled && context.now >= next_change_) {
        chosen_ = newest_;
    }
    chosen_ = std::clamp<std::uint64_t>(chosen_, 1, last_);
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
    // While a pick is sought, all picks are needed.
    const Moment needed = next_     ? Moment{}
                          : sought_ ? Moment{BreedingStage::Picking, shown_->pick_count()}
                                    : stepper_.moment();
    if (auto wanted = record->wanted(needed)) {
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
    bets_.clear();
    bets_closed_ = false;
    stepper_.load(shown_->pick_count(), shown_->descendant_count());
    if (betting_) {
        return; // the bets come first
    }
    if (play_each_) {
        stepper_.play();
    } else if (at_end) {
        stepper_.to_end(); // the user skipped the steps of the previous breeding
    }
}

void BreedingPanel::seek_pick() {
    if (!sought_ || next_ || !shown_ || !shown_->known()) {
        return;
    }
    const auto& picks = shown_->breeding().picks();
    const auto found = std::ranges::find(picks, *sought_, &evod::v1::Pick::organism);
    if (found != picks.end()) {
        stepper_.go_to(1 + static_cast<std::uint32_t>(found - picks.begin()));
        sought_.reset();
    } else if (static_cast<std::uint32_t>(picks.size()) >= shown_->pick_count()) { // the organism was not picked
        stepper_.go_to(shown_->pick_count());
        sought_.reset();
    }
}

std::uint32_t BreedingPanel::picks_made() const {
    const Moment moment = stepper_.moment();
    return moment.stage == BreedingStage::Scaling   ? 0
           : moment.stage == BreedingStage::Picking ? moment.index + 1
                                                    : shown_->breeding().pick_count();
}

bool BreedingPanel::picks_complete() const {
    return stepper_.moment().stage != BreedingStage::Scaling && picks_made() >= shown_->breeding().pick_count();
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
    widgets::mark_field("Generation", static_cast<double>(chosen_));
    if (changed && last_ > 0) {
        follow_ = false;
        chosen_ = std::clamp<std::uint64_t>(wanted, 1, last_);
    }
    widgets::explain("Generation of the parents; the panel shows any generation that has bred");
    build_options(context);
    if (const auto selected = context.world.feed.selected();
        shown_ && selected && shown_->key().generation == newest_ && *selected < shown_->descendant_count()) {
        if (widgets::button("birth of the selected organism")) {
            stepper_.go_to(1 + shown_->pick_count() + *selected);
        }
    }
    if (shown_) {
        widgets::small_text("World " + context.world.feed.name() + ", generation " +
                            with_separators(shown_->key().generation) + ": " + breeding_summary(*shown_));
    }
}

void BreedingPanel::build_options(const Context& context) {
    same_line_if_fits(check_box_width("the newest"));
    widgets::checkbox("the newest", follow_);
    widgets::explain("Shows each new breeding once the previous one has been stepped through or skipped");
    same_line_if_fits(check_box_width("bet first"));
    widgets::checkbox("bet first", betting_);
    widgets::explain("Bet on the organisms that will be picked. The score compares the bets with random ones.");
    same_line_if_fits(check_box_width("play each"));
    widgets::checkbox("play each", play_each_);
    widgets::explain("Plays each breeding from the start when it appears; with bets, after the bets");
    if (may_hold(context.world)) {
        same_line_if_fits(check_box_width("hold the world"));
        bool held = hold_.on();
        if (widgets::checkbox("hold the world", held)) {
            held ? hold_.hold(run_of(context.world)) : hold_.release();
        }
        widgets::explain(
            "While this panel is open, pauses the world after each generation, one tick into the next. Resuming runs "
            "one more generation.");
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
    if (button("|<", "Goes to the beginning (Home).")) {
        stepper_.to_begin();
    }
    if (button("<<", "Goes to the previous stage (Page Up).")) {
        stepper_.previous_stage();
    }
    if (button("<", "Goes one step back (←).")) {
        stepper_.back();
    }
    if (button(stepper_.playing() ? "Stop###play" : "Play###play", "Plays or stops (Space, Enter).")) {
        stepper_.play_or_stop();
    }
    if (button(">", "Goes one step forward (→).")) {
        stepper_.step();
    }
    if (button(">>", "Goes to the next stage (Page Down).")) {
        stepper_.next_stage();
    }
    if (button(">|", "Goes to the end (End).")) {
        stepper_.to_end();
    }
    ImGui::SetNextItemWidth(120 * gui.scale());
    auto speed = static_cast<float>(stepper_.speed());
    if (ImGui::SliderFloat("##speed", &speed, static_cast<float>(Stepper::speed_min),
                           static_cast<float>(Stepper::speed_max), "%.3g steps/s", ImGuiSliderFlags_Logarithmic)) {
        stepper_.set_speed(double{speed});
    }
    widgets::mark_field("steps/s", stepper_.speed());
    same_line_if_fits(120 * gui.scale());
    ImGui::SetNextItemWidth(-1);
    auto position = static_cast<int>(stepper_.position());
    if (ImGui::SliderInt("##position", &position, 0, static_cast<int>(stepper_.last_position()), "step %d")) {
        stepper_.go_to(static_cast<std::uint32_t>(std::max(position, 0)));
    }
    widgets::mark_field("step", stepper_.position());
}

void BreedingPanel::take_keys() {
    // Enter in a field ends the input; it must not start to play as well.
    const bool field_was_active = std::exchange(field_active_, ImGui::IsAnyItemActive());
    if (!ImGui::IsWindowFocused(ImGuiFocusedFlags_ChildWindows) || field_active_ || field_was_active) {
        return;
    }
    if (is_key_pressed(ImGuiKey_LeftArrow)) {
        stepper_.back();
    } else if (is_key_pressed(ImGuiKey_RightArrow)) {
        stepper_.step();
    } else if (is_key_pressed(ImGuiKey_PageUp)) {
        stepper_.previous_stage();
    } else if (is_key_pressed(ImGuiKey_PageDown)) {
        stepper_.next_stage();
    } else if (is_key_pressed(ImGuiKey_Home)) {
        stepper_.to_begin();
    } else if (is_key_pressed(ImGuiKey_End)) {
        stepper_.to_end();
    } else if (is_key_pressed(ImGuiKey_Space) || is_key_pressed(ImGuiKey_Enter)) {
        stepper_.play_or_stop();
    }
}

void BreedingPanel::build_stage(const Context& context) {
    const Gui& gui = context.gui;
    const Moment moment = stepper_.moment();
    widgets::small_text(caption(*shown_, moment), palette::text);
    if (moment.stage == BreedingStage::Picking) {
        widgets::mark(print("Pick %u", moment.index + 1));
    }
    build_score();
    const float strip = 14 * gui.scale();
    switch (moment.stage) {
    case BreedingStage::Scaling:
        build_first_step(gui);
        break;
    case BreedingStage::Picking:
        build_picking(gui, moment.index);
        break;
    case BreedingStage::Breeding:
        draw_descendants(sheet_of(gui, strip), *shown_, &moment.index);
        widgets::small_text("black: elite, dark: survivors, light: children");
        if (const evod::v1::Descendant* descendant = shown_->descendant(moment.index)) {
            widgets::small_text("blue: genes of the first parent, orange: genes of the second parent, "
                                "grey: blended, dashed: cuts, framed: mutated or clamped");
            const float used = draw_family(sheet_of(gui, 1), *descendant, context.world.feed.gene_names(),
                                           genes_of(context.world.feed.gene_groups(), evod::v1::GENE_GROUP_BODY).count);
            ImGui::Dummy({1, used}); // reserves the height of the family drawing, so that the panel can scroll
        }
        break;
    case BreedingStage::Done:
        draw_descendants(sheet_of(gui, strip), *shown_, nullptr);
        widgets::small_text("black: elite, dark: survivors, light: children");
        if (comparison_) {
            draw_ranking(sheet_of(gui, ImGui::GetContentRegionAvail().y - 8), *shown_, *comparison_,
                         comparison_->copies, nullptr, true);
        }
        break;
    }
}

void BreedingPanel::build_first_step(const Gui& gui) {
    if (betting_) {
        build_bets(gui);
    }
    const std::uint32_t picks = shown_->pick_count();
    const std::string label = (bets_.organisms().empty() || !betting_ ? "Play the " : "Close the bets and play the ") +
                              with_separators(picks) + (picks == 1 ? " pick" : " picks");
    ImGui::PushStyleColor(ImGuiCol_Button, ink(palette::focus));
    ImGui::PushStyleColor(ImGuiCol_Text, ink(palette::note_text));
    if (ImGui::Button((label + "###play all").c_str(), {-1, 36 * gui.scale()})) {
        stepper_.step();
        stepper_.play();
    }
    ImGui::PopStyleColor(2);
    widgets::mark("Play the picks");
    widgets::explain("Space; the right arrow key shows one pick at a time");
    if (comparison_) {
        draw_ranking(sheet_of(gui, ImGui::GetContentRegionAvail().y - 8), *shown_, *comparison_, {}, nullptr, false);
    }
}

void BreedingPanel::build_bets(const Gui& gui) {
    if (!comparison_) {
        return;
    }
    if (bets_closed_) {
        widgets::small_text("The bets are closed, because picks of this breeding have been shown. Choose another "
                            "generation to bet again.",
                            palette::text);
        return;
    }
    constexpr std::size_t offered_max = 200;
    const std::size_t offered = std::min(comparison_->organisms.size(), offered_max);
    widgets::small_text(print("Which organisms will be picked most often? Click up to %zu. ", Bets::bets_max) +
                            (offered < comparison_->organisms.size()
                                 ? "The " + with_separators(offered) + " fittest organisms are offered, by rank."
                                 : "The fittest organism comes first."),
                        palette::text);
    const float scale = gui.scale(), gap = 4 * scale, width = 40 * scale, height = 26 * scale;
    const auto columns = std::max<std::size_t>(
        1, static_cast<std::size_t>((ImGui::GetContentRegionAvail().x - 14 * scale + gap) / (width + gap)));
    const auto rows = static_cast<float>((offered + columns - 1) / columns);
    const float room = ImGui::GetContentRegionAvail().y - 60 * scale; // the button to play must stay visible
    ImGui::BeginChild("bets", {0, std::clamp(rows * (height + gap) + gap, height + gap, std::max(room, height + gap))});
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {gap, gap});
    const auto count = static_cast<std::uint32_t>(comparison_->organisms.size());
    for (std::size_t rank = 0; rank < offered; ++rank) {
        const std::uint32_t organism = comparison_->organisms[rank];
        const Colour colour = rank_colour(static_cast<double>(rank), count);
        ImGui::PushStyleColor(ImGuiCol_Button, ink(colour));
        ImGui::PushStyleColor(ImGuiCol_ButtonHovered, ink(colour));
        ImGui::PushStyleColor(ImGuiCol_Text, ink(palette::text_on(colour)));
        if (ImGui::Button(std::to_string(organism).c_str(), {width, height})) {
            bets_.toggle(organism);
        }
        ImGui::PopStyleColor(3);
        widgets::mark("bet on " + std::to_string(organism));
        widgets::explain(print("organism %u: rank %zu, fitness ", organism, rank + 1) +
                         three_digits(comparison_->fitness[rank]));
        if (bets_.has(organism)) {
            ImGui::GetWindowDrawList()->AddRect(ImGui::GetItemRectMin(), ImGui::GetItemRectMax(),
                                                ink(palette::glass_current), 0, 0, 3 * scale);
        }
        if ((rank + 1) % columns != 0) {
            ImGui::SameLine();
        }
    }
    ImGui::PopStyleVar();
    ImGui::EndChild();
}

void BreedingPanel::build_score() {
    if ((bets_.organisms().empty() && (!betting_ || bets_closed_)) || !comparison_) {
        return;
    }
    // The line is there before the first bet, so that a bet does not move the buttons.
    std::string placed = bets_.organisms().empty() ? "Your bets: none yet" : "Your bets:";
    for (const std::uint32_t organism : bets_.organisms()) {
        placed += " " + std::to_string(organism);
    }
    widgets::small_text(placed, palette::text);
    if (const std::uint32_t made = picks_made(); made > 0 && !bets_.organisms().empty()) {
        const bool complete = picks_complete();
        const auto copies = complete ? comparison_->copies : copies_after(*shown_, made);
        widgets::small_text(score_text(score_of(bets_, *comparison_, copies, made), complete), palette::text);
        widgets::mark(complete ? "score" : "hits so far");
    }
}

void BreedingPanel::build_picking(const Gui& gui, std::uint32_t index) {
    const bool complete = picks_complete();
    const float strip = 14 * gui.scale();
    const evod::v1::Pick* pick = shown_->pick(index);
    const Sheet sheet = sheet_of(gui, ImGui::GetContentRegionAvail().y - strip - 34 * gui.scale());
    if (pick != nullptr && pick->has_turns()) {
        draw_wheel(sheet, *shown_, index, complete);
    } else if (pick != nullptr && pick->has_tournament() && !pick->contestants().empty()) {
        draw_tournament(sheet, *shown_, index, complete);
    } else if (comparison_) {
        draw_ranking(sheet, *shown_, *comparison_, copies_after(*shown_, index + 1), pick, complete);
    }
    draw_picks(sheet_of(gui, strip), *shown_, index);
    widgets::small_text("picks in order; light: fittest, dark: lowest rank");
}

void BreedingPanel::build_theory(const Gui& gui) {
    if (!comparison_) {
        const evod::v1::Breeding& breeding = shown_->breeding();
        widgets::small_text(breeding.contender_count() > BreedingRecord::rows_kept_max
                                ? "Theory needs all organisms; only the first " +
                                      with_separators(BreedingRecord::rows_kept_max) + " are requested."
                                : with_separators(static_cast<std::uint64_t>(breeding.contenders_size())) + " of " +
                                      with_separators(breeding.contender_count()) + " organisms received …");
        return;
    }
    const std::uint32_t picks = shown_->breeding().pick_count(), made = picks_made();
    const bool complete = picks_complete();
    widgets::small_text(selection_law_text(*shown_), palette::text);
    draw_copies(sheet_of(gui, std::min(300.f * gui.scale(), ImGui::GetContentRegionAvail().y * 0.6f)), *comparison_,
                complete ? comparison_->copies : copies_after(*shown_, made), picks > 0 ? double(made) / picks : 1,
                complete);
    widgets::small_text(complete ? print("%zu of %zu ranks deviate by more than two standard errors",
                                         comparison_->beyond_two, comparison_->organisms.size())
                                 : "The deviations appear after the last pick.",
                        palette::text);
    for (const Prediction& prediction : comparison_->predictions) {
        ImGui::Separator();
        widgets::small_text(std::string{prediction.name} + ": expected " + shown(prediction.expected, prediction.unit) +
                                (complete ? ", observed " + shown(prediction.observed, prediction.unit) : ""),
                            palette::text);
        if (const auto off = prediction.deviation(); off && complete) {
            widgets::small_text(with_sign(*off) + " standard errors", palette::text);
        }
        widgets::small_text(std::string{prediction.sentence} + " (" + std::string{prediction.source} + ")");
    }
}

} // namespace evod::viewer
