#include "client/viewer/panels/breeding/breeding_panel.h"

#include "client/viewer/drawing/widgets.h"
#include "client/viewer/panels/breeding/caption.h"
#include "client/viewer/panels/breeding/drawing.h"
#include "client/viewer/panels/breeding/selection_drawing.h"
#include "client/viewer/world/status_text.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace evod::viewer {

namespace {

// Following a fast world: one breeding is shown at least so long, and after it was played a little longer.
constexpr std::chrono::milliseconds shown_min{500}, shown_after_playing{1500};

/// A rectangle of the window to draw in, as wide as there is room.
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

/// The past stays as it was, and who only watches holds nothing.
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
        {Keyboard::Space, "play, stop"},           {Keyboard::Enter, ""},
        {Keyboard::Left, "one step back"},         {Keyboard::Right, "one step"},
        {Keyboard::PageUp, "to the stage before"}, {Keyboard::PageDown, "to the next stage"},
        {Keyboard::Home, "to the beginning"},      {Keyboard::End, "to the end"},
    };
    return keys;
}

void BreedingPanel::build(Context& context) {
    if (context.world.feed.snapshot() == nullptr) {
        ImGui::TextUnformatted("Waiting for the first picture …");
        return;
    }
    choose(context);
    ask(context);
    hold_world(context.world);
    build_generation(context);
    if (!error_.empty()) {
        widgets::say(error_, palette::text);
        if (widgets::button("Ask again")) {
            error_.clear();
            poll_.hurry();
        }
    }
    if (!shown_) {
        if (newest_ == 0) {
            widgets::say("The first generation has not been bred from yet: it has to end, and the next to begin.",
                         palette::text);
        } else if (error_.empty()) {
            ImGui::TextUnformatted("Asked for …");
        }
        return;
    }
    build_transport(context.gui);
    take_keys();
    const Moment moment = stepper_.moment();
    const bool here = moment.stage == BreedingStage::Picking    ? shown_->pick(moment.index) != nullptr
                      : moment.stage == BreedingStage::Breeding ? shown_->descendant(moment.index) != nullptr
                                                                : true;
    if (here) { // or else it waits for the answer
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

// ---- what is looked at, and what has to be asked ---------------------------------------------------------------

void BreedingPanel::choose(const Context& context) {
    const evod::v1::SnapshotFrame& picture = context.world.feed.snapshot()->about;
    BreedingRecord::Key key{picture.world(), picture.run_id(), picture.island(), 0};
    newest_ = picture.generation() - std::min<std::uint64_t>(picture.generation(), 1);
    const auto is_of = [&](const std::optional<BreedingRecord>& record) {
        return record && record->key().world == key.world && record->key().run_id == key.run_id &&
               record->key().island == key.island;
    };
    if (!is_of(shown_)) {
        shown_.reset();
        comparison_.reset();
        stepper_.load(0, 0);
    }
    if (!is_of(coming_)) {
        coming_.reset();
    }
    if (newest_ == 0) {
        return;
    }
    if (stepper_.playing()) {
        next_look_ = context.now + shown_after_playing;
    }
    // What was asked for is waited for: in a fast world there is always something newer.
    const bool idle = !coming_ || !error_.empty();
    const bool settled = !stepper_.playing() && (stepper_.at_begin() || stepper_.at_end());
    if (follow_ && idle && settled && context.now >= next_look_) {
        chosen_ = newest_;
    }
    chosen_ = std::clamp<std::uint64_t>(chosen_, 1, newest_);
    key.generation = chosen_;
    const auto& looked_at = coming_ ? coming_ : shown_;
    if (!looked_at || looked_at->key() != key) {
        coming_.emplace(key);
        poll_.reset();
        error_.clear();
        next_look_ = context.now + shown_min;
    }
}

void BreedingPanel::ask(const Context& context) {
    auto& record = coming_ ? coming_ : shown_;
    if (!poll_.due(context.world, context.now) || !record || !error_.empty()) {
        return;
    }
    if (auto wanted = record->wanted(coming_ ? Moment{} : stepper_.moment())) {
        evod::v1::Request request;
        *request.mutable_get_breeding() = std::move(*wanted);
        poll_.send(context.world, std::move(request), context.now, [this](const evod::v1::Response* response) {
            if (response != nullptr) {
                take(response->breeding());
            } else {
                error_ = poll_.problem();
            }
        });
    }
}

void BreedingPanel::take(const evod::v1::Breeding& breeding) {
    if (coming_) {
        coming_->add(breeding);
        if (coming_->known()) {
            show_coming();
        } else {
            error_ = "The server answered with something else than the breeding of generation " +
                     with_separators(coming_->key().generation);
        }
    } else if (shown_) {
        shown_->add(breeding);
    }
    if (shown_ && !comparison_) {
        comparison_ = compare(*shown_);
    }
}

void BreedingPanel::show_coming() {
    const bool at_end = shown_ && stepper_.at_end() && !stepper_.at_begin();
    shown_ = std::exchange(coming_, std::nullopt);
    comparison_.reset();
    stepper_.load(shown_->pick_count(), shown_->descendant_count());
    if (play_each_) {
        stepper_.play();
    } else if (at_end) {
        stepper_.to_end(); // who skips one skips the next
    }
}

void BreedingPanel::hold_world(ViewedWorld& world) {
    if (!may_hold(world)) {
        hold_.let_go();
    }
    switch (hold_.update(run_of(world), world.feed.control().state(), world.feed.control().stepping())) {
    case GenerationHold::Ask::Nothing:
        break;
    case GenerationHold::Ask::RunOneGeneration:
        world.commands.run_generations(1);
        break;
    case GenerationHold::Ask::RunOneTick:
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
    widgets::explain("Of the parents: any that was bred from");
    ImGui::SameLine();
    ImGui::Checkbox("the newest", &follow_);
    widgets::mark("the newest");
    widgets::explain("Shows each breeding when it has happened, once the one before was looked at");
    ImGui::SameLine();
    ImGui::Checkbox("play each", &play_each_);
    widgets::mark("play each");
    widgets::explain("Begins to play when another breeding is shown");
    if (may_hold(context.world)) {
        ImGui::SameLine();
        bool held = hold_.on();
        if (ImGui::Checkbox("hold the world", &held)) {
            held ? hold_.hold(run_of(context.world)) : hold_.let_go();
        }
        widgets::mark("hold the world");
        widgets::explain(
            "Pauses the world after each generation, one tick into the next, as long as this is shown. Going on runs "
            "the next one.");
    }
    if (const auto selected = context.world.feed.selected();
        shown_ && selected && shown_->key().generation == newest_ && *selected < shown_->descendant_count()) {
        ImGui::SameLine();
        if (widgets::button("birth of the selected")) {
            stepper_.go_to(1 + shown_->pick_count() + *selected);
        }
    }
    if (shown_) {
        widgets::say("Generation " + with_separators(shown_->key().generation) + ": " + breeding_summary(*shown_));
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
    if (button("<<", "To the stage before (Page Up)")) {
        stepper_.previous_stage();
    }
    if (button("<", "One step back (left)")) {
        stepper_.back();
    }
    if (button(stepper_.playing() ? "Stop###play" : "Play###play", "Plays, or stops (Space, Enter)")) {
        stepper_.play_or_stop();
    }
    if (button(">", "One step (right)")) {
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
    widgets::say(caption(*shown_, moment), palette::text);
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
        widgets::say("the picks in order, light: the fittest, dark: the last in rank");
        break;
    }
    case BreedingStage::Breeding:
        draw_descendants(sheet_of(gui, strip), *shown_, &moment.index);
        widgets::say("black: the elite, dark: survivors, light: children");
        if (const evod::v1::Descendant* descendant = shown_->descendant(moment.index)) {
            widgets::say(
                "blue: the first parent's, orange: the second's, dashed: cuts, framed: changed by a mutation or "
                "clamped");
            const float used = draw_family(sheet_of(gui, 1), *descendant, context.world.feed.gene_names());
            ImGui::Dummy({1, used}); // what is beyond the panel can be scrolled to
        }
        break;
    case BreedingStage::Done:
        draw_descendants(sheet_of(gui, strip), *shown_, nullptr);
        widgets::say("black: the elite, dark: survivors, light: children");
        if (comparison_) {
            draw_ranking(sheet_of(gui, height - 50 * gui.scale()), *shown_, *comparison_, comparison_->copies, nullptr);
        }
        break;
    }
}

void BreedingPanel::build_theory(const Gui& gui) {
    ImGui::TextUnformatted("What theory says");
    if (!comparison_) {
        const evod::v1::Breeding& breeding = shown_->breeding();
        widgets::say(breeding.contender_count() > BreedingRecord::rows_kept_max
                         ? "Of so many organisms the first " + with_separators(BreedingRecord::rows_kept_max) +
                               " are asked for, and theory needs all of them."
                         : with_separators(static_cast<std::uint64_t>(breeding.contenders_size())) + " of " +
                               with_separators(breeding.contender_count()) + " organisms have come …");
        return;
    }
    const Moment moment = stepper_.moment();
    const std::uint32_t picks = shown_->breeding().pick_count();
    const bool picking = moment.stage == BreedingStage::Picking && picks > 0;
    const std::uint32_t happened = picking ? moment.index + 1 : moment.stage == BreedingStage::Scaling ? 0 : picks;
    draw_copies(sheet_of(gui, std::min(300.f * gui.scale(), ImGui::GetContentRegionAvail().y * 0.6f)), *comparison_,
                picking || happened == 0 ? copies_after(*shown_, happened) : comparison_->copies,
                picking ? double(happened) / picks : 1);
    widgets::say(print("%zu of %zu ranks are more than two standard errors off", comparison_->beyond_two,
                       comparison_->organisms.size()),
                 palette::text);
    for (const Finding& finding : comparison_->findings) {
        ImGui::Separator();
        widgets::say(print("%.*s: expected %s, happened %s", static_cast<int>(finding.name.size()), finding.name.data(),
                           shown(finding.expected, finding.unit).c_str(),
                           shown(finding.happened, finding.unit).c_str()),
                     palette::text);
        if (const auto off = finding.deviation()) {
            widgets::say(print("%+.2f standard errors", *off), palette::text);
        }
        widgets::say(std::string{finding.sentence} + " (" + std::string{finding.source} + ")");
    }
}

} // namespace evod::viewer
