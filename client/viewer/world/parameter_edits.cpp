#include "client/viewer/world/parameter_edits.h"

#include "client/core/actor.h"
#include "client/viewer/world/status_text.h"
#include "proto/text/number_text.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <ranges>
#include <utility>

namespace evod::viewer {

namespace {

using evod::v1::ParameterDescription;
using evod::v1::ParameterValue;

constexpr double decades_min = 100; // if max / min is above this ratio, the slider is logarithmic

constexpr std::size_t unit_length_max = 10; // longer units do not fit into a field

std::string plain(std::string_view text) {
    std::string lower{text};
    for (char& sign : lower) {
        sign = sign == '_' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(sign)));
    }
    return lower;
}

constexpr int digits_shown = 10;

constexpr std::string_view field_prefix = "set_parameters.";

} // namespace

// ---- values ----------------------------------------------------------------------------------------------------

bool same(const ParameterValue& a, const ParameterValue& b) {
    if (a.kind_case() != b.kind_case()) {
        return false;
    }
    switch (a.kind_case()) {
    case ParameterValue::kReal:
        return a.real() == b.real();
    case ParameterValue::kCount:
        return a.count() == b.count();
    case ParameterValue::kFlag:
        return a.flag() == b.flag();
    case ParameterValue::kChoice:
        return a.choice() == b.choice();
    case ParameterValue::KIND_NOT_SET:
        break;
    }
    return true;
}

std::string to_text(const ParameterValue& value) {
    switch (value.kind_case()) {
    case ParameterValue::kReal:
        return text::rounded(value.real(), digits_shown);
    case ParameterValue::kCount:
        return with_separators(value.count());
    case ParameterValue::kFlag:
        return value.flag() ? "on" : "off";
    default:
        return value.choice();
    }
}

double number_of(const ParameterValue& value) {
    return value.has_real() ? value.real() : value.count();
}

ParameterValue value_of(const ParameterDescription& parameter, double number) {
    ParameterValue value;
    if (parameter.kind() == evod::v1::PARAMETER_KIND_COUNT) {
        constexpr double most = std::numeric_limits<std::uint32_t>::max();
        value.set_count(static_cast<std::uint32_t>(std::clamp(std::round(number), 0.0, most)));
    } else {
        value.set_real(number);
    }
    return value;
}

bool spans_decades(const ParameterDescription& parameter) {
    const bool count = parameter.kind() == evod::v1::PARAMETER_KIND_COUNT;
    const double least = count || parameter.min() <= 0 ? std::max(parameter.min(), 1.0) : parameter.min();
    return parameter.max() / least > decades_min;
}

std::string allowed_text(const ParameterDescription& parameter) {
    switch (parameter.kind()) {
    case evod::v1::PARAMETER_KIND_FLAG:
        return "on or off";
    case evod::v1::PARAMETER_KIND_CHOICE: {
        std::string names;
        for (const std::string& name : parameter.choices()) {
            names += (names.empty() ? "" : ", ") + name;
        }
        return names;
    }
    default:
        return text::rounded(parameter.min(), digits_shown) + " to " + text::rounded(parameter.max(), digits_shown);
    }
}

std::string label_of(const ParameterDescription& parameter) {
    std::string_view name = parameter.name();
    for (const auto& [unit, end] :
         {std::pair<std::string_view, std::string_view>{"s", "_s"}, {"px", "_px"}, {"px/s", "_px_s"}, {"kg", "_kg"}}) {
        if (parameter.unit() == unit && name.ends_with(end)) {
            name.remove_suffix(end.size());
        }
    }
    std::string label = plain(name);
    if (!label.empty()) {
        label[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(label[0])));
    }
    return label;
}

std::string label_of_choice(std::string_view choice) {
    return plain(choice);
}

std::string unit_text(const ParameterDescription& parameter, double number) {
    std::string unit = parameter.unit();
    if (parameter.kind() == evod::v1::PARAMETER_KIND_COUNT && number == 1 && unit.ends_with('s')) {
        unit.pop_back();
    }
    return unit.empty() || unit.size() > unit_length_max ? "" : " " + unit;
}

bool matches(const ParameterDescription& parameter, std::string_view group, std::string_view search) {
    std::string all = parameter.name() + " " + parameter.unit() + " " + parameter.help() + " " + std::string{group};
    for (const auto* texts : {&parameter.choices(), &parameter.choice_help()}) {
        for (const std::string& choice : *texts) {
            all += " " + choice;
        }
    }
    const std::string text = plain(all);
    const std::string words = plain(search);
    for (std::size_t begin = 0; begin < words.size();) {
        const std::size_t end = std::min(words.find(' ', begin), words.size());
        if (text.find(words.substr(begin, end - begin)) == std::string::npos) {
            return false;
        }
        begin = end + 1;
    }
    return true;
}

ParameterGroup most_used(std::span<const ParameterDescription> registry) {
    ParameterGroup most{"Most used", {}};
    for (std::size_t i = 0; i < registry.size(); ++i) {
        if (registry[i].is_most_used()) {
            most.members.push_back(i);
        }
    }
    return most;
}

std::vector<ParameterGroup> group(std::span<const ParameterDescription> registry) {
    std::vector<ParameterGroup> groups;
    for (std::size_t i = 0; i < registry.size(); ++i) {
        const std::string& topic = registry[i].topic();
        if (groups.empty() || groups.back().title != topic) {
            groups.push_back({topic, {}});
        }
        groups.back().members.push_back(i);
    }
    return groups;
}

// ---- what the server reports -----------------------------------------------------------------------------------

void ParameterEdits::describe(std::vector<ParameterDescription> registry) {
    registry_ = std::move(registry);
    forget();
}

void ParameterEdits::forget() {
    states_.assign(registry_.size(), {});
    for (std::size_t i = 0; i < registry_.size(); ++i) {
        states_[i].value = registry_[i].default_value();
    }
    revision_ = 0;
    sent_.clear();
    problem_.clear();
}

std::optional<std::size_t> ParameterEdits::index_of(std::string_view name) const {
    const auto found = std::ranges::find(registry_, name, &ParameterDescription::name);
    return found == registry_.end() ? std::nullopt : std::optional{static_cast<std::size_t>(found - registry_.begin())};
}

void ParameterEdits::take(const evod::v1::ParameterState& reported) {
    const auto found = index_of(reported.name());
    if (!found) {
        return;
    }
    State& state = states_[*found];
    state.value = reported.value();
    state.pending = reported.has_pending() ? std::optional{reported.pending()} : std::nullopt;
    if (state.edit && same(*state.edit, requested_value(*found))) {
        state.edit.reset();
        state.violation.reset();
    }
}

void ParameterEdits::update(const evod::v1::ParameterSet& set) {
    if (set.revision() < revision_) {
        return; // older than the known set
    }
    for (const evod::v1::ParameterState& state : set.parameters()) {
        take(state);
    }
    revision_ = set.revision();
}

bool ParameterEdits::update(const evod::v1::ParametersChanged& changed) {
    if (changed.revision() <= revision_) {
        return true; // the known set already contains this change
    }
    for (const evod::v1::ParameterState& state : changed.changed()) {
        take(state);
        if (const auto found = index_of(state.name())) {
            states_[*found].client_of_last_change = core::to_text(changed.by());
        }
    }
    const bool next = changed.revision() == revision_ + 1;
    revision_ = changed.revision();
    return next;
}

bool has_pending(const ParameterEdits& edits) {
    const auto parameters = std::views::iota(std::size_t{0}, edits.registry().size());
    return std::ranges::any_of(parameters, [&](std::size_t i) { return edits.is_pending(i); });
}

// ---- one parameter ---------------------------------------------------------------------------------------------

const ParameterValue& ParameterEdits::requested_value(std::size_t i) const {
    return states_[i].pending ? *states_[i].pending : states_[i].value;
}

const ParameterValue& ParameterEdits::shown(std::size_t i) const {
    return states_[i].edit ? *states_[i].edit : requested_value(i);
}

const evod::v1::Violation* ParameterEdits::violation(std::size_t i) const {
    return states_[i].violation ? &*states_[i].violation : nullptr;
}

void ParameterEdits::forget_refusal() {
    for (State& state : states_) {
        state.violation.reset();
    }
    problem_.clear();
}

void ParameterEdits::edit(std::size_t i, ParameterValue value) {
    states_[i].edit.reset();
    forget_refusal();
    if (!same(value, requested_value(i))) {
        states_[i].edit = std::move(value);
    }
}

void ParameterEdits::revert_all() {
    for (State& state : states_) {
        state.edit.reset();
    }
    forget_refusal();
}

std::size_t ParameterEdits::edit_count() const {
    return static_cast<std::size_t>(std::ranges::count_if(states_, [](const State& state) { return !!state.edit; }));
}

// ---- requests ----------------------------------------------------------------------------------------------

std::optional<evod::v1::Request> ParameterEdits::apply(const std::string& world) {
    if (busy() || edit_count() == 0) {
        return std::nullopt;
    }
    evod::v1::Request request;
    evod::v1::SetParameters& set = *request.mutable_set_parameters();
    set.set_world(world);
    set.set_expected_revision(revision_);
    for (std::size_t i = 0; i < states_.size(); ++i) {
        if (states_[i].edit) {
            evod::v1::ParameterAssignment& assignment = *set.add_parameters();
            assignment.set_name(registry_[i].name());
            *assignment.mutable_value() = *states_[i].edit;
            sent_.push_back({i, *states_[i].edit});
        }
    }
    return request;
}

void ParameterEdits::take_refusal(const evod::v1::Status& status) {
    bool marked = false, is_stale = false;
    for (const evod::v1::Violation& violation : status.violations()) {
        const std::string_view field = violation.field();
        const std::string_view name = field.substr(field.starts_with(field_prefix) ? field_prefix.size() : 0);
        is_stale = is_stale || name == "expected_revision";
        if (const auto found = index_of(name)) {
            states_[*found].violation = violation;
            marked = true;
        }
    }
    problem_ = marked     ? "Nothing was changed: see the marked parameters"
               : is_stale ? "Another client changed parameters at the same time: check the values and apply again"
                          : refusal_text(status);
}

bool ParameterEdits::answered(const evod::v1::Response* response) {
    if (!busy()) {
        return false;
    }
    forget_refusal();
    const bool done = response != nullptr && response->status().code() == evod::v1::CODE_UNSPECIFIED;
    if (done) {
        for (const Sent& sent : sent_) {
            State& state = states_[sent.parameter];
            state.client_of_last_change.clear();
            if (state.edit && same(*state.edit, sent.value)) {
                state.edit.reset(); // otherwise the user has edited the value again before the answer
            }
        }
        if (response->has_parameters()) {
            update(response->parameters());
        }
    } else if (response != nullptr) {
        take_refusal(response->status());
    } else {
        problem_ = "No answer arrived: the change may or may not have been applied";
    }
    sent_.clear();
    return !done;
}

} // namespace evod::viewer
