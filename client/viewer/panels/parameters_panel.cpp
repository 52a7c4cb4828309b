#include "client/viewer/panels/parameters_panel.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/widgets.h"
#include "client/viewer/world/status_text.h"

#include <imgui.h>
#include <imgui_internal.h> // TablePushBackgroundChannel()

#include <algorithm>

namespace evod::viewer {

namespace {

using evod::v1::ParameterDescription;
using evod::v1::ParameterValue;

struct EffectWords {
    const char *word, *sentence;
};
EffectWords words_of(evod::v1::ParameterEffect effect) {
    switch (effect) {
    case evod::v1::PARAMETER_EFFECT_NEXT_TICK:
        return {"now", "Takes effect at the next tick; breeding parameters, at the next breeding."};
    case evod::v1::PARAMETER_EFFECT_NEXT_GENERATION:
        return {"next gen.", "Takes effect with the next generation."};
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
    std::string text = about.name() + "\n" + about.help() + "\n\nAllowed: " + allowed_text(about) +
                       (about.unit().empty() ? "" : " " + about.unit()) +
                       "\nDefault: " + to_text(about.default_value()) + "\nNow: " + to_text(edits.current_value(i));
    if (edits.is_pending(i)) {
        text += ", then " + to_text(edits.requested_value(i));
    }
    for (int n = 0; n < std::min(about.choices_size(), about.choice_help_size()); ++n) {
        if (about.choices(n) == edits.shown(i).choice()) {
            text += "\n" + label_of_choice(about.choices(n)) + ": " + about.choice_help(n);
        }
    }
    widgets::note(text + "\n" + words_of(about.effect()).sentence + std::string{more});
}

/// Builds the heading of a group. Returns whether the group is open.
bool build_heading(std::string_view title, bool must_open) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TableSetBgColor(ImGuiTableBgTarget_RowBg0, ImGui::GetColorU32(ImGuiCol_Header));
    if (must_open) { // a group that contains matches, edits or rejected values
        ImGui::SetNextItemOpen(true);
    }
    const std::string name{title};
    constexpr ImGuiTreeNodeFlags flags = ImGuiTreeNodeFlags_SpanFullWidth | ImGuiTreeNodeFlags_NoTreePushOnOpen |
                                         ImGuiTreeNodeFlags_DefaultOpen | ImGuiTreeNodeFlags_FramePadding;
    ImGui::TablePushBackgroundChannel(); // otherwise the column would clip the title
    const bool open = ImGui::TreeNodeEx(name.c_str(), flags);
    widgets::mark("group " + name);
    ImGui::TablePopBackgroundChannel();
    return open;
}

} // namespace

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
    build_head(context);
    ImGui::EndDisabled();
    ImGui::SetNextItemWidth(-1);
    ImGui::InputTextWithHint("##search", "search in names, groups and descriptions", search_.data(), search_.size());
    widgets::mark_field("Search", search_.data());
    ImGui::BeginDisabled(!may);
    build_rows(scale);
    ImGui::EndDisabled();
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
        ++change_;
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
            stale_ = stale_ || has_pending(edits_); // pending values have taken effect
        }
    }
    if (edits_.busy() && context.now - sent_ > Poll::answer_timeout) { // the answer is overdue
        ++change_;
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
                groups_.insert(groups_.begin(), most_used(edits_.registry()));
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
        context.world.server.send(*std::move(request), [this, change = ++change_](const auto& response) {
            if (change == change_) {
                stale_ = edits_.answered(response ? &*response : nullptr) || stale_;
            }
        });
    }
}

// ---- widgets ---------------------------------------------------------------------------------------------------

void ParametersPanel::build_head(const Context& context) {
    const float scale = context.gui.scale();
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
    widgets::checkbox("apply at once", apply_at_once_);
    widgets::explain("Applies each change as soon as you make it.");
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
    constexpr ImGuiTableFlags flags =
        ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY;
    if (!ImGui::BeginTable("parameters", 3, flags)) {
        return;
    }
    ImGui::TableSetupColumn("Parameter", ImGuiTableColumnFlags_WidthStretch, 1);
    ImGui::TableSetupColumn("Value", ImGuiTableColumnFlags_WidthStretch, 1);
    ImGui::TableSetupColumn("Effect", ImGuiTableColumnFlags_WidthFixed, 66 * scale);
    ImGui::TableSetupScrollFreeze(0, 1);
    ImGui::PushStyleColor(ImGuiCol_TableHeaderBg, 0); // only the headings of the groups are coloured
    ImGui::PushStyleColor(ImGuiCol_Text, ink(palette::text_quiet));
    ImGui::TableHeadersRow();
    ImGui::PopStyleColor(2);
    widgets::explain(
        "When a change takes effect: at the next tick, with the next generation, or when the world is reset.");
    marked_.assign(edits_.registry().size(), false);
    for (std::size_t number = 0; number < groups_.size(); ++number) {
        const ParameterGroup& part = groups_[number];
        const bool is_extra = number == 0; // its parameters also belong to other groups
        if (is_extra && searching) {
            continue;
        }
        std::vector<std::size_t> hits;
        bool needs_attention = false;
        for (const std::size_t i : part.members) { // show rejected values even if they do not match the search
            if (edits_.violation(i) != nullptr || matches(edits_.registry()[i], part.title, search_.data())) {
                hits.push_back(i);
            }
            needs_attention = needs_attention || edits_.is_edited(i) || edits_.violation(i) != nullptr;
        }
        if (hits.empty()) {
            continue;
        }
        any = true;
        if (build_heading(part.title, searching || (needs_attention && !is_extra))) {
            for (const std::size_t i : hits) {
                ImGui::PushID(static_cast<int>(i + number * edits_.registry().size()));
                const std::string& name = edits_.registry()[i].name();
                build_row({i, marked_[i] ? std::string{part.title} + "/" + name : name});
                marked_[i] = true;
                ImGui::PopID();
            }
        }
    }
    ImGui::EndTable();
    if (!any) {
        widgets::small_text("No parameter matches.");
    }
}

void ParametersPanel::build_row(const Row& row) {
    const std::size_t i = row.parameter;
    const ParameterDescription& about = edits_.registry()[i];
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    const Colour colour = edits_.violation(i) != nullptr ? palette::warning
                          : edits_.is_edited(i)          ? palette::stopped
                                                         : palette::text;
    ImGui::PushStyleColor(ImGuiCol_Text, ink(colour));
    ImGui::TextWrapped("%s", label_of(about).c_str());
    ImGui::PopStyleColor();
    explain(about, edits_, i);
    ImGui::OpenPopupOnItemClick("menu");
    ImGui::TableNextColumn();
    build_field(row);
    build_menu(i);
    build_remarks(i);
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    const EffectWords effect = words_of(about.effect());
    ImGui::PushStyleColor(
        ImGuiCol_Text,
        ink(about.effect() == evod::v1::PARAMETER_EFFECT_NEXT_TICK ? palette::text : palette::text_quiet));
    ImGui::TextUnformatted(effect.word);
    ImGui::PopStyleColor();
    widgets::explain(effect.sentence);
}

void ParametersPanel::build_field(const Row& row) {
    const ParameterDescription& about = edits_.registry()[row.parameter];
    ImGui::SetNextItemWidth(-1);
    bool released = false;
    switch (about.kind()) {
    case evod::v1::PARAMETER_KIND_FLAG:
        released = build_flag(row);
        break;
    case evod::v1::PARAMETER_KIND_CHOICE:
        released = build_choice(row);
        break;
    default:
        released = build_number(row);
        break;
    }
    if (released && apply_at_once_) {
        apply_ = true;
    }
}

/// Adds the label of the parameter to the names of the last widget, unless another row has it.
void ParametersPanel::add_label(const Row& row, const ParameterDescription& about) {
    if (row.name == about.name()) {
        widgets::alias(label_of(about));
    }
}

bool ParametersPanel::build_flag(const Row& row) {
    const ParameterDescription& about = edits_.registry()[row.parameter];
    ParameterValue value = edits_.shown(row.parameter);
    bool flag = value.flag();
    const bool switched = widgets::checkbox("##value", flag, row.name);
    add_label(row, about);
    if (switched) {
        value.set_flag(flag);
        edits_.edit(row.parameter, value);
    }
    explain(about, edits_, row.parameter);
    ImGui::OpenPopupOnItemClick("menu");
    return switched;
}

bool ParametersPanel::build_number(const Row& row) {
    const ParameterDescription& about = edits_.registry()[row.parameter];
    double number = number_of(edits_.shown(row.parameter));
    const double least = about.min(), most = about.max();
    const std::string format = (about.kind() == evod::v1::PARAMETER_KIND_COUNT ? "%.0f" : "%.6g") +
                               escape_percent_signs(unit_text(about, number));
    if (ImGui::SliderScalar("##value", ImGuiDataType_Double, &number, &least, &most, format.c_str(),
                            spans_decades(about) ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None)) {
        edits_.edit(row.parameter, value_of(about, number));
    }
    widgets::mark_field(row.name, number);
    add_label(row, about);
    ImGui::OpenPopupOnItemClick("menu");
    const bool released = ImGui::IsItemDeactivatedAfterEdit();
    if (!ImGui::IsItemActive()) {
        explain(about, edits_, row.parameter, "\n\nDrag, or Ctrl+click to type.");
    }
    return released;
}

bool ParametersPanel::build_choice(const Row& row) {
    const ParameterDescription& about = edits_.registry()[row.parameter];
    ParameterValue value = edits_.shown(row.parameter);
    bool released = false;
    const std::string chosen = label_of_choice(value.choice());
    const bool open = widgets::begin_drop_down("##value", chosen.c_str(), row.name);
    add_label(row, about);
    if (!open) {
        explain(about, edits_, row.parameter);
        ImGui::OpenPopupOnItemClick("menu");
        return false;
    }
    for (int n = 0; n < about.choices_size(); ++n) {
        const std::string& choice = about.choices(n);
        if (widgets::choice(row.name, label_of_choice(choice), choice == value.choice(), choice)) {
            value.set_choice(choice);
            edits_.edit(row.parameter, value);
            released = true;
        }
        if (n < about.choice_help_size()) {
            widgets::explain(about.choice_help(n));
        }
    }
    ImGui::EndCombo();
    return released;
}

void ParametersPanel::build_menu(std::size_t i) {
    const ParameterDescription& about = edits_.registry()[i];
    if (!ImGui::BeginPopup("menu")) {
        return;
    }
    if (ImGui::MenuItem("Discard the edit", nullptr, false, edits_.is_edited(i))) {
        edits_.edit(i, edits_.requested_value(i));
    }
    widgets::mark("Discard the edit");
    const std::string set_default = "Default: " + to_text(about.default_value());
    const bool wanted = ImGui::MenuItem(set_default.c_str());
    widgets::mark(set_default);
    if (wanted) {
        edits_.edit(i, about.default_value());
        apply_ = apply_ || apply_at_once_;
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
