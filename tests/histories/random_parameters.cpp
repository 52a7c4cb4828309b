#include "tests/histories/random_parameters.h"

#include "server/base/overloaded.h"

#include <algorithm>
#include <string>
#include <string_view>

namespace evod::histories {
namespace {

using parameters::ParameterDescription;
using parameters::ParameterValue;

struct Range {
    std::string_view name;
    double min, max;
};
/// Narrower ranges, with which a tick takes microseconds and a generation has at most a few hundred ticks.
constexpr Range narrow[] = {
    {"generation_s", 0.02, 3},
    {"tick_s", 0.008, 0.05},
    {"population_size", 1, 60},
    {"replaced_count", 1, 80},
    {"elite_count", 0, 80},
    {"tournament_size", 1, 80},
    {"tournament_winners", 1, 20},
    {"island_count", 1, 5},
    {"island_width_px", 150, 3000},
    {"island_height_px", 150, 3000},
    {"food_count", 0, 60},
    {"poison_count", 0, 60},
    {"reference_population", 10, 100},
    {"spawn_margin_px", 0, 70},
    {"obstacle_count", 0, 4},
    {"obstacle_size_px", 5, 100},
    {"crate_count", 0, 4},
    {"crate_size_px", 5, 60},
    {"respawn_s", 0, 2},
    {"health_loss_per_s", 0, 150},
    {"max_speed_px_s", 1, 5000},
    {"radius_per_unit_px", 0.01, 0.3},
    {"free_genes", 0, 8},
    {"brain_hidden", 1, 8},
    {"migration_epoch", 1, 4},
    {"migrant_count", 1, 80},
    {"birth_health", 5, 150},
    {"birth_cost", 0, 30},
    {"birth_every_s", 0.01, 0.5},
    {"lifespan_s", 0, 4},
    {"population_max", 1, 120},
    {"predator_count", 0, 20},
    {"predator_from", 1, 4},
    {"predator_elite_count", 0, 20},
    {"predator_birth_health", 5, 150},
    {"predator_population_max", 1, 60},
    {"predator_lifespan_s", 0, 4},
    {"handling_s", 0, 1},
};

Range range_of(const ParameterDescription& description, double min, double max) {
    const auto found = std::ranges::find(narrow, description.name, &Range::name);
    return found == std::end(narrow) ? Range{description.name, min, max} : *found;
}

double random_real(const Range& range, double usual, Draws& draws) {
    switch (draws.below(8)) {
    case 0:
        return range.min;
    case 1:
        return range.max;
    case 2:
        return draws.number(range.min, std::clamp(4 * usual + 1, range.min, range.max));
    default:
        return std::clamp(usual * draws.number(0.4, 2), range.min, range.max);
    }
}

std::uint32_t random_count(const ParameterDescription& description, const base::CountRange& all, Draws& draws) {
    if (description.name == "generation_limit" || description.name == "stagnation_limit") {
        return draws.chance(0.6) ? 0 : draws.count(3, 40); // otherwise most runs end
    }
    if (description.name == "population_size" && draws.chance(0.6)) {
        constexpr std::uint32_t sizes[] = {1, 2, 3, 7, 50};
        return draws.one_of(sizes);
    }
    const Range range = range_of(description, all.min, all.max);
    const auto min = static_cast<std::uint32_t>(range.min), max = static_cast<std::uint32_t>(range.max);
    return draws.chance(0.3) ? std::min(max, min + draws.count(0, 2)) : draws.count(min, max);
}

/// Values that fit together only when all of them are in effect; some of them are at once, others at a generation.
std::vector<parameters::Assignment> random_group(Draws& draws) {
    if (draws.chance(0.5)) {
        return {{"population_size", draws.count(1, 3)},
                {"body_size_max", draws.number(500, 1000)},
                {"body_size_min", draws.number(100, 500)}};
    }
    const std::uint32_t size = draws.count(2, 50);
    return {{"population_size", size + draws.count(0, 10)},
            {"tournament_size", size},
            {"tournament_winners", 1U},
            {"tournament_replacement", false},
            {"selection", std::string{"tournament"}}};
}

} // namespace

ParameterValue random_value(const ParameterDescription& description, Draws& draws) {
    return std::visit(base::Overloaded{[&](const parameters::RealParameter& real) -> ParameterValue {
                                           return random_real(range_of(description, real.range.min, real.range.max),
                                                              std::get<double>(description.default_value()), draws);
                                       },
                                       [&](const parameters::CountParameter& count) -> ParameterValue {
                                           return random_count(description, count.range, draws);
                                       },
                                       [&](const parameters::FlagParameter&) -> ParameterValue {
                                           return draws.chance(description.name.starts_with("stop_at_") ? 0.2 : 0.5);
                                       },
                                       [&](const parameters::ChoiceParameter& choice) -> ParameterValue {
                                           return std::string{draws.one_of(choice.names)};
                                       }},
                      description.kind);
}

std::vector<parameters::Assignment> random_assignments(const ParameterDescription& first, bool with_resets,
                                                       Draws& draws) {
    if (draws.chance(0.08)) {
        return random_group(draws);
    }
    const auto registry = parameters::parameter_registry();
    std::vector<parameters::Assignment> assignments{{std::string{first.name}, random_value(first, draws)}};
    for (std::uint32_t more = draws.chance(0.5) ? 0 : draws.count(1, 3); more > 0; --more) {
        const ParameterDescription& other = draws.one_of(registry);
        const bool is_new =
            std::ranges::find(assignments, other.name, &parameters::Assignment::name) == assignments.end();
        if (is_new && (with_resets || other.effect != base::Effect::Reset)) {
            assignments.push_back({std::string{other.name}, random_value(other, draws)});
        }
    }
    return assignments;
}

const ParameterDescription& ParameterTurns::next() {
    const auto registry = parameters::parameter_registry();
    return registry[next_++ % registry.size()];
}

} // namespace evod::histories
