#include "server/simulation/rating.h"

#include "server/base/assert.h"
#include "server/base/inline_executor.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace evod::simulation {
namespace {

using base::Refusal;
using base::RefusalCode;

Refusal refusal_of(RefusalCode code, std::string message, base::Reason reason, base::Violation violation) {
    return {.code = code, .message = std::move(message), .violations = {std::move(violation)}, .reason = reason};
}

Refusal not_awaited(std::string why, std::vector<base::Argument> arguments = {}) {
    return refusal(RefusalCode::FailedPrecondition, std::move(why), base::Reason::FitnessNotAwaited,
                   std::move(arguments));
}

} // namespace

base::Result<void> check(const World& world, const SetFitness& command) {
    if (world.parameters().active.fitness != parameters::FitnessFunction::External) {
        return not_awaited("the world computes its fitness itself: set fitness to external and reset the world");
    }
    const std::uint64_t generation = world.moment().generation;
    if (command.generation != generation) {
        Refusal refused =
            refusal_of(RefusalCode::Aborted, "the numbers belong to a generation that is not the current one",
                       base::Reason::GenerationChanged,
                       {"set_fitness.generation", std::to_string(generation), std::to_string(command.generation)});
        refused.arguments = {{"expected_generation", std::to_string(command.generation)},
                             {"generation", std::to_string(generation)}};
        return refused;
    }
    if (!world.awaits_fitness()) {
        return not_awaited("generation " + std::to_string(generation) +
                               (world.generation_over() ? " has been rated already" : " has not ended yet"),
                           {{"generation", std::to_string(generation)}});
    }
    if (command.island >= world.island_count()) {
        return refusal_of(
            RefusalCode::NotFound, "no such island", base::Reason::IslandNotFound,
            {"set_fitness.island", "0 to " + std::to_string(world.island_count() - 1), std::to_string(command.island)});
    }
    if (world.is_rated(command.island)) {
        return not_awaited("island " + std::to_string(command.island) + " has been rated already in generation " +
                               std::to_string(generation),
                           {{"generation", std::to_string(generation)}, {"island", std::to_string(command.island)}});
    }
    const std::size_t given = world.given_fitness()[command.island].size();
    if (command.first_organism != 0 && command.first_organism != given) {
        return refusal_of(RefusalCode::InvalidArgument, "the numbers of an island are given in order of organisms",
                          base::Reason::FieldInvalid,
                          {"set_fitness.first_organism", given == 0 ? "0" : "0 or " + std::to_string(given),
                           std::to_string(command.first_organism)});
    }
    const std::size_t most = world.organism_count(command.island) - command.first_organism;
    if (command.fitness.size() > most) {
        return refusal_of(RefusalCode::InvalidArgument, "there are more numbers than organisms",
                          base::Reason::FieldInvalid,
                          {"set_fitness.fitness",
                           std::to_string(most) + " numbers, one for each organism from organism " +
                               std::to_string(command.first_organism),
                           std::to_string(command.fitness.size())});
    }
    return {};
}

bool World::is_rated(std::uint32_t island) const {
    return !given_fitness_.empty() && given_fitness_[island].size() == organism_count(island);
}

void World::set_fitness(const SetFitness& command) {
    std::vector<double>& fitness = given_fitness_[command.island];
    if (command.first_organism == 0) {
        fitness.clear();
    }
    EVOD_ASSERT(fitness.size() == command.first_organism);
    fitness.insert(fitness.end(), command.fitness.begin(), command.fitness.end());
    update_hash();
    for (std::uint32_t island = 0; island < island_count(); ++island) {
        if (!is_rated(island)) {
            return;
        }
    }
    base::InlineExecutor executor; // a command is applied between two ticks, where no executor is available
    finish_generation(executor);
}

base::StateHash hash_of_given(std::span<const std::vector<double>> fitness) {
    constexpr std::uint32_t fitness_kind = 102;
    base::StateHash hash;
    for (std::size_t island = 0; island < fitness.size(); ++island) {
        for (std::size_t id = 0; id < fitness[island].size(); ++id) {
            hash += base::EntityHash{fitness_kind, id}
                        .add(std::uint64_t{island})
                        .add(std::bit_cast<std::uint64_t>(fitness[island][id]))
                        .finish();
        }
    }
    return hash;
}

bool can_be_given(const WorldState& state, bool awaited) {
    if (state.given_fitness.size() != (awaited ? state.islands.size() : 0)) {
        return false;
    }
    for (std::size_t i = 0; i < state.given_fitness.size(); ++i) {
        const std::vector<double>& given = state.given_fitness[i];
        const auto is_possible = [](double number) { return std::abs(number) <= given_fitness_max; }; // false for NaN
        if (given.size() > state.islands[i].life_records.cause.size() || !std::ranges::all_of(given, is_possible)) {
            return false;
        }
    }
    return true;
}

bool is_whole(const WorldState& state) {
    for (std::size_t i = 0; i < state.given_fitness.size(); ++i) {
        if (state.given_fitness[i].size() != state.islands[i].life_records.cause.size()) {
            return false;
        }
    }
    return true;
}

} // namespace evod::simulation
