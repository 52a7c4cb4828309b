#include "server/simulation/opening_check.h"

#include "server/physics/bodies.h"

#include <algorithm>
#include <cmath>

namespace evod::simulation {
namespace {

/// No tick of an interval is later; longer times are impossible, too.
constexpr std::uint32_t tick_reachable = 1U << 30;

/// Whether each organism has a number of its own, below the next one.
bool are_numbers(const IslandOpening& opening) {
    std::vector<std::uint32_t> sorted = opening.numbers;
    std::ranges::sort(sorted);
    return std::ranges::adjacent_find(sorted) == sorted.end() &&
           (sorted.empty() || sorted.back() < opening.next_number);
}

bool are_records(const LifeRecords& records, std::size_t organisms) {
    const auto all_zero = [&](const auto& column) {
        return column.size() == organisms && std::ranges::all_of(column, [](auto value) { return value == 0; });
    };
    return records.cause.size() == organisms &&
           std::ranges::all_of(records.cause, [](CauseOfDeath cause) { return cause == CauseOfDeath::Alive; }) &&
           all_zero(records.lived_ticks) && all_zero(records.food_eaten) && all_zero(records.poison_eaten) &&
           records.children.size() == organisms;
}

} // namespace

const char* fault_of(const IslandOpening& opening, const evolution::NextGeneration& bred,
                     const parameters::Parameters& parameters) {
    const IslandState& state = opening.state;
    const auto organisms = static_cast<std::size_t>(bred.genes.cols());
    const parameters::IslandPlan plan = parameters::island_plan(parameters);
    const physics::Coordinate width = physics::to_units(plan.width_px), height = physics::to_units(plan.height_px);
    if (opening.numbers.size() != organisms || opening.age_ticks.size() != organisms ||
        opening.predator_count > organisms || opening.predator_count != bred.predator_count ||
        (opening.predator_count > 0 && parameters.predator_count == 0) || !are_numbers(opening)) {
        return "number of an organism";
    }
    for (std::uint32_t id = 0; id < organisms; ++id) {
        if (!can_live_with(evolution::column(bred.genes, id))) {
            return "gene of an organism";
        }
    }
    if (!are_records(state.life_records, organisms) || state.counts != IslandCounts{} ||
        state.colony != std::array<ColonyCounts, 2>{} || !state.placed.empty() || state.placed_food > 0 ||
        state.placed_poison > 0) {
        return "life of an organism";
    }
    const auto moves = [&](const auto& body) {
        return can_move(body, width, height, static_cast<float>(parameters.max_speed_px_s));
    };
    const auto lives = [&](const IslandState::Organism& organism) {
        return moves(organism) && organism.health > 0 && organism.health <= health_reachable;
    };
    if (state.organisms.size() != organisms || !std::ranges::all_of(state.organisms, lives)) {
        return "position, speed or health of an organism";
    }
    const bool has_headings = parameters.controller == evolution::Controller::Network;
    const auto is_heading = [](float heading) { return std::abs(heading) <= heading_max; };
    if (state.headings.size() != (has_headings ? organisms : 0) || !std::ranges::all_of(state.headings, is_heading)) {
        return "heading of an organism";
    }
    const std::span hunts_from{state.hunts_from};
    if (hunts_from.size() != organisms ||
        std::ranges::any_of(hunts_from, [](std::uint32_t tick) { return tick > tick_reachable; }) ||
        std::ranges::any_of(hunts_from.first(organisms - opening.predator_count),
                            [](std::uint32_t tick) { return tick > 0; })) {
        return "handling of a meal";
    }
    if (state.crates.size() != parameters.crate_count || !std::ranges::all_of(state.crates, moves)) {
        return "crate";
    }
    const auto is_item = [&](const Items::Item& item) {
        return item.x > 0 && item.x < width && item.y > 0 && item.y < height && item.due_tick <= tick_reachable;
    };
    if (state.food.size() != plan.food_count || state.poison.size() != plan.poison_count ||
        !std::ranges::all_of(state.food, is_item) || !std::ranges::all_of(state.poison, is_item)) {
        return "item";
    }
    const auto genes = static_cast<std::size_t>(bred.genes.rows());
    const auto are_born = [&](const std::vector<float>& latest) { return are_chromosomes(latest, genes); };
    return std::ranges::all_of(state.latest_born, are_born) ? nullptr : "latest birth";
}

} // namespace evod::simulation
