#include "server/replay/origins.h"

#include "server/simulation/island.h"

namespace evod::replay {

using simulation::Species;

std::optional<evolution::Parents> Origins::parents_of(std::size_t organism) const {
    evolution::Parents found = simulation::Island::no_parents;
    if (organism < bred_count) {
        found = initial ? found : parents[organism];
    } else if (organism - bred_count < births.size()) {
        found = births[organism - bred_count].parents;
    }
    return found == simulation::Island::no_parents ? std::nullopt : std::optional{found};
}

bool Origins::is_kept(std::size_t organism) const {
    const std::size_t prey_count = bred_count - predator_count;
    return organism < prey_count ? organism < prey.survivors
                                 : organism < bred_count && organism - prey_count < predators.survivors;
}

bool Origins::is_migrant(std::size_t organism) const {
    const bool arrives = predators_arrive && species(organism) == Species::Predator;
    return has_migrants && !arrives && organism < bred_count && !parents_of(organism);
}

const char* Origins::origin(std::size_t organism) const {
    const bool has_parents = parents_of(organism).has_value();
    if (organism >= bred_count) {
        return has_parents ? "child" : "placed";
    }
    if (!has_parents) {
        return is_migrant(organism) ? "migrant" : "initial";
    }
    const std::size_t prey_count = bred_count - predator_count;
    const bool is_elite = organism < prey_count ? organism < prey.elite : organism - prey_count < predators.elite;
    return is_elite ? "elite" : is_kept(organism) ? "survivor" : "child";
}

Origins origins_of(const WholeGeneration& whole, std::size_t island) {
    const parameters::Parameters& parameters = whole.begun.opening.parameters.active;
    const evolution::NextGeneration& born = whole.begun.born[island];
    const auto organisms = static_cast<std::uint32_t>(born.genes.cols());
    Origins origins{.initial = born.parents.empty(),
                    .bred_count = organisms - static_cast<std::uint32_t>(whole.placed[island].size()),
                    .predator_count = born.predator_count,
                    .prey = {born.elite_count, born.survivor_count, 0},
                    .parents = born.parents,
                    .births = whole.births.empty() ? std::vector<simulation::Birth>{} : whole.births[island],
                    .species_ = std::vector<Species>(organisms)};
    if (parameters::has_births(parameters)) {
        origins.prey.survivors = origins.predators.survivors = origins.bred_count;
    } else if (born.predator_count > 0) {
        origins.predators =
            evolution::share_places(born.predator_count, born.predator_count, parameters::of_predators(parameters));
    }
    const std::uint64_t generation = whole.begun.opening.moment.generation;
    origins.has_migrants = parameters::has_births(parameters) && generation > 1;
    origins.predators_arrive = generation == parameters.predator_from;
    for (std::uint32_t organism = 0; organism < organisms; ++organism) {
        const auto parents = origins.parents_of(organism);
        const bool is_predator = organism < origins.bred_count
                                     ? organism >= origins.bred_count - origins.predator_count
                                     : parents && origins.species_[parents->first] == Species::Predator;
        origins.species_[organism] = is_predator ? Species::Predator : Species::Prey;
    }
    return origins;
}

const char* species_name(Species species) {
    return species == Species::Predator ? "predator" : "prey";
}

} // namespace evod::replay
