#include "server/simulation/rating.h"

#include "server/base/assert.h"
#include "server/base/inline_executor.h"
#include "server/evolution/free_gene_operators.h"
#include "server/evolution/gene_layout.h"
#include "server/simulation/first_population.h"

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

/// Checks the repaired chromosomes of a command whose fitness has been checked.
base::Result<void> check_genes(const SetFitness& command, const parameters::Parameters& parameters) {
    const std::size_t count = evolution::gene_count(parameters);
    const std::size_t wanted = command.fitness.size() / parameters.objectives * count;
    if (!command.genes.empty() && command.genes.size() != wanted) {
        return refusal_of(RefusalCode::InvalidArgument, "the repaired chromosomes are incomplete",
                          base::Reason::FieldInvalid,
                          {"set_fitness.genes",
                           std::to_string(wanted) + " numbers, " + std::to_string(count) + " for each rated organism",
                           std::to_string(command.genes.size())});
    }
    const evolution::GeneLayout layout = evolution::gene_layout(parameters);
    const evolution::FreeGeneOperators listed{parameters};
    std::vector<base::Violation> faults;
    for (std::size_t first = 0; first < command.genes.size() && faults.size() < faults_max; first += count) {
        add_gene_faults(std::span{command.genes}.subspan(first, count), layout, listed,
                        "set_fitness.organism[" + std::to_string(command.first_organism + first / count) + "]", faults);
    }
    if (faults.empty()) {
        return {};
    }
    return Refusal{.code = RefusalCode::InvalidArgument,
                   .message = "a repaired chromosome is not allowed",
                   .violations = std::move(faults),
                   .reason = base::Reason::FieldInvalid};
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
    const parameters::Parameters& parameters = world.parameters().active;
    const std::size_t objectives = parameters.objectives;
    const std::size_t given = world.ratings()[command.island].fitness.size() / objectives;
    if (command.first_organism != 0 && command.first_organism != given) {
        return refusal_of(RefusalCode::InvalidArgument, "the numbers of an island are given in order of organisms",
                          base::Reason::FieldInvalid,
                          {"set_fitness.first_organism", given == 0 ? "0" : "0 or " + std::to_string(given),
                           std::to_string(command.first_organism)});
    }
    const std::size_t most = world.organism_count(command.island) - command.first_organism;
    if (command.fitness.size() > most * objectives) {
        return refusal_of(
            RefusalCode::InvalidArgument, "there are more numbers than organisms", base::Reason::FieldInvalid,
            {"set_fitness.fitness",
             std::to_string(most * objectives) + " numbers, " + (objectives == 1 ? "one" : std::to_string(objectives)) +
                 " for each organism from organism " + std::to_string(command.first_organism),
             std::to_string(command.fitness.size())});
    }
    if (command.fitness.size() % objectives != 0) {
        return refusal_of(
            RefusalCode::InvalidArgument, "the last organism has too few numbers", base::Reason::FieldInvalid,
            {"set_fitness.fitness", std::to_string(objectives) + " numbers for each organism (objectives)",
             std::to_string(command.fitness.size()) + " numbers"});
    }
    return check_genes(command, parameters);
}

bool World::is_rated(std::uint32_t island) const {
    return !ratings_.empty() &&
           ratings_[island].fitness.size() == std::size_t{organism_count(island)} * parameters().active.objectives;
}

void World::set_fitness(const SetFitness& command) {
    Rating& rating = ratings_[command.island];
    const std::size_t objectives = parameters().active.objectives;
    if (command.first_organism == 0) {
        rating = {};
    }
    EVOD_ASSERT(rating.fitness.size() == command.first_organism * objectives);
    rating.fitness.insert(rating.fitness.end(), command.fitness.begin(), command.fitness.end());
    if (!command.genes.empty() || !rating.genes.empty()) {
        // Those that were not repaired are as they were born.
        const evolution::GeneMatrix& born = islands_->island(command.island).born().genes;
        const auto genes = static_cast<std::size_t>(born.rows());
        const std::size_t known = rating.genes.size(), rated = rating.fitness.size() / objectives * genes;
        rating.genes.insert(rating.genes.end(), born.data() + known, born.data() + rated);
        std::ranges::copy(command.genes, rating.genes.begin() + std::ssize(rating.genes) - std::ssize(command.genes));
    }
    update_hash();
    for (std::uint32_t island = 0; island < island_count(); ++island) {
        if (!is_rated(island)) {
            return;
        }
    }
    base::InlineExecutor executor; // a command is applied between two ticks, where no executor is available
    finish_generation(executor);
}

base::StateHash hash_of(std::span<const Rating> ratings) {
    constexpr std::uint32_t fitness_kind = 102, genes_kind = 103;
    base::StateHash hash;
    for (std::size_t island = 0; island < ratings.size(); ++island) {
        const auto add = [&](std::uint32_t kind, std::size_t index, std::uint64_t bits) {
            hash += base::EntityHash{kind, index}.add(std::uint64_t{island}).add(bits).finish();
        };
        for (std::size_t i = 0; i < ratings[island].fitness.size(); ++i) {
            add(fitness_kind, i, std::bit_cast<std::uint64_t>(ratings[island].fitness[i]));
        }
        for (std::size_t i = 0; i < ratings[island].genes.size(); ++i) {
            add(genes_kind, i, std::bit_cast<std::uint32_t>(ratings[island].genes[i]));
        }
    }
    return hash;
}

bool can_be_given(const WorldState& state, bool awaited) {
    if (state.ratings.size() != (awaited ? state.islands.size() : 0)) {
        return false;
    }
    const parameters::Parameters& parameters = state.parameters.active;
    const evolution::GeneLayout layout = evolution::gene_layout(parameters);
    const evolution::FreeGeneOperators listed{parameters};
    const std::size_t genes = layout.names.size(), objectives = parameters.objectives;
    for (std::size_t i = 0; i < state.ratings.size(); ++i) {
        const Rating& rating = state.ratings[i];
        const std::size_t rated = rating.fitness.size() / objectives;
        const auto is_possible = [](double number) { return std::abs(number) <= given_fitness_max; }; // false for NaN
        if (rating.fitness.size() != rated * objectives || rated > state.islands[i].life_records.cause.size() ||
            !std::ranges::all_of(rating.fitness, is_possible) ||
            (!rating.genes.empty() && rating.genes.size() != rated * genes)) {
            return false;
        }
        std::vector<base::Violation> faults;
        for (std::size_t first = 0; first < rating.genes.size() && faults.empty(); first += genes) {
            add_gene_faults(std::span{rating.genes}.subspan(first, genes), layout, listed, "", faults);
        }
        if (!faults.empty()) {
            return false;
        }
    }
    return true;
}

bool is_whole(const WorldState& state) {
    for (std::size_t i = 0; i < state.ratings.size(); ++i) {
        if (state.ratings[i].fitness.size() !=
            state.islands[i].life_records.cause.size() * state.parameters.active.objectives) {
            return false;
        }
    }
    return true;
}

} // namespace evod::simulation
