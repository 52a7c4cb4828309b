#include "server/replay/mismatch.h"

#include "proto/text/number_text.h"
#include "server/replay/columns.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

namespace evod::replay {
namespace {

using evolution::NextGeneration;
using simulation::IslandState;
using Found = std::optional<Mismatch>;

std::string text_of(double value) {
    return text::number_text(value + 0.0); // SQLite stores −0 as 0
}
/// Formats several numbers with spaces between them: "3 4.5 6".
template <class... Numbers>
std::string text_of_numbers(Numbers... numbers) {
    std::string text;
    ((text += (text.empty() ? "" : " ") + text::number_text(static_cast<double>(numbers) + 0.0)), ...);
    return text;
}
std::string text_of(std::uint64_t value) {
    return std::to_string(value);
}
std::string text_of(std::uint32_t value) {
    return std::to_string(value);
}
std::string text_of(bool value) {
    return value ? "true" : "false";
}
std::string text_of(simulation::CauseOfDeath cause) {
    return std::string{run_file::name_of(cause)};
}
std::string text_of(const IslandState::Organism& organism) {
    return text_of_numbers(organism.x, organism.y, organism.velocity_x, organism.velocity_y, organism.health);
}
std::string text_of(const IslandState::Crate& crate) {
    return text_of_numbers(crate.x, crate.y, crate.velocity_x, crate.velocity_y);
}
std::string text_of(const simulation::Items::Item& item) {
    return text_of_numbers(item.x, item.y, item.due_tick);
}
std::string text_of(const simulation::IslandCounts& counts) {
    return text_of_numbers(counts.food_eaten, counts.poison_eaten, counts.starved_count, counts.poisoned_count,
                           counts.too_fast_count, counts.speed_limit_count);
}
std::string text_of(const evolution::Parents& parents) {
    return std::to_string(parents.first) + " and " + std::to_string(parents.second);
}
std::string text_of(const simulation::Birth& birth) {
    return std::to_string(birth.tick) + ", " + text_of(birth.parents);
}
std::string text_of(const simulation::ColonyCounts& counts) {
    return text_of_numbers(counts.living_sum, counts.first, counts.lowest, counts.living, counts.born, counts.refused,
                           counts.without_room, counts.starved, counts.poisoned, counts.eaten, counts.old);
}
std::string text_of(const base::StateHash& hash) {
    return to_text(hash);
}

using GeneNames = std::span<const std::string>;

/// Returns the name of a gene; its index if the name is unknown.
std::string name_of(GeneNames names, std::size_t gene) {
    return gene < names.size() ? names[gene] : std::to_string(gene);
}
std::vector<std::string> names_of(std::size_t gene_count, GeneNames names) {
    std::vector<std::string> all;
    for (std::size_t gene = 0; gene < gene_count; ++gene) {
        all.push_back(gene < names.size() ? names[gene] : "gene " + std::to_string(gene));
    }
    return all;
}

template <class T>
Found compare_part(const std::string& part, const T& stored, const T& simulated) {
    if (stored == simulated) {
        return std::nullopt;
    }
    return Mismatch{part, text_of(stored), text_of(simulated)};
}

/// name       name of the value, to which the index of the element is appended: "the fitness of organism".
/// of_island  the island as text: " on island 3".
template <class T>
Found compare_each(const std::string& name, const std::string& of_island, std::span<const T> stored,
                   std::span<const T> simulated) {
    if (stored.size() != simulated.size()) {
        return compare_part(name + ": their number" + of_island, stored.size(), simulated.size());
    }
    const auto [one, other] = std::ranges::mismatch(stored, simulated);
    if (one == stored.end()) {
        return std::nullopt;
    }
    return compare_part(name + " " + std::to_string(one - stored.begin()) + of_island, *one, *other);
}
/// name  name of the value: "the fitness".
template <class T>
Found compare_organisms(const char* name, const std::string& of_island, std::span<const T> stored,
                        std::span<const T> simulated) {
    if (stored.size() != simulated.size()) {
        return compare_part(std::string{name} + ": the number of organisms" + of_island, stored.size(),
                            simulated.size());
    }
    return compare_each(std::string{name} + " of organism", of_island, stored, simulated);
}

Found compare_part(const std::string& which, const parameters::Parameters& stored,
                   const parameters::Parameters& simulated) {
    const auto differing = parameters::parameters_that_differ(stored, simulated);
    if (differing.empty()) {
        return std::nullopt;
    }
    const parameters::ParameterDescription& parameter = *differing.front();
    return Mismatch{"the parameter " + std::string{parameter.name} + ", " + which,
                    parameters::to_text(parameter.get(stored)), parameters::to_text(parameter.get(simulated))};
}

/// Whether two numbers of selection accounts agree. They are sums of double precision that no state depends on. Earlier
/// builds of evod rounded their last digits differently, depending on the compiler.
bool agree(std::optional<double> a, std::optional<double> b) {
    constexpr double tolerance = 1e-9;
    return a && b ? std::abs(*a - *b) <= tolerance * std::max({1.0, std::abs(*a), std::abs(*b)}) : !a && !b;
}

/// A missing stored account is unknown and counts as equal.
Found compare_account(const std::string& name, const std::string& of_island,
                      const std::optional<evolution::SelectionAccount>& stored,
                      const std::optional<evolution::SelectionAccount>& simulated, GeneNames gene_names) {
    if (!stored) {
        return std::nullopt;
    }
    const std::vector<std::string> names = names_of(stored->size(), gene_names);
    if (simulated && simulated->size() != stored->size()) {
        return compare_part(name + "the number of genes" + of_island, std::uint64_t{stored->size()},
                            std::uint64_t{simulated->size()});
    }
    std::vector<std::optional<double>> again;
    evolution::for_each_number(simulated, names,
                               [&](const std::string&, std::optional<double> value) { again.push_back(value); });
    const auto written = [](std::optional<double> value) { return value ? text_of(*value) : "none"; };
    Found mismatch;
    std::size_t place = 0;
    evolution::for_each_number(stored, names, [&](const std::string& number, std::optional<double> value) {
        if (!mismatch && !agree(value, again[place])) {
            mismatch = Mismatch{name + number + of_island, written(value), written(again[place])};
        }
        ++place;
    });
    return mismatch;
}

Found compare_island(const std::string& of_island, const NextGeneration& stored, const NextGeneration& simulated,
                     GeneNames gene_names) {
    const auto genes_of = [](const NextGeneration& born) {
        return std::span<const float>{born.genes.data(), static_cast<std::size_t>(born.genes.size())};
    };
    if (auto mismatch = compare_part("the number of genes" + of_island, static_cast<std::uint64_t>(stored.genes.rows()),
                                     static_cast<std::uint64_t>(simulated.genes.rows()))) {
        return mismatch;
    }
    const auto stored_genes = genes_of(stored), simulated_genes = genes_of(simulated);
    if (stored_genes.size() != simulated_genes.size()) {
        return compare_part("the number of organisms" + of_island, static_cast<std::uint64_t>(stored.genes.cols()),
                            static_cast<std::uint64_t>(simulated.genes.cols()));
    }
    if (const auto [one, other] = std::ranges::mismatch(stored_genes, simulated_genes); one != stored_genes.end()) {
        const auto place = static_cast<std::size_t>(one - stored_genes.begin());
        const auto gene_count = static_cast<std::size_t>(stored.genes.rows());
        return compare_part("the chromosomes: gene " + name_of(gene_names, place % gene_count) + " of organism " +
                                std::to_string(place / gene_count) + of_island,
                            double{*one}, double{*other});
    }
    if (auto mismatch =
            compare_organisms<evolution::Parents>("the parents", of_island, stored.parents, simulated.parents)) {
        return mismatch;
    }
    if (auto mismatch =
            compare_part("the number of elite organisms" + of_island, stored.elite_count, simulated.elite_count)) {
        return mismatch;
    }
    if (auto mismatch =
            compare_part("the number of survivors" + of_island, stored.survivor_count, simulated.survivor_count)) {
        return mismatch;
    }
    if (auto mismatch = compare_part("the number of genes clamped to their bounds" + of_island, stored.clamped_count,
                                     simulated.clamped_count)) {
        return mismatch;
    }
    if (auto mismatch =
            compare_part("the number of predators" + of_island, stored.predator_count, simulated.predator_count)) {
        return mismatch;
    }
    if (auto mismatch =
            compare_account("the selection account: ", of_island, stored.account, simulated.account, gene_names)) {
        return mismatch;
    }
    return compare_account("the selection account of predators: ", of_island, stored.predator_account,
                           simulated.predator_account, gene_names);
}

Found compare_island(const std::string& of_island, const std::vector<std::uint32_t>& stored,
                     const std::vector<std::uint32_t>& simulated) {
    return compare_organisms<std::uint32_t>("the founder", of_island, stored, simulated);
}

Found compare_island(const std::string& of_island, const simulation::Rating& stored,
                     const simulation::Rating& simulated) {
    if (auto mismatch =
            compare_organisms<double>("the fitness from clients", of_island, stored.fitness, simulated.fitness)) {
        return mismatch;
    }
    return compare_organisms<float>("the repaired gene", of_island, stored.genes, simulated.genes);
}

Found compare_island(const std::string& of_island, const run_file::IslandOutcome& stored,
                     const run_file::IslandOutcome& simulated) {
    if (auto mismatch = compare_organisms<double>("the fitness", of_island, stored.fitness, simulated.fitness)) {
        return mismatch;
    }
    if (auto mismatch =
            compare_organisms<double>("the objective", of_island, stored.objectives, simulated.objectives)) {
        return mismatch;
    }
    if (auto mismatch = compare_organisms<float>("the repaired gene", of_island, stored.repaired, simulated.repaired)) {
        return mismatch;
    }
    if (auto mismatch =
            compare_organisms<std::uint32_t>("the ticks lived", of_island, stored.lived_ticks, simulated.lived_ticks)) {
        return mismatch;
    }
    if (auto mismatch = compare_organisms<simulation::CauseOfDeath>("the cause of death", of_island, stored.cause,
                                                                    simulated.cause)) {
        return mismatch;
    }
    return compare_each<simulation::Birth>("the tick and the parents of birth", of_island, stored.births,
                                           simulated.births);
}

Found compare_colony(const std::string& of_island, const simulation::ColonyStatistics& stored,
                     const simulation::ColonyStatistics& simulated) {
    std::vector<std::string> again;
    simulation::for_each_colony_number(simulated,
                                       [&](const std::string&, const auto& value) { again.push_back(text_of(value)); });
    Found mismatch;
    auto simulated_text = again.begin();
    simulation::for_each_colony_number(stored, [&](const std::string& name, const auto& value) {
        const std::string text = text_of(value);
        if (!mismatch && text != *simulated_text) {
            mismatch = Mismatch{"the statistics of the colony: " + name + of_island, text, *simulated_text};
        }
        ++simulated_text;
    });
    return mismatch;
}

Found compare_island(const std::string& of_island, const simulation::GenerationStatistics& stored,
                     const simulation::GenerationStatistics& simulated, GeneNames gene_names) {
    if (auto mismatch = compare_part("the statistics: the number of genes" + of_island, stored.genes.size(),
                                     simulated.genes.size())) {
        return mismatch;
    }
    const std::vector<std::string> names = names_of(stored.genes.size(), gene_names);
    const auto for_each_number = [&](const auto& statistics, const auto& visit) {
        simulation::for_each_number(statistics, visit);
        simulation::for_each_gene_number(statistics, names, visit);
    };
    std::vector<std::string> again;
    for_each_number(simulated, [&](const std::string&, const auto& value) { again.push_back(text_of(value)); });
    Found mismatch;
    auto simulated_text = again.begin();
    for_each_number(stored, [&](const std::string& name, const auto& value) {
        const std::string text = text_of(value); // the text contains all digits
        if (!mismatch && text != *simulated_text) {
            mismatch = Mismatch{"the statistics: " + name + of_island, text, *simulated_text};
        }
        ++simulated_text;
    });
    if (!mismatch) {
        mismatch = compare_account("the statistics: ", of_island, stored.account, simulated.account, gene_names);
    }
    if (!mismatch) {
        mismatch = compare_part("whether there are statistics of a colony" + of_island, stored.colony.has_value(),
                                simulated.colony.has_value());
    }
    if (!mismatch && stored.colony) {
        mismatch = compare_colony(of_island, *stored.colony, *simulated.colony);
    }
    if (!mismatch) {
        mismatch = compare_part("whether there are statistics of predators" + of_island, !stored.predators.empty(),
                                !simulated.predators.empty());
    }
    if (!mismatch && !stored.predators.empty()) {
        mismatch = compare_island(of_island + ", of predators", stored.predators.front(), simulated.predators.front(),
                                  gene_names);
    }
    return mismatch;
}

Found compare_island(const std::string& of_island, const IslandState& stored, const IslandState& simulated) {
    using simulation::Items;
    const simulation::LifeRecords &records = stored.life_records, &new_records = simulated.life_records;
    if (auto mismatch = compare_organisms<simulation::CauseOfDeath>("the cause of death", of_island, records.cause,
                                                                    new_records.cause)) {
        return mismatch;
    }
    if (auto mismatch = compare_organisms<std::uint32_t>("the ticks lived", of_island, records.lived_ticks,
                                                         new_records.lived_ticks)) {
        return mismatch;
    }
    if (auto mismatch =
            compare_organisms<std::uint32_t>("the food eaten", of_island, records.food_eaten, new_records.food_eaten)) {
        return mismatch;
    }
    if (auto mismatch = compare_organisms<std::uint32_t>("the poison eaten", of_island, records.poison_eaten,
                                                         new_records.poison_eaten)) {
        return mismatch;
    }
    if (auto mismatch = compare_organisms<IslandState::Organism>("the position, velocity and health", of_island,
                                                                 stored.organisms, simulated.organisms)) {
        return mismatch;
    }
    if (auto mismatch = compare_organisms<float>("the heading", of_island, stored.headings, simulated.headings)) {
        return mismatch;
    }
    if (auto mismatch = compare_each<IslandState::Crate>("the position and velocity of crate", of_island, stored.crates,
                                                         simulated.crates)) {
        return mismatch;
    }
    if (auto mismatch = compare_each<Items::Item>("the position of food", of_island, stored.food, simulated.food)) {
        return mismatch;
    }
    if (auto mismatch =
            compare_each<Items::Item>("the position of poison", of_island, stored.poison, simulated.poison)) {
        return mismatch;
    }
    if (stored.placed != simulated.placed || stored.placed_food != simulated.placed_food ||
        stored.placed_poison != simulated.placed_poison) {
        const auto text = [](const IslandState& island) {
            return std::to_string(island.placed.size()) + " organisms, " + std::to_string(island.placed_food) +
                   " food, " + std::to_string(island.placed_poison) + " poison";
        };
        return Mismatch{"the placed entities" + of_island, text(stored), text(simulated)};
    }
    if (auto mismatch = compare_part("the counts" + of_island, stored.counts, simulated.counts)) {
        return mismatch;
    }
    for (std::size_t species = 0; species < stored.colony.size(); ++species) {
        if (auto mismatch =
                compare_part("the counts of " + std::string{species == 0 ? "prey" : "predators"} + of_island,
                             stored.colony[species], simulated.colony[species])) {
            return mismatch;
        }
        if (auto mismatch = compare_each<float>("the latest births: gene", of_island, stored.latest_born[species],
                                                simulated.latest_born[species])) {
            return mismatch;
        }
    }
    if (auto mismatch =
            compare_organisms<std::uint32_t>("the children", of_island, records.children, new_records.children)) {
        return mismatch;
    }
    return compare_organisms<std::uint32_t>("the handling of a meal", of_island, stored.hunts_from,
                                            simulated.hunts_from);
}

Found compare_island(const std::string& of_island, const simulation::IslandOpening& stored,
                     const simulation::IslandOpening& simulated) {
    if (auto mismatch =
            compare_part("the number of predators" + of_island, stored.predator_count, simulated.predator_count)) {
        return mismatch;
    }
    if (auto mismatch = compare_part("the next number" + of_island, stored.next_number, simulated.next_number)) {
        return mismatch;
    }
    if (auto mismatch = compare_organisms<std::uint32_t>("the number", of_island, stored.numbers, simulated.numbers)) {
        return mismatch;
    }
    if (auto mismatch = compare_organisms<std::uint32_t>("the age", of_island, stored.age_ticks, simulated.age_ticks)) {
        return mismatch;
    }
    return compare_island(of_island, stored.state, simulated.state);
}

/// gene_names  for compare_island(), if it needs them.
template <class T, class... Names>
Found compare_islands(const std::vector<T>& stored, const std::vector<T>& simulated, Names... gene_names) {
    if (auto mismatch = compare_part("the number of islands", stored.size(), simulated.size())) {
        return mismatch;
    }
    for (std::size_t island = 0; island < stored.size(); ++island) {
        if (auto mismatch = compare_island(" on island " + std::to_string(island), stored[island], simulated[island],
                                           gene_names...)) {
            return mismatch;
        }
    }
    return std::nullopt;
}

} // namespace

Found compare(const simulation::Opening& stored, const simulation::Opening& simulated) {
    if (auto mismatch = compare_part("the first tick", stored.moment.tick, simulated.moment.tick)) {
        return mismatch;
    }
    if (auto mismatch =
            compare_part("the simulated seconds", stored.moment.simulated_s, simulated.moment.simulated_s)) {
        return mismatch;
    }
    if (auto mismatch = compare_part("in effect", stored.parameters.active, simulated.parameters.active)) {
        return mismatch;
    }
    if (auto mismatch = compare_requested(stored.parameters.requested, simulated.parameters.requested)) {
        return mismatch;
    }
    // After a reset, a run continues the revision numbers of the previous run.
    if (stored.moment.generation > 1) {
        if (auto mismatch = compare_part("the revision of the parameters", stored.parameters.revision,
                                         simulated.parameters.revision)) {
            return mismatch;
        }
    }
    const evolution::Progress &progress = stored.progress, &new_progress = simulated.progress;
    if (auto mismatch =
            compare_part("the progress: completed generations", progress.generations, new_progress.generations)) {
        return mismatch;
    }
    if (auto mismatch =
            compare_part("the progress: generations without improvement", progress.stagnant, new_progress.stagnant)) {
        return mismatch;
    }
    if (auto mismatch =
            compare_part("the progress: the best fitness so far", progress.best_fitness, new_progress.best_fitness)) {
        return mismatch;
    }
    if (auto mismatch = compare_part("the progress: the best fitness of the previous generation",
                                     progress.last_best_fitness, new_progress.last_best_fitness)) {
        return mismatch;
    }
    return compare_part("the progress: whether the previous generation died out", progress.last_died_out,
                        new_progress.last_died_out);
}

Found compare(const std::vector<NextGeneration>& stored, const std::vector<NextGeneration>& simulated,
              GeneNames gene_names) {
    return compare_islands(stored, simulated, gene_names);
}

Found compare(const std::vector<simulation::IslandOpening>& stored,
              const std::vector<simulation::IslandOpening>& simulated) {
    return compare_islands(stored, simulated);
}

Found compare(const simulation::Founders& stored, const simulation::Founders& simulated) {
    return compare_islands(stored, simulated);
}

Found compare(const std::vector<run_file::IslandOutcome>& stored,
              const std::vector<run_file::IslandOutcome>& simulated) {
    return compare_islands(stored, simulated);
}

Found compare(const std::vector<simulation::GenerationStatistics>& stored,
              const std::vector<simulation::GenerationStatistics>& simulated, GeneNames gene_names) {
    return compare_islands(stored, simulated, gene_names);
}

Found compare(const simulation::WorldState& stored, const simulation::WorldState& simulated) {
    if (auto mismatch = compare_part("the generation", stored.moment.generation, simulated.moment.generation)) {
        return mismatch;
    }
    if (auto mismatch = compare_part("the tick of the generation", stored.moment.generation_tick,
                                     simulated.moment.generation_tick)) {
        return mismatch;
    }
    if (auto mismatch =
            compare_part("the simulated seconds", stored.moment.simulated_s, simulated.moment.simulated_s)) {
        return mismatch;
    }
    if (auto mismatch = compare_part("in effect", stored.parameters.active, simulated.parameters.active)) {
        return mismatch;
    }
    if (auto mismatch = compare_requested(stored.parameters.requested, simulated.parameters.requested)) {
        return mismatch;
    }
    if (auto mismatch =
            compare_part("the revision of the parameters", stored.parameters.revision, simulated.parameters.revision)) {
        return mismatch;
    }
    if (auto mismatch = compare_islands(stored.islands, simulated.islands)) {
        return mismatch;
    }
    const std::vector<std::string> gene_names = gene_names_of(stored.parameters.active);
    if (auto mismatch = compare_islands(stored.ended, simulated.ended, GeneNames{gene_names})) {
        return mismatch;
    }
    return compare_islands(stored.ratings, simulated.ratings);
}

Found compare(const base::StateHash& stored, const base::StateHash& simulated) {
    return compare_part("the state hash", stored, simulated);
}

Found compare_requested(const parameters::RequestedParameters& stored,
                        const parameters::RequestedParameters& simulated) {
    return compare_part("requested", stored.values, simulated.values);
}

} // namespace evod::replay
