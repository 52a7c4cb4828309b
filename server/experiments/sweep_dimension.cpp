#include "server/experiments/sweep_dimension.h"

#include "server/base/elementary.h"
#include "server/base/overloaded.h"
#include "server/experiments/sweep_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace evod::experiments {

using parameters::CountParameter;
using parameters::JsonMember;
using parameters::JsonNode;
using parameters::ParameterDescription;
using parameters::ParameterValue;
using parameters::RealParameter;

double Range::between(double t, double low, double high) const {
    return log ? base::exp(base::log(low) + t * (base::log(high) - base::log(low))) : low + t * (high - low);
}

ParameterValue Range::value(double x) const {
    x = std::clamp(x, from, to);
    if (whole) {
        return static_cast<std::uint32_t>(x);
    }
    return x;
}

ParameterValue Range::step(std::size_t i, std::size_t steps) const {
    if (i == 0 || i + 1 == steps) {
        return value(i == 0 ? from : to);
    }
    const double x = between(static_cast<double>(i) / static_cast<double>(steps - 1), from, to);
    return value(whole ? std::floor(x + 0.5) : x);
}

ParameterValue Range::quantile(double u) const {
    return value(whole ? std::floor(between(u, from, to + 1)) : between(u, from, to));
}

void set_parameter(const ParameterDescription& description, const ParameterValue& value,
                   parameters::Parameters& parameters) {
    std::visit(
        base::Overloaded{[&](const RealParameter& real) {
                             const auto* count = std::get_if<std::uint32_t>(&value);
                             real.set(parameters, count != nullptr ? *count : std::get<double>(value));
                         },
                         [&](const CountParameter& count) { count.set(parameters, std::get<std::uint32_t>(value)); },
                         [&](const parameters::FlagParameter& flag) { flag.set(parameters, std::get<bool>(value)); },
                         [&](const parameters::ChoiceParameter& choice) {
                             const auto name = std::ranges::find(choice.names, std::get<std::string>(value));
                             choice.set(parameters, static_cast<std::size_t>(name - choice.names.begin()));
                         }},
        description.kind);
}

const ParameterDescription* find_swept(const JsonMember& member, const std::string& field, SweepErrors& errors) {
    const ParameterDescription* parameter = parameters::find_parameter(member.name);
    if (parameter == nullptr) {
        const auto fault = parameters::fault_of({member.name, 0u});
        errors.add(parameters::with_line(field, member.line), fault->allowed, fault->got);
    }
    return parameter;
}

std::optional<ParameterValue> read_swept_value(const ParameterDescription& parameter, const std::string& field,
                                               const JsonNode& node, SweepErrors& errors) {
    const auto value = parameters::parameter_value_of(node);
    if (!value) {
        errors.add(field, node, "a number, true, false or a text");
        return std::nullopt;
    }
    if (auto fault = parameters::fault_of({std::string{parameter.name}, *value})) {
        errors.add(parameters::with_line(field, node.line), std::move(fault->allowed), std::move(fault->got));
        return std::nullopt;
    }
    parameters::Parameters parameters;
    set_parameter(parameter, *value, parameters);
    return parameter.get(parameters);
}

namespace {

/// Adds an error for every value that appears twice. Returns whether there are any.
bool find_repetitions(const Dimension& dimension, const JsonNode& list, const std::string& field, SweepErrors& errors) {
    bool found = false;
    std::set<ParameterValue> seen;
    for (std::size_t i = 0; i < dimension.values.size(); ++i) {
        if (!seen.insert(dimension.values[i]).second) {
            errors.add(field + "[" + std::to_string(i) + "]", list.elements[i], "each value once");
            found = true;
        }
    }
    return found;
}

bool read_values(Dimension& dimension, const JsonNode& list, const std::string& field, SweepErrors& errors) {
    for (std::size_t i = 0; i < list.elements.size(); ++i) {
        auto value =
            read_swept_value(*dimension.parameter, field + "[" + std::to_string(i) + "]", list.elements[i], errors);
        if (value) {
            dimension.values.push_back(*std::move(value));
        }
    }
    return dimension.values.size() == list.elements.size() && !find_repetitions(dimension, list, field, errors);
}

/// Reads the members of a range. Returns the name of the first missing member; nullptr if all are present.
const char* read_range_members(Dimension& dimension, Range& range, const JsonNode& node, const std::string& field,
                               Steps steps, SweepErrors& errors) {
    bool has_from = false, has_to = false, has_steps = steps == Steps::None;
    for (const JsonMember* member : parameters::unique_members(node, field + ".", errors.violations)) {
        const std::string name = field + "." + member->name;
        const JsonNode& value = member->value;
        if (member->name == "from" || member->name == "to") {
            const bool is_from = member->name == "from";
            (is_from ? has_from : has_to) = true;
            if (read_swept_value(*dimension.parameter, name, value, errors)) {
                (is_from ? range.from : range.to) = value.real();
            }
        } else if (member->name == "steps" && steps == Steps::Needed) {
            has_steps = true;
            const auto count = value.whole_number();
            if (count && *count >= 2 && *count <= Sweep::runs_max) {
                dimension.steps = *count;
            } else {
                errors.add(name, value, "a whole number, 2 to " + std::to_string(Sweep::runs_max));
            }
        } else if (member->name == "scale") {
            range.log = value.text == "\"log\"";
            if (!range.log && value.text != "\"linear\"") {
                errors.add(name, value, "linear, log");
            }
        } else {
            errors.add(parameters::with_line(name, member->line),
                       steps == Steps::Needed ? "from, to, steps, scale" : "from, to, scale", base::unknown_name);
        }
    }
    return !has_from ? "from" : !has_to ? "to" : !has_steps ? "steps" : nullptr;
}

bool read_range(Dimension& dimension, const JsonNode& node, const std::string& field, Steps steps,
                SweepErrors& errors) {
    const bool whole = std::holds_alternative<CountParameter>(dimension.parameter->kind);
    if (!whole && !std::holds_alternative<RealParameter>(dimension.parameter->kind)) {
        errors.add(field, node, "a list of values: " + dimension.parameter->allowed());
        return false;
    }
    const std::size_t errors_before = errors.violations.size();
    Range range{.whole = whole};
    if (const char* missing = read_range_members(dimension, range, node, field, steps, errors)) {
        errors.add(parameters::with_line(field, node.line),
                   steps == Steps::Needed ? "from, to and steps" : "from and to", std::string{"no "} + missing);
    }
    if (errors.violations.size() == errors_before && !(range.from < range.to)) {
        errors.add(field, node, "a \"from\" less than \"to\"");
    } else if (errors.violations.size() == errors_before && range.log &&
               range.from < std::numeric_limits<double>::min()) { // base::log() takes no subnormal number
        errors.add(field, node, "a \"from\" above 0, at least 2.3e-308, if the scale is log");
    }
    dimension.range = range;
    return errors.violations.size() == errors_before;
}

} // namespace

std::optional<Dimension> read_dimension(const JsonMember& member, const std::string& field, Steps steps,
                                        SweepErrors& errors) {
    Dimension dimension{.parameter = find_swept(member, field, errors), .values = {}, .range = {}};
    if (dimension.parameter == nullptr) {
        return std::nullopt;
    }
    bool valid = false;
    if (const JsonNode& node = member.value; node.is_object()) {
        valid = read_range(dimension, node, field, steps, errors);
    } else if (node.is_array() && !node.elements.empty()) {
        valid = read_values(dimension, node, field, errors);
    } else {
        errors.add(field, node,
                   steps == Steps::Needed ? R"(a list of values, or {"from": …, "to": …, "steps": …})"
                                          : R"({"from": …, "to": …}, or a list of values)");
    }
    return valid ? std::optional{std::move(dimension)} : std::nullopt;
}

} // namespace evod::experiments
