#include "server/simulation/packed.h"

#include <optional>
#include <string>
#include <type_traits>
#include <variant>

namespace evod::simulation {
namespace {

void pack(base::Packer& packer, const std::optional<evolution::SelectionAccount>& account) {
    packer.add(account.has_value());
    if (account) {
        packer.add_list(*account);
    }
}

std::optional<evolution::SelectionAccount> unpack_account(base::Unpacker& unpacker) {
    return unpacker.next<bool>() ? std::optional{unpacker.next_list<evolution::GeneAccount>()} : std::nullopt;
}

void pack(base::Packer& packer, const std::vector<parameters::Assignment>& assignments) {
    packer.add(std::uint64_t{assignments.size()});
    for (const parameters::Assignment& assignment : assignments) {
        packer.add_list(assignment.name);
        packer.add(std::uint64_t{assignment.value.index()});
        std::visit(
            [&](const auto& value) {
                if constexpr (std::is_same_v<decltype(value), const std::string&>) {
                    packer.add_list(value);
                } else {
                    packer.add(value);
                }
            },
            assignment.value);
    }
}

/// Reads the value with this index in ParameterValue.
template <std::size_t first = 0>
parameters::ParameterValue unpack_value(base::Unpacker& unpacker, std::size_t index) {
    if constexpr (first < std::variant_size_v<parameters::ParameterValue>) {
        using Value = std::variant_alternative_t<first, parameters::ParameterValue>;
        if (index != first) {
            return unpack_value<first + 1>(unpacker, index);
        }
        if constexpr (std::is_same_v<Value, std::string>) {
            return unpacker.next_text();
        } else {
            return unpacker.next<Value>();
        }
    } else {
        EVOD_ASSERT(!"a value of a parameter has a known kind");
    }
}

std::vector<parameters::Assignment> unpack_assignments(base::Unpacker& unpacker) {
    std::vector<parameters::Assignment> assignments(unpacker.next<std::uint64_t>());
    for (parameters::Assignment& assignment : assignments) {
        assignment.name = unpacker.next_text();
        assignment.value = unpack_value(unpacker, unpacker.next<std::uint64_t>());
    }
    return assignments;
}

} // namespace

void pack(base::Packer& packer, const GenerationStatistics& statistics) {
    for_each_number(statistics, [&](const char*, const auto& number) { packer.add(number); });
    packer.add_list(statistics.genes);
    pack(packer, statistics.account);
}

GenerationStatistics unpack_statistics(base::Unpacker& unpacker) {
    GenerationStatistics statistics;
    for_each_number(statistics, [&](const char*, auto& number) {
        number = unpacker.next<std::remove_reference_t<decltype(number)>>();
    });
    statistics.genes = unpacker.next_list<GeneStatistics>();
    statistics.account = unpack_account(unpacker);
    return statistics;
}

void pack(base::Packer& packer, const evolution::NextGeneration& generation) {
    packer.add(std::uint64_t(generation.genes.rows()));
    packer.add(std::uint64_t(generation.genes.cols()));
    packer.add_values(std::span{generation.genes.data(), static_cast<std::size_t>(generation.genes.size())});
    packer.add_list(generation.parents);
    packer.add(generation.elite_count);
    packer.add(generation.survivor_count);
    packer.add(generation.clamped_count);
    pack(packer, generation.account);
}

evolution::NextGeneration unpack_generation(base::Unpacker& unpacker) {
    evolution::NextGeneration generation;
    const auto rows = unpacker.next<std::uint64_t>(), columns = unpacker.next<std::uint64_t>();
    generation.genes.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
    unpacker.next_values(std::span{generation.genes.data(), static_cast<std::size_t>(generation.genes.size())});
    generation.parents = unpacker.next_list<evolution::Parents>();
    generation.elite_count = unpacker.next<std::uint32_t>();
    generation.survivor_count = unpacker.next<std::uint32_t>();
    generation.clamped_count = unpacker.next<std::uint64_t>();
    generation.account = unpack_account(unpacker);
    return generation;
}

void pack(base::Packer& packer, const IslandState& state) {
    packer.add_list(state.fate.lived_ticks);
    packer.add_list(state.fate.cause);
    packer.add_list(state.fate.food_eaten);
    packer.add_list(state.fate.poison_eaten);
    packer.add(state.counts);
    packer.add(std::uint64_t{state.placed.size()});
    for (const IslandState::Placed& placed : state.placed) {
        packer.add_list(placed.genes);
        packer.add(placed.tick);
    }
    packer.add(state.placed_food);
    packer.add(state.placed_poison);
    packer.add_list(state.organisms);
    packer.add_list(state.headings);
    packer.add_list(state.crates);
    packer.add_list(state.food);
    packer.add_list(state.poison);
}

IslandState unpack_island_state(base::Unpacker& unpacker) {
    IslandState state;
    unpacker.next_list(state.fate.lived_ticks);
    unpacker.next_list(state.fate.cause);
    unpacker.next_list(state.fate.food_eaten);
    unpacker.next_list(state.fate.poison_eaten);
    state.counts = unpacker.next<IslandCounts>();
    state.placed.resize(unpacker.next<std::uint64_t>());
    for (IslandState::Placed& placed : state.placed) {
        unpacker.next_list(placed.genes);
        placed.tick = unpacker.next<std::uint32_t>();
    }
    state.placed_food = unpacker.next<std::uint32_t>();
    state.placed_poison = unpacker.next<std::uint32_t>();
    unpacker.next_list(state.organisms);
    unpacker.next_list(state.headings);
    unpacker.next_list(state.crates);
    unpacker.next_list(state.food);
    unpacker.next_list(state.poison);
    return state;
}

void pack(base::Packer& packer, const parameters::Schedule& schedule) {
    packer.add(std::uint64_t{schedule.changes().size()});
    for (const auto& [generation, assignments] : schedule.changes()) {
        packer.add(generation);
        pack(packer, assignments);
    }
}

parameters::Schedule unpack_schedule(base::Unpacker& unpacker) {
    parameters::Schedule schedule;
    for (auto generations = unpacker.next<std::uint64_t>(); generations > 0; --generations) {
        const auto generation = unpacker.next<std::uint64_t>();
        for (const parameters::Assignment& assignment : unpack_assignments(unpacker)) {
            schedule.add(generation, assignment);
        }
    }
    return schedule;
}

void pack(base::Packer& packer, const parameters::PlannedChange& change) {
    packer.add(change.id);
    packer.add(change.at);
    pack(packer, change.assignments);
    packer.add_list(change.by);
}

parameters::PlannedChange unpack_planned_change(base::Unpacker& unpacker) {
    parameters::PlannedChange change;
    change.id = unpacker.next<std::uint64_t>();
    change.at = unpacker.next<parameters::PlannedMoment>();
    change.assignments = unpack_assignments(unpacker);
    change.by = unpacker.next_text();
    return change;
}

void pack(base::Packer& packer, const PlaceEntities& command) {
    packer.add(command.island);
    packer.add_list(command.items);
    packer.add(std::uint64_t{command.organisms.size()});
    for (const PlaceEntities::Organism& organism : command.organisms) {
        packer.add(organism.x_px);
        packer.add(organism.y_px);
        packer.add_list(organism.genes);
    }
}

PlaceEntities unpack_place_entities(base::Unpacker& unpacker) {
    PlaceEntities command;
    command.island = unpacker.next<std::uint32_t>();
    unpacker.next_list(command.items);
    command.organisms.resize(unpacker.next<std::uint64_t>());
    for (PlaceEntities::Organism& organism : command.organisms) {
        organism.x_px = unpacker.next<double>();
        organism.y_px = unpacker.next<double>();
        unpacker.next_list(organism.genes);
    }
    return command;
}

void pack(base::Packer& packer, const RemoveEntities& command) {
    packer.add(command.island);
    packer.add(command.generation);
    packer.add_list(command.food);
    packer.add_list(command.poison);
    packer.add_list(command.organisms);
}

RemoveEntities unpack_remove_entities(base::Unpacker& unpacker) {
    RemoveEntities command;
    command.island = unpacker.next<std::uint32_t>();
    command.generation = unpacker.next<std::optional<std::uint64_t>>();
    unpacker.next_list(command.food);
    unpacker.next_list(command.poison);
    unpacker.next_list(command.organisms);
    return command;
}

void pack(base::Packer& packer, const SetFitness& command) {
    packer.add(command.generation);
    packer.add(command.island);
    packer.add(command.first_organism);
    packer.add_list(command.fitness);
}

SetFitness unpack_set_fitness(base::Unpacker& unpacker) {
    SetFitness command{};
    command.generation = unpacker.next<std::uint64_t>();
    command.island = unpacker.next<std::uint32_t>();
    command.first_organism = unpacker.next<std::uint32_t>();
    unpacker.next_list(command.fitness);
    return command;
}

} // namespace evod::simulation
