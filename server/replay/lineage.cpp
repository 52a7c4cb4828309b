#include "server/replay/lineage.h"

#include "server/base/inline_executor.h"
#include "server/evolution/fitness_shuffle.h"
#include "server/evolution/migration.h"
#include "server/replay/generation_reader.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <utility>

namespace evod::replay {
namespace {

using base::Refusal;
using base::Result;
using simulation::Species;

/// The data of a generation that lineage needs.
struct Births {
    std::uint64_t generation = 0;
    parameters::Parameters parameters; // the parameters with which the generation was bred
    struct Island {
        Origins origins;
        std::vector<double> fitness, deciding_fitness; // as in simulation::IslandOutcome
    };
    std::vector<Island> islands;
};

Births births_of(const WholeGeneration& whole) {
    const simulation::Opening& opening = whole.begun.opening;
    Births births{opening.moment.generation, opening.parameters.active, {}};
    for (std::size_t i = 0; i < whole.begun.born.size(); ++i) {
        births.islands.push_back(
            {.origins = origins_of(whole, i),
             .fitness = whole.ended ? whole.ended->outcomes[i].fitness : std::vector<double>{},
             .deciding_fitness = whole.ended ? whole.ended->outcomes[i].deciding_fitness() : std::vector<double>{}});
    }
    return births;
}

using ParentPlaces = std::vector<std::vector<std::array<Place, 2>>>; // indexed by island, then organism

/// Puts the migrants of a species into the places of the organisms that they replace.
///
/// parameters  with which the next generation is bred.
/// fitness     that decides, per island, by id.
void migrate(Species species, const Births& parents, const parameters::Parameters& parameters,
             const std::vector<std::vector<double>>& fitness, base::Seed seed,
             std::vector<std::vector<Place>>& places) {
    std::vector<std::vector<std::uint32_t>> ids(fitness.size());
    std::vector<std::vector<double>> of_species(fitness.size());
    for (std::size_t island = 0; island < fitness.size(); ++island) {
        const Origins& origins = parents.islands[island].origins;
        for (std::uint32_t id = 0; id < origins.organism_count(); ++id) {
            if (origins.species(id) == species) {
                ids[island].push_back(id);
                of_species[island].push_back(fitness[island][id]);
            }
        }
    }
    const bool is_predator = species == Species::Predator;
    const std::vector<std::span<const double>> spans(of_species.begin(), of_species.end());
    for (const evolution::Migrant& migrant :
         choose_migrants(spans, is_predator ? parameters::of_predators(parameters) : parameters, seed,
                         simulation::migration_key(parents.generation, species))) {
        places[migrant.to][ids[migrant.to][migrant.replaces]] = {migrant.from, ids[migrant.from][migrant.organism]};
    }
}

/// Returns, for every place of the generation `parents`, the organism that lived there when `children` was bred;
/// nullopt if unknown.
std::optional<std::vector<std::vector<Place>>> breeders(const run_file::RunFile& file, const Births& parents,
                                                        const Births& children) {
    std::vector<std::vector<Place>> places(parents.islands.size());
    std::vector<std::vector<double>> fitness;
    for (std::uint32_t island = 0; island < parents.islands.size(); ++island) {
        for (std::uint32_t organism = 0; organism < parents.islands[island].origins.organism_count(); ++organism) {
            places[island].push_back({island, organism});
        }
        fitness.push_back(parents.islands[island].deciding_fitness);
    }
    // With births, migrants have no parents.
    if (parents.islands.size() > 1 && !parameters::has_births(children.parameters) &&
        evolution::migration_due(parents.generation, children.parameters)) {
        if (file.other_model()) {
            return std::nullopt;
        }
        const base::Seed seed = file.identity().seed;
        base::InlineExecutor executor;
        evolution::apply_shuffle(
            children.parameters, fitness.size(), [&](std::size_t i) -> std::span<double> { return fitness[i]; }, seed,
            parents.generation, executor);
        for (const Species species : {Species::Prey, Species::Predator}) {
            migrate(species, parents, children.parameters, fitness, seed, places);
        }
    }
    return places;
}

/// Returns whether migrants can be chosen from these organisms: each has a finite fitness.
bool are_rated(const Births& births) {
    return std::ranges::all_of(births.islands, [](const Births::Island& island) {
        return island.origins.organism_count() >= 1 && island.fitness.size() == island.origins.organism_count() &&
               std::ranges::all_of(island.fitness, [](double fitness) { return std::isfinite(fitness); });
    });
}

/// The parents of all organisms in `children`; empty if unknown.
Result<ParentPlaces> parents_of(const run_file::RunFile& file, const Births& children, const Births& parents) {
    const bool has_births = parameters::has_births(children.parameters);
    if (!has_births && !are_rated(parents)) {
        return Refusal{.code = base::RefusalCode::DataLoss,
                       .message = file.path() + " is damaged: generation " + std::to_string(children.generation) +
                                  " was bred from organisms without a finite fitness",
                       .violations = {}};
    }
    const auto places = breeders(file, parents, children);
    if (!places) {
        return ParentPlaces{};
    }
    ParentPlaces found(children.islands.size());
    for (std::size_t island = 0; island < children.islands.size(); ++island) {
        for (const evolution::Parents& pair : children.islands[island].origins.parents) {
            if (pair == simulation::Island::no_parents) { // it has arrived
                found[island].push_back({nowhere, nowhere});
                continue;
            }
            if (island >= places->size() || std::max(pair.first, pair.second) >= (*places)[island].size()) {
                return Refusal{.code = base::RefusalCode::DataLoss,
                               .message = file.path() + " is damaged: generation " +
                                          std::to_string(children.generation) + " has parents that did not exist",
                               .violations = {}};
            }
            found[island].push_back({(*places)[island][pair.first], (*places)[island][pair.second]});
        }
    }
    return found;
}

/// next  the following generation with its parents; nullptr if there is none or it cannot be read.
std::vector<Family> families_of(const Births& births, ParentPlaces parents, const Births* next,
                                const ParentPlaces& next_parents) {
    std::vector<Family> families;
    for (std::size_t i = 0; i < births.islands.size(); ++i) {
        const Births::Island& island = births.islands[i];
        const std::size_t counted = next_parents.empty() ? 0 : island.origins.organism_count();
        Family& family = families.emplace_back(
            Family{.origins = island.origins,
                   .parents = parents.empty() ? std::vector<std::array<Place, 2>>{} : std::move(parents[i]),
                   .fitness = island.fitness,
                   .child_count = std::vector<std::uint32_t>(counted),
                   .kept_count = std::vector<std::uint32_t>(counted)});
        for (const simulation::Birth& birth : island.origins.births) {
            if (counted > 0 && !(birth.parents == simulation::Island::no_parents)) {
                ++family.child_count[birth.parents.first];
                family.child_count[birth.parents.second] += birth.parents.first != birth.parents.second;
            }
        }
    }
    for (std::size_t i = 0; i < next_parents.size(); ++i) {
        for (std::size_t organism = 0; organism < next_parents[i].size(); ++organism) {
            const auto& [first, second] = next_parents[i][organism];
            if (first == nowhere) {
                continue;
            }
            const bool kept = next->islands[i].origins.is_kept(organism);
            ++(kept ? families[first.island].kept_count : families[first.island].child_count)[first.organism];
            if (!(second == first)) {
                ++families[second.island].child_count[second.organism];
            }
        }
    }
    return families;
}

/// Reads backwards, from one retained generation to the previous retained one.
class BackwardReader {
  public:
    BackwardReader(run_file::RunFile& file, base::Executor& executor, const base::StopCheck& stop)
        : file_{file}, reader_{file, executor, stop} {}

    Result<Births> read(std::uint64_t generation) {
        auto found = read_.extract(generation);
        if (found.empty()) {
            for (std::uint64_t next = file_.retention().at_or_before(generation); next <= generation; ++next) {
                auto whole = reader_.read(next);
                if (!whole) {
                    return whole.error();
                }
                read_.insert_or_assign(next, births_of(*std::move(whole)));
            }
            found = read_.extract(generation);
        }
        return std::move(found.mapped());
    }

  private:
    run_file::RunFile& file_;
    GenerationReader reader_;
    std::map<std::uint64_t, Births> read_; // generations that are not retained, and the retained generation before them
};

} // namespace

Result<void> each_generation(run_file::RunFile& file, base::Executor& executor, const base::StopCheck& stop,
                             ReportFamilies report, std::uint64_t first) {
    GenerationReader reader{file, executor, stop};
    const std::uint64_t last = file.generations().last();
    std::optional<Births> births;
    ParentPlaces parents;
    const auto read = [&](std::uint64_t generation, std::optional<Births>& to) -> Result<void> {
        if (stop()) {
            return cancelled_refusal();
        }
        if (!can_be_read(file, generation)) {
            return expect_generation(file, generation);
        }
        auto whole = reader.read(generation);
        if (!whole) {
            return whole.error();
        }
        to = births_of(*std::move(whole));
        return {};
    };
    // The parents of the first reported generation are in the generation before it.
    std::uint64_t generation = std::max(file.identity().first_generation, first - std::min<std::uint64_t>(first, 1));
    if (generation <= last) {
        if (auto done = read(generation, births); !done) {
            return done;
        }
    }
    for (; generation <= last; ++generation) {
        std::optional<Births> next;
        ParentPlaces next_parents;
        if (generation < last) {
            if (auto done = read(generation + 1, next); !done) {
                return done;
            }
        }
        if (births && next) {
            auto found = parents_of(file, *next, *births);
            if (!found) {
                return found.error();
            }
            next_parents = *std::move(found);
        }
        if (births && generation >= first &&
            !report(generation, families_of(*births, std::move(parents), next ? &*next : nullptr, next_parents))) {
            break;
        }
        births = std::move(next);
        parents = std::move(next_parents);
    }
    return {};
}

Result<void> each_generation_back_from(run_file::RunFile& file, std::uint64_t generation, base::Executor& executor,
                                       const base::StopCheck& stop, ReportFamilies report) {
    BackwardReader reader{file, executor, stop};
    std::optional<Births> next;
    ParentPlaces next_parents;
    if (generation < file.generations().last() && can_be_read(file, generation + 1)) {
        auto read = reader.read(generation + 1);
        if (!read) {
            return read.error();
        }
        next = *std::move(read);
    }
    auto births = reader.read(generation);
    if (!births) {
        return births.error();
    }
    if (next) {
        auto found = parents_of(file, *next, *births);
        if (!found) {
            return found.error();
        }
        next_parents = *std::move(found);
    }
    while (true) {
        std::optional<Births> before;
        ParentPlaces parents;
        if (generation > file.identity().first_generation && can_be_read(file, generation - 1)) {
            auto read = reader.read(generation - 1);
            if (!read) {
                return read.error();
            }
            before = *std::move(read);
            auto found = parents_of(file, *births, *before);
            if (!found) {
                return found.error();
            }
            parents = *std::move(found);
        }
        if (!report(generation, families_of(*births, parents, next ? &*next : nullptr, next_parents)) || !before) {
            return {};
        }
        next = *std::move(births);
        births = *std::move(before);
        next_parents = std::move(parents);
        --generation;
    }
}

} // namespace evod::replay
