#include "server/simulation/class_rules.h"

#include "proto/text/number_text.h"

#include <algorithm>

namespace evod::simulation {
namespace {

/// The number in a value; nullopt: it is a flag or a choice.
std::optional<double> number_of(const parameters::ParameterValue& value) {
    if (const auto* real = std::get_if<double>(&value)) {
        return *real;
    }
    if (const auto* count = std::get_if<std::uint32_t>(&value)) {
        return *count;
    }
    return std::nullopt;
}

} // namespace

const ParameterRange* ClassRules::range_of(std::string_view parameter) const {
    const auto found = std::ranges::find(ranges, parameter, &ParameterRange::parameter);
    return found == ranges.end() ? nullptr : &*found;
}

std::vector<base::Violation> values_outside(const ClassRules& rules, const std::string& class_name,
                                            std::span<const parameters::Assignment> assignments,
                                            std::string_view field_prefix) {
    std::vector<base::Violation> outside;
    const auto text_of = [](double value) { return text::number_text(value, text::Exponent::Never); };
    for (const parameters::Assignment& assignment : assignments) {
        const ParameterRange* range = rules.range_of(assignment.name);
        const auto number = number_of(assignment.value);
        if (range != nullptr && number && !(*number >= range->min && *number <= range->max)) {
            outside.push_back({std::string{field_prefix} + assignment.name,
                               text_of(range->min) + " to " + text_of(range->max) + " (class " + class_name + ")",
                               text_of(*number)});
        }
    }
    return outside;
}

} // namespace evod::simulation
