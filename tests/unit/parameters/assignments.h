// Assignments for tests: a single one, or one with a valid value other than the default.
#pragma once

#include "server/parameters/model_parameters.h"

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace evod::parameters {

inline std::vector<Assignment> one(std::string_view name, ParameterValue value) {
    return {{std::string{name}, std::move(value)}};
}

/// Values other than the default within the parameter's own range.
inline std::vector<ParameterValue> other_values(const ParameterDescription& description) {
    std::vector<ParameterValue> values;
    if (const auto* real = std::get_if<RealParameter>(&description.kind)) {
        const double now = std::get<double>(description.default_value());
        for (const double value : {now * 0.9, now * 1.05, now + 1, real->range.min, real->range.max}) {
            if (value != now && value >= real->range.min && value <= real->range.max) {
                values.emplace_back(value);
            }
        }
    } else if (const auto* count = std::get_if<CountParameter>(&description.kind)) {
        const std::uint32_t now = std::get<std::uint32_t>(description.default_value());
        for (const std::uint32_t value : {now + 1, now - 1}) {
            if (value >= count->range.min && value <= count->range.max) {
                values.emplace_back(value);
            }
        }
    } else if (std::holds_alternative<FlagParameter>(description.kind)) {
        values.emplace_back(!std::get<bool>(description.default_value()));
    } else {
        for (const std::string_view name : std::get<ChoiceParameter>(description.kind).names) {
            if (name != std::get<std::string>(description.default_value())) {
                values.emplace_back(std::string{name});
            }
        }
    }
    return values;
}

/// One of other_values() that is valid together with `parameters`.
inline Assignment other_value(const ParameterDescription& description, const Parameters& parameters) {
    for (const ParameterValue& value : other_values(description)) {
        const auto assignments = one(description.name, value);
        if (assign(parameters, assignments)) {
            return assignments.front();
        }
    }
    ADD_FAILURE() << description.name << " has no value but its default";
    return {};
}

} // namespace evod::parameters
