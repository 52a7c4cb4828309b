#include "tests/extremes/extreme_parameters.h"

#include "server/base/overloaded.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace evod::extremes {
namespace {

using parameters::Assignment;
using parameters::ParameterDescription;
using parameters::Parameters;
using parameters::ParameterValue;

struct CountLimit {
    std::string_view name;
    std::uint32_t max;
};
/// The counts on which the duration of a tick or of breeding depends.
constexpr CountLimit limits[] = {{"population_size", 40},
                                 {"island_count", 3},
                                 {"food_count", 300},
                                 {"poison_count", 300},
                                 {"obstacle_count", 40},
                                 {"crate_count", 20},
                                 {"free_genes", 40},
                                 {"tournament_size", 500},
                                 {"predator_count", 20},
                                 {"population_max", 200},
                                 {"predator_population_max", 200},
                                 {"predator_from", 3}};

std::uint32_t count_max_of(const ParameterDescription& description, std::uint32_t max) {
    const auto found = std::ranges::find(limits, description.name, &CountLimit::name);
    return found == std::end(limits) ? max : std::min(max, found->max);
}

double extreme_real(const base::RealRange& range, Draws& draws) {
    const double width = range.max - range.min;
    switch (draws.below(8)) {
    case 0:
    case 1:
        return range.min;
    case 2:
    case 3:
        return range.max;
    case 4:
        return std::nextafter(range.min, range.max);
    case 5:
        return std::nextafter(range.max, range.min);
    case 6:
        return range.min + width * std::pow(10, draws.number(-18, 0));
    default:
        return draws.number(range.min, range.max);
    }
}

std::uint32_t extreme_count(std::uint32_t min, std::uint32_t max, Draws& draws) {
    switch (draws.below(4)) {
    case 0:
        return min;
    case 1:
        return max;
    case 2:
        return min + static_cast<std::uint32_t>(draws.below(std::min<std::uint64_t>(max - min, 3) + 1));
    default:
        return draws.count(min, max);
    }
}

ParameterValue extreme_value(const ParameterDescription& description, Draws& draws) {
    return std::visit(
        base::Overloaded{
            [&](const parameters::RealParameter& p) -> ParameterValue { return extreme_real(p.range, draws); },
            [&](const parameters::CountParameter& p) -> ParameterValue {
                return extreme_count(p.range.min, count_max_of(description, p.range.max), draws);
            },
            [&](const parameters::FlagParameter&) -> ParameterValue { return draws.chance(0.5); },
            [&](const parameters::ChoiceParameter& p) -> ParameterValue { return std::string{draws.one_of(p.names)}; }},
        description.kind);
}

bool is_permitted(const Parameters& set, const ParameterDescription& description, const ParameterValue& value) {
    const Assignment assignment{std::string{description.name}, value};
    return static_cast<bool>(parameters::assign(set, {&assignment, 1}));
}

/// Returns the permitted value that is nearest to `wanted`; `wanted` itself if it is not a real number.
ParameterValue nearest_permitted(const Parameters& set, const ParameterDescription& description,
                                 const ParameterValue& wanted) {
    if (!std::holds_alternative<double>(wanted) || is_permitted(set, description, wanted)) {
        return wanted;
    }
    double permitted = std::get<double>(description.get(set)), refused = std::get<double>(wanted);
    for (int halving = 0; halving < 60; ++halving) {
        const double middle = permitted + (refused - permitted) / 2;
        (is_permitted(set, description, middle) ? permitted : refused) = middle;
    }
    return permitted;
}

/// Assigns a value if it is permitted.
void try_to_assign(Parameters& set, std::string_view name, const ParameterValue& value) {
    const Assignment assignment{std::string{name}, value};
    if (auto assigned = parameters::assign(set, {&assignment, 1})) {
        set = *std::move(assigned);
    }
}

} // namespace

Assignment extreme_assignment(const Parameters& set, Draws& draws) {
    const ParameterDescription& description = draws.one_of(parameters::parameter_registry());
    return {std::string{description.name}, nearest_permitted(set, description, extreme_value(description, draws))};
}

Parameters extreme_parameters(Draws& draws) {
    Parameters set;
    set.population_size = 7;
    set.generation_s = 0.2;
    std::vector<const ParameterDescription*> order;
    for (const ParameterDescription& description : parameters::parameter_registry()) {
        order.push_back(&description);
    }
    for (std::size_t left = order.size(); left > 1; --left) {
        std::swap(order[left - 1], order[draws.below(left)]);
    }
    const double share = draws.one_of(std::vector{0.05, 0.3, 0.9});
    for (const ParameterDescription* description : order) {
        const bool ends_the_run = description->name.starts_with("stop_at_") || description->name.ends_with("_limit");
        if (description->name != "generation_s" && draws.chance(ends_the_run ? share * 0.1 : share)) {
            try_to_assign(set, description->name,
                          nearest_permitted(set, *description, extreme_value(*description, draws)));
        }
    }
    // A generation that ends after few ticks.
    try_to_assign(set, "generation_s", std::max(set.tick_s * draws.number(1, 12), 0.001));
    return set;
}

} // namespace evod::extremes
