#include "client/viewer/panels/parameters_panel.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/widgets.h"
#include "client/viewer/world/status_text.h"

#include <SFML/Window/Keyboard.hpp>
#include <imgui.h>

#include <algorithm>

namespace evod::viewer {

namespace {

using evod::v1::ParameterDescription;
using evod::v1::ParameterValue;

struct EffectWords {
    const char *mark, *sentence;
};
EffectWords words_of(evod::v1::ParameterEffect effect) {
    switch (effect) {
    case evod::v1::PARAMETER_EFFECT_NEXT_TICK:
        return {"now", "Takes effect at the next tick; breeding parameters, at the next breeding."};
    case evod::v1::PARAMETER_EFFECT_NEXT_GENERATION:
        return {"generation", "Takes effect with the next generation."};
    case evod::v1::PARAMETER_EFFECT_RESET:
        return {"reset", "Takes effect when the world is reset."};
    default:
        return {"", ""};
    }
}

/// Doubles every % sign, so that printf-style functions print the text unchanged.
std::string escape_percent_signs(const std::string& text) {
    std::string escaped;
    for (const char sign : text) {
        escaped += sign == '%' ? "%%" : std::string(1, sign);
    }
    return escaped;
}

/// Shows the description of a parameter if the mouse rests on the last widget.
void explain(const ParameterDescription& about, const ParameterEdits& edits, std::size_t i,
             std::string_view more = "") {
    if (!widgets::wants_note()) {
        return;
    }
    std::string text = about.help() + "\n\nAllowed: " + allowed_text(about) +
                       (about.unit().empty() ? "" : " " + about.unit()) +
                       "\nDefault: " + to_text(about.default_value()) + "\nNow: " + to_text(edits.current_value(i));
    if (edits.is_pending(i)) {
        text += ", then " + to_text(edits.requested_value(i));
    }
    widgets::note(text + "\n" + words_of(about.effect()).sentence + std::string{more});
}

} // namespace

std::span<const Panel::Key> ParametersPanel::keys() const {
    static constexpr Key keys[] = {
        {.key = sf::Keyboard::Z, .help = "undo your last change", .control = true},
        {.key = sf::Keyboard::Y, .help = "redo the last undone change", .control = true},
        {.key = sf::Keyboard::Z, .help = "", .control = true, .shift = true},
    };
    return keys;
}

void ParametersPanel::build(Context& context) {
    ViewedWorld& world = context.world;
    follow(context);
    std::string_view why = world.commands.read_only_reason();
    if (world.replay.info() != nullptr) {
        why = "This world is a replay and cannot be changed.";
    }
    const bool may = why.empty();
    for (const Poll* poll : {&registry_poll_, &values_poll_}) {
        if (!poll->problem().empty()) {
            widgets::small_text(poll->problem(), palette::warning);
        }
    }
    if (!edits_.known()) {
        widgets::small_text("Loading the parameters …");
        return;
    }
    const float scale = context.gui.scale();
    if (!why.empty()) {
        widgets::small_text(why, palette::stopped);
    }
    ImGui::BeginDisabled(!may);
    build_head(context, may);
    ImGui::EndDisabled();
    ImGui::SetNextItemWidth(-1);
    ImGui::InputTextWithHint("##search", "search in names, units and descriptions", search_.data(), search_.size());
    widgets::mark("Search");
    ImGui::BeginChild("rows");
    ImGui::BeginDisabled(!may);
    build_rows(scale);
    ImGui::EndDisabled();
    ImGui::EndChild();
    apply_ = apply_ && may;
    if (apply_ && !edits_.busy()) { // apply_ is set in the frame in which the user releases a slider
        apply_ = false;
        send(context, edits_.apply(world.feed.name()));
    }
}

// ---- exchange with the server -----------------------------------------------------------------------------------

void ParametersPanel::follow(const Context& context) {
    using Kind = evod::v1::Event::KindCase;
    const ViewedWorld& world = context.world;
    if (world.feed.world() != world_ || world.feed.control().run_id() != run_id_) {
        world_ = world.feed.world();
        run_id_ = world.feed.control().run_id();
        edits_.forget();
        values_poll_.reset();
        ++transaction_;
        apply_ = false;
        stale_ = true;
    }
    const std::uint64_t connected_count = world.server.status().connected_count;
    // Request the values again if the panel may have missed events.
    stale_ = stale_ || context.just_shown || world.feed.place_number() != place_number_ ||
             connected_count != connected_count_;
    place_number_ = world.feed.place_number();
    connected_count_ = connected_count;
    for (const evod::v1::Event& event : world.feed.events()) {
        if (event.kind_case() == Kind::kEventsDropped) {
            stale_ = true;
        } else if (event.world() != world.feed.name()) {
            continue;
        } else if (event.kind_case() == Kind::kParametersChanged && edits_.known()) {
            stale_ = !edits_.update(event.parameters_changed()) || stale_;
        } else if (event.kind_case() == Kind::kGenerationFinished) {
            stale_ = stale_ || edits_.has_pending(); // pending values have taken effect
        }
    }
    if (edits_.busy() && context.now - sent_ > Poll::answer_timeout) { // the answer is overdue
        ++transaction_;
        stale_ = edits_.answered(nullptr);
    }
    poll(context);
}

void ParametersPanel::poll(const Context& context) {
    if (registry_poll_.due(context.world, context.now) && edits_.registry().empty()) {
        evod::v1::Request request;
        request.mutable_describe();
        registry_poll_.send(context.world, std::move(request), context.now, [this](const evod::v1::Response* response) {
            if (response != nullptr) {
                const auto& registry = response->description().parameters();
                edits_.describe({registry.begin(), registry.end()});
                groups_ = group(edits_.registry());
                stale_ = true;
            }
        });
    }
    const bool wanted = stale_ || values_poll_.pending(); // if a pending poll is due, its request has timed out
    if (values_poll_.due(context.world, context.now) && wanted && !edits_.registry().empty()) {
        stale_ = false;
        evod::v1::Request request;
        request.mutable_get_parameters()->set_world(context.world.feed.world());
        values_poll_.send(context.world, std::move(request), context.now, [this](const evod::v1::Response* response) {
            if (response != nullptr) {
                edits_.update(response->parameters());
            } else {
                stale_ = true;
            }
        });
    }
}

void ParametersPanel::send(const Context& context, std::optional<evod::v1::Request> request) {
    if (request) {
        sent_ = context.now;
        context.world.server.send(*std::move(request), [this, transaction = ++transaction_](const auto& response) {
            if (transaction == transaction_) {
                stale_ = edits_.answered(response ? &*response : nullptr) || stale_;
            }
        });
    }
}

// ---- widgets ---------------------------------------------------------------------------------------------------

void ParametersPanel::build_head(const Context& context, bool may) {
    const ViewedWorld& world = context.world;
    const float scale = context.gui.scale();
    const ImGuiIO& io = ImGui::GetIO();
    const bool keys =
        may && ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows) && !io.WantTextInput && io.KeyCtrl;
    const bool undo_key = keys && ImGui::IsKeyPressed(sf::Keyboard::Z, false) && !io.KeyShift;
    const bool redo_key = keys && (ImGui::IsKeyPressed(sf::Keyboard::Y, false) ||
                                   (ImGui::IsKeyPressed(sf::Keyboard::Z, false) && io.KeyShift));
    const std::size_t count = edits_.edit_count();
    ImGui::BeginDisabled(count == 0 || edits_.busy());
    if (widgets::button("Apply")) {
        apply_ = true;
    }
    widgets::explain(count == 0 ? "There are no edits."
                                : "Sends all edits as one change: the server accepts all of them or none.");
    ImGui::SameLine();
    if (widgets::button("Discard")) {
        edits_.revert_all();
    }
    ImGui::EndDisabled();
    ImGui::SameLine(0, 20 * scale);
    ImGui::BeginDisabled(!edits_.can_undo());
    if (widgets::button("Undo") || (undo_key && edits_.can_undo())) {
        send(context, edits_.undo(world.feed.name()));
    }
    widgets::explain(
        "Ctrl+Z: restores the values before your last change, except values that others have changed since.");
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(!edits_.can_redo());
    if (widgets::button("Redo") || (redo_key && edits_.can_redo())) {
        send(context, edits_.redo(world.feed.name()));
    }
    widgets::explain("Ctrl+Shift+Z: applies the last undone change again.");
    ImGui::EndDisabled();
    ImGui::SameLine(0, 20 * scale);
    ImGui::Checkbox("apply on release", &apply_on_release_);
    widgets::mark("apply on release");
    widgets::explain("Sends a value as soon as you release the mouse button.");
    if (!edits_.problem().empty()) {
        widgets::small_text(edits_.problem(), palette::warning);
        widgets::mark("problem");
        return;
    }
    const std::string revision = "Revision " + std::to_string(edits_.revision());
    widgets::small_text(edits_.busy() ? "Sending …"
                        : count == 0  ? revision + "; no edits"
                                      : std::to_string(count) + (count == 1 ? " edit" : " edits") + " not applied yet");
    if (!edits_.busy()) {
        widgets::mark(count == 0 ? revision : std::to_string(count) + " edited");
    }
}

void ParametersPanel::build_rows(float scale) {
    const bool searching = search_[0] != '\0';
    bool any = false;
    for (const ParameterGroup& part : groups_) {
        const auto hit = [&](std::size_t i) { // show rejected values even if they do not match the search
            return edits_.violation(i) != nullptr || matches(edits_.registry()[i], search_.data());
        };
        bool hits = false, needs_attention = false;
        for (std::size_t i = part.first; i < part.end; ++i) {
            hits = hits || hit(i);
            needs_attention = needs_attention || edits_.is_edited(i) || edits_.violation(i) != nullptr;
        }
        if (!hits) {
            continue;
        }
        any = true;
        const std::string title{part.title};
        if (searching || needs_attention) { // open groups that contain matches, edits or rejected values
            ImGui::SetNextItemOpen(true);
        }
        if (!ImGui::CollapsingHeader(title.c_str(), ImGuiTreeNodeFlags_DefaultOpen)) {
            continue;
        }
        if (!ImGui::BeginTable(title.c_str(), 3, ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_RowBg)) {
            continue;
        }
        ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch, 4);
        ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch, 5);
        ImGui::TableSetupColumn("effect", ImGuiTableColumnFlags_WidthFixed, 76 * scale);
        for (std::size_t i = part.first; i < part.end; ++i) {
            if (hit(i)) {
                ImGui::PushID(static_cast<int>(i));
                build_row(i);
                ImGui::PopID();
            }
        }
        ImGui::EndTable();
    }
    if (!any) {
        widgets::small_text("No parameter matches.");
    }
}

void ParametersPanel::build_row(std::size_t i) {
    const ParameterDescription& about = edits_.registry()[i];
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    const Colour colour = edits_.violation(i) != nullptr ? palette::warning
                          : edits_.is_edited(i)          ? palette::stopped
                                                         : palette::text;
    ImGui::PushStyleColor(ImGuiCol_Text, ink(colour));
    ImGui::TextUnformatted(about.name().c_str());
    ImGui::PopStyleColor();
    explain(about, edits_, i);
    build_menu(i);
    ImGui::TableNextColumn();
    build_field(i);
    build_remarks(i);
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    const EffectWords effect = words_of(about.effect());
    ImGui::PushStyleColor(
        ImGuiCol_Text,
        ink(about.effect() == evod::v1::PARAMETER_EFFECT_NEXT_TICK ? palette::running : palette::text_quiet));
    ImGui::TextUnformatted(effect.mark);
    ImGui::PopStyleColor();
    widgets::explain(effect.sentence);
}

void ParametersPanel::build_field(std::size_t i) {
    const ParameterDescription& about = edits_.registry()[i];
    ImGui::SetNextItemWidth(-1);
    bool released = false;
    switch (about.kind()) {
    case evod::v1::PARAMETER_KIND_FLAG: {
        ParameterValue value = edits_.shown(i);
        bool flag = value.flag();
        if (ImGui::Checkbox("##value", &flag)) {
            value.set_flag(flag);
            edits_.edit(i, value);
            released = true;
        }
        widgets::mark(about.name());
        explain(about, edits_, i);
        break;
    }
    case evod::v1::PARAMETER_KIND_CHOICE:
        released = build_choice(i);
        break;
    default:
        released = build_number(i);
        break;
    }
    if (released && apply_on_release_) {
        apply_ = true;
    }
}

bool ParametersPanel::build_number(std::size_t i) {
    const ParameterDescription& about = edits_.registry()[i];
    double number = number_of(edits_.shown(i));
    const double least = about.min(), most = about.max();
    const std::string format = (about.kind() == evod::v1::PARAMETER_KIND_COUNT ? "%.0f" : "%.6g") +
                               (about.unit().empty() ? "" : " " + escape_percent_signs(about.unit()));
    if (ImGui::SliderScalar("##value", ImGuiDataType_Double, &number, &least, &most, format.c_str(),
                            spans_decades(about) ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None)) {
        edits_.edit(i, value_of(about, number));
    }
    widgets::mark(about.name());
    const bool released = ImGui::IsItemDeactivatedAfterEdit();
    if (!ImGui::IsItemActive()) {
        explain(about, edits_, i, "\n\nDrag, or Ctrl+click to type.");
    }
    return released;
}

bool ParametersPanel::build_choice(std::size_t i) {
    const ParameterDescription& about = edits_.registry()[i];
    ParameterValue value = edits_.shown(i);
    bool released = false;
    if (widgets::begin_drop_down("##value", value.choice().c_str(), about.name())) {
        for (const std::string& choice : about.choices()) {
            if (widgets::choice(about.name(), choice, choice == value.choice())) {
                value.set_choice(choice);
                edits_.edit(i, value);
                released = true;
            }
        }
        ImGui::EndCombo();
    } else {
        explain(about, edits_, i);
    }
    return released;
}

void ParametersPanel::build_menu(std::size_t i) {
    const ParameterDescription& about = edits_.registry()[i];
    if (!ImGui::BeginPopupContextItem("menu")) {
        return;
    }
    if (ImGui::MenuItem("Discard the edit", nullptr, false, edits_.is_edited(i))) {
        edits_.revert(i);
    }
    if (ImGui::MenuItem(("Default: " + to_text(about.default_value())).c_str())) {
        edits_.edit(i, about.default_value());
        apply_ = apply_ || apply_on_release_;
    }
    ImGui::EndPopup();
}

void ParametersPanel::build_remarks(std::size_t i) {
    if (const evod::v1::Violation* violation = edits_.violation(i)) {
        widgets::small_text((violation->got().empty() ? "" : "got " + violation->got() + ", ") + "allowed " +
                                violation->allowed(),
                            palette::warning);
        widgets::mark(edits_.registry()[i].name() + " is refused");
    }
    if (edits_.is_edited(i)) {
        widgets::small_text("was " + to_text(edits_.requested_value(i)), palette::stopped);
    } else if (edits_.is_pending(i)) {
        widgets::small_text("still " + to_text(edits_.current_value(i)));
    }
    if (!edits_.client_of_last_change(i).empty()) {
        widgets::small_text("set by " + edits_.client_of_last_change(i));
    }
}

} // namespace evod::viewer
