#include "server/classes/ranges.h"

#include "proto/text/number_text.h"
#include "proto/text/suggestion.h"
#include "server/base/assert.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

namespace evod::classes {
namespace {

using parameters::ParameterDescription;
using text::number_text;

/// The range of a numeric parameter; nullopt: the parameter is of another kind.
std::optional<Range> whole_range(const ParameterDescription& parameter) {
    const std::string name{parameter.name};
    if (const auto* real = std::get_if<parameters::RealParameter>(&parameter.kind)) {
        return Range{name, real->range.min, real->range.max};
    }
    if (const auto* count = std::get_if<parameters::CountParameter>(&parameter.kind)) {
        return Range{name, static_cast<double>(count->range.min), static_cast<double>(count->range.max)};
    }
    return std::nullopt;
}

bool is_count(const ParameterDescription& parameter) {
    return std::holds_alternative<parameters::CountParameter>(parameter.kind);
}

std::string allowed_of(const Range& range, bool whole) {
    const auto text_of = [](double value) { return number_text(value, text::Exponent::Never); };
    return (whole ? "a whole number, " : "") + text_of(range.min) + " to " + text_of(range.max);
}

std::vector<Range> in_order_of_registry(const std::map<std::string, Range>& ranges) {
    std::vector<Range> ordered;
    for (const ParameterDescription& parameter : parameters::parameter_registry()) {
        if (const auto found = ranges.find(std::string{parameter.name}); found != ranges.end()) {
            ordered.push_back(found->second);
        }
    }
    return ordered;
}

} // namespace

const std::vector<Range>& default_ranges() {
    static const std::vector<Range> all = [] {
        // Together, without births and predators: at most 4,000 organisms with 106 genes, and with
        // scale_with_population fifty times as many items as the ranges of food and poison say.
        const std::map<std::string, std::pair<std::optional<double>, std::optional<double>>> limits = {
            {"population_size", {{}, 500}},
            {"island_count", {{}, 8}},
            {"predator_count", {{}, 500}},
            {"population_max", {{}, 10'000}},
            {"predator_population_max", {{}, 10'000}},
            {"island_width_px", {{}, 4000}},
            {"island_height_px", {{}, 4000}},
            {"food_count", {{}, 2000}},
            {"poison_count", {{}, 2000}},
            {"reference_population", {10, {}}},
            {"free_genes", {{}, 100}},
            {"generation_s", {1, {}}},
            {"tick_s", {0.004, {}}}};
        std::map<std::string, Range> ranges;
        for (const auto& [name, limit] : limits) {
            const ParameterDescription* parameter = parameters::find_parameter(name);
            EVOD_ASSERT(parameter != nullptr);
            const auto whole = whole_range(*parameter);
            EVOD_ASSERT(whole.has_value());
            ranges[name] = {name, limit.first.value_or(whole->min), limit.second.value_or(whole->max)};
        }
        return in_order_of_registry(ranges);
    }();
    return all;
}

std::vector<Range> ranges_of(const v1::QuotaRanges& request, const std::string& path,
                             std::vector<base::Violation>& violations) {
    const std::size_t most = parameters::parameter_registry().size();
    if (static_cast<std::size_t>(request.ranges_size()) > most) {
        violations.push_back(
            {path, "at most " + std::to_string(most) + ", each parameter once", std::to_string(request.ranges_size())});
        return default_ranges();
    }
    std::map<std::string, Range> ranges;
    for (const v1::QuotaRange& given : request.ranges()) {
        const std::string field = path + "." + given.parameter();
        const ParameterDescription* parameter = parameters::find_parameter(given.parameter());
        if (parameter == nullptr) {
            std::vector<std::string_view> names;
            for (const ParameterDescription& each : parameters::parameter_registry()) {
                names.push_back(each.name);
            }
            violations.push_back(
                {field, "the name of a parameter" + text::did_you_mean(given.parameter(), names), base::unknown_name});
            continue;
        }
        const auto whole = whole_range(*parameter);
        if (!whole) {
            violations.push_back({field, "a parameter whose values are numbers", given.parameter()});
            continue;
        }
        const bool fits_kind =
            !is_count(*parameter) || (std::floor(given.min()) == given.min() && std::floor(given.max()) == given.max());
        if (!(given.min() >= whole->min && given.max() <= whole->max && fits_kind)) { // also refuses NaN
            violations.push_back({field, allowed_of(*whole, is_count(*parameter)),
                                  number_text(given.min()) + " to " + number_text(given.max())});
        } else if (given.min() > given.max()) {
            violations.push_back(
                {field + ".max", "at least min (" + number_text(given.min()) + ")", number_text(given.max())});
        } else if (!ranges.emplace(given.parameter(), Range{given.parameter(), given.min(), given.max()}).second) {
            violations.push_back({field, "given once", "given twice"});
        }
    }
    for (const Range& range : default_ranges()) {
        ranges.emplace(range.parameter, range);
    }
    return in_order_of_registry(ranges);
}

v1::QuotaRanges to_proto(const std::vector<Range>& ranges) {
    v1::QuotaRanges message;
    for (const Range& range : ranges) {
        v1::QuotaRange& to = *message.add_ranges();
        to.set_parameter(range.parameter);
        to.set_min(range.min);
        to.set_max(range.max);
    }
    return message;
}

void check_ranges(const std::vector<Range>& ranges, const parameters::Parameters& parameters,
                  const parameters::Schedule& schedule, const std::string& class_name, const std::string& path,
                  std::vector<base::Violation>& violations) {
    const simulation::ClassRules rules{.frozen = false, .ranges = ranges, .worlds_per_member = 1};
    const auto check = [&](std::span<const parameters::Assignment> assignments, const std::string& prefix) {
        const auto found = simulation::values_outside(rules, class_name, assignments, prefix);
        violations.insert(violations.end(), found.begin(), found.end());
    };
    std::vector<parameters::Assignment> first;
    for (const Range& range : ranges) {
        first.push_back({range.parameter, parameters::find_parameter(range.parameter)->get(parameters)});
    }
    check(first, path + ".");
    for (const auto& [generation, assignments] : schedule.changes()) {
        if (generation > 1) { // generation 1 has the values of `parameters`
            check(assignments, path + ".schedule.generation " + std::to_string(generation) + ".");
        }
    }
}

} // namespace evod::classes
