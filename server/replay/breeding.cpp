#include "server/replay/breeding.h"

#include "server/evolution/fitness_shuffle.h"
#include "server/evolution/migration.h"
#include "server/replay/generation_reader.h"

#include <algorithm>
#include <string>
#include <utility>

namespace evod::replay {
namespace {

using base::Refusal;
using base::RefusalCode;
using base::Result;

Refusal not_found_refusal(const char* field, std::uint64_t first, std::uint64_t last, std::uint64_t got) {
    const std::string there_are = std::to_string(first) + (first == last ? "" : " to " + std::to_string(last));
    return {.code = RefusalCode::NotFound,
            .message = std::string{"no such "} + field + " has bred in this run: allowed: " + there_are,
            .violations = {{field, there_are, std::to_string(got)}},
            .reason = base::Reason::MomentNotFound};
}

/// Refuses a generation that bred in the run of which this one is a fork. A violation names the ids of both runs, so
/// that a client can find the world that has the origin.
Refusal bred_in_origin(const run_file::RunIdentity& identity, std::uint64_t generation, RefusalCode code,
                       base::Reason reason) {
    const std::string origin = to_text(*identity.forked_from);
    return {.code = code,
            .message = "generation " + std::to_string(generation) +
                       " bred before this run began, in the run of which it is a fork: " + origin,
            .violations = {{"world", origin, to_text(identity.run_id)}},
            .reason = reason};
}

/// Returns the number of the parents' generation.
Result<std::uint64_t> generation_of(run_file::RunFile& file, const WantedBreeding& wanted) {
    const run_file::RunIdentity& identity = file.identity();
    const std::uint64_t first = identity.first_generation, last = file.generations().last();
    const std::uint64_t of_origin = wanted.generation.value_or(first - 1); // if none has bred here
    const bool has_bred = last > first;
    if (identity.forked_from && of_origin > 0 && of_origin < first && (wanted.generation || !has_bred)) {
        return has_bred
                   ? bred_in_origin(identity, of_origin, RefusalCode::NotFound, base::Reason::MomentNotFound)
                   : bred_in_origin(identity, of_origin, RefusalCode::FailedPrecondition, base::Reason::NotBredYet);
    }
    if (!has_bred) {
        return Refusal{.code = RefusalCode::FailedPrecondition,
                       .message = "no generation of this run has bred yet: the run is in its first generation",
                       .violations = {},
                       .reason = base::Reason::NotBredYet};
    }
    const std::uint64_t generation = wanted.generation.value_or(std::clamp(wanted.seen_from, first + 1, last) - 1);
    if (generation < first || generation >= last) {
        return not_found_refusal("generation", first, last - 1, generation);
    }
    return generation;
}

/// Removes the predators of all islands: the record is about the prey. Placed prey come after the predators, and then
/// have the ids that follow those of the other prey.
void remove_predators(WholeGeneration& parents) {
    for (std::size_t island = 0; island < parents.begun.born.size(); ++island) {
        evolution::NextGeneration& born = parents.begun.born[island];
        run_file::IslandOutcome& outcome = parents.ended->outcomes[island];
        const auto placed = std::ssize(parents.placed[island]);
        const Eigen::Index first = born.genes.cols() - placed - born.predator_count;
        const evolution::GeneMatrix last = born.genes.rightCols(placed);
        born.genes.conservativeResize(Eigen::NoChange, first + placed);
        born.genes.rightCols(placed) = last;
        outcome.fitness.erase(outcome.fitness.begin() + first, outcome.fitness.begin() + first + born.predator_count);
    }
}

/// Repeats the migration before the breeding. Returns the migrants that arrived on the island.
std::vector<evolution::Migrant> migrate(WholeGeneration& parents, const parameters::Parameters& parameters,
                                        base::Seed seed, std::uint32_t island) {
    const std::uint64_t generation = parents.ended->generation;
    if (!evolution::migration_due(generation, parameters)) {
        return {};
    }
    std::vector<std::span<const double>> fitness;
    std::vector<evolution::IslandPopulation> populations;
    for (std::size_t i = 0; i < parents.begun.born.size(); ++i) {
        fitness.emplace_back(parents.ended->outcomes[i].fitness);
        populations.push_back({&parents.begun.born[i].genes, parents.ended->outcomes[i].fitness});
    }
    std::vector<evolution::Migrant> migrants = choose_migrants(fitness, parameters, seed, generation);
    evolution::migrate(migrants, populations);
    std::erase_if(migrants, [&](const evolution::Migrant& migrant) { return migrant.to != island; });
    return migrants;
}

bool are_stored(const std::vector<evolution::BreedingRecord::Descendant>& descendants,
                const evolution::NextGeneration& stored) {
    return std::ranges::all_of(descendants, [&](const auto& descendant) {
        return descendant.id < stored.parents.size() && descendant.parents == stored.parents[descendant.id] &&
               std::ranges::equal(descendant.genes, evolution::column(stored.genes, descendant.id));
    });
}

} // namespace

Result<Bred> breeding_of(run_file::RunFile& file, const WantedBreeding& wanted, base::Executor& executor,
                         const base::StopCheck& stop) {
    if (auto refused = file.other_model()) {
        return *refused;
    }
    if (parameters::has_births(file.identity().parameters)) {
        return refusal(RefusalCode::FailedPrecondition,
                       "a world with births breeds no generations: its organisms have children while they live");
    }
    const auto generation = generation_of(file, wanted);
    if (!generation) {
        return generation.error();
    }
    GenerationReader reader{file, executor, stop};
    auto parents = reader.read(*generation);
    if (!parents) {
        return parents.error();
    }
    const auto children = reader.read(*generation + 1);
    if (!children) {
        return children.error();
    }
    const auto damaged = [&](const char* what) {
        return Refusal{.code = RefusalCode::DataLoss,
                       .message = file.path() + " is damaged: generation " + std::to_string(*generation) + what,
                       .violations = {}};
    };
    const std::size_t islands = parents->begun.born.size();
    if (wanted.island >= islands) {
        return not_found_refusal("island", 0, islands - 1, wanted.island);
    }
    if (!parents->ended || children->begun.born.size() != islands) {
        return damaged(" has bred, but its outcome or the next generation is missing");
    }

    Bred bred{*generation, wanted.island, children->begun.opening.parameters.active, {}};
    const base::Seed seed = file.identity().seed;
    const bool differs = bred.parameters.shuffle_fitness || !parents->ended->outcomes[wanted.island].objectives.empty();
    std::vector<std::vector<double>> own; // per island, the fitness; what decides is in the outcomes then
    for (std::uint32_t island = 0; island < islands; ++island) {
        run_file::IslandOutcome& outcome = parents->ended->outcomes[island];
        evolution::GeneMatrix& genes = parents->begun.born[island].genes;
        own.push_back(std::exchange(outcome.fitness, outcome.deciding_fitness()));
        if (!outcome.repaired.empty()) {
            genes = Eigen::Map<const evolution::GeneMatrix>{outcome.repaired.data(), genes.rows(), genes.cols()};
        }
    }
    evolution::apply_shuffle(
        bred.parameters, islands,
        [&](std::size_t island) -> std::span<double> { return parents->ended->outcomes[island].fitness; }, seed,
        *generation, executor);
    if (bred.parameters.predator_count > 0) {
        if (!parents->placed[bred.island].empty()) {
            return refusal(RefusalCode::FailedPrecondition,
                           "in a world with predators, no record shows how a generation bred in which organisms were "
                           "placed");
        }
        remove_predators(*parents);
    }
    const auto migrants = migrate(*parents, bred.parameters, seed, bred.island);
    if (stop()) {
        return cancelled_refusal();
    }
    bred.record = evolution::record_breeding(
        parents->ended->outcomes[bred.island].fitness, parents->begun.born[bred.island].genes, bred.parameters,
        bred.parameters.population_size, {.seed = seed, .island = bred.island, .generation = *generation}, wanted.rows,
        executor);
    const std::uint32_t first_contender = std::min(wanted.rows.first_contender, bred.record.contender_count);
    for (std::size_t i = 0; differs && i < bred.record.contenders.size(); ++i) {
        bred.record.contenders[i].own_fitness = own[bred.island][first_contender + i];
    }
    for (const evolution::Migrant& migrant : migrants) {
        if (migrant.replaces - first_contender < bred.record.contenders.size()) {
            auto& contender = bred.record.contenders[migrant.replaces - first_contender];
            contender.migrant = migrant;
            if (differs) {
                contender.own_fitness = own[migrant.from][migrant.organism];
            }
        }
    }
    if (!are_stored(bred.record.descendants, children->begun.born[bred.island])) {
        return damaged(" bred descendants that differ from the stored ones");
    }
    return bred;
}

} // namespace evod::replay
