// Origins: how the organisms of an island came into a generation, and to which species they belong.
#pragma once

#include "server/replay/generation_reader.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace evod::replay {

struct Origins {
    bool initial = false;             // the organisms have no parents
    std::uint32_t bred_count = 0;     // organisms at the beginning; the others came during the generation
    std::uint32_t predator_count = 0; // the last of them
    evolution::Places prey{}, predators{};
    std::vector<evolution::Parents> parents; // of the organisms at the beginning, in the previous generation
    std::vector<simulation::Birth> births;   // with births: of the others; without births, all of them were placed

    std::size_t organism_count() const { return species_.size(); }
    simulation::Species species(std::size_t organism) const { return species_[organism]; }
    /// Returns the ids of the parents; nullopt if there are none. They lived in the previous generation, or in the same
    /// one, if the organism came later than its beginning.
    std::optional<evolution::Parents> parents_of(std::size_t organism) const;
    /// Whether an organism at the beginning is a copy of its parent, or itself.
    bool is_kept(std::size_t organism) const;
    /// "initial", "elite", "survivor", "child", "placed", or with births "migrant".
    const char* origin(std::size_t organism) const;

    // With births, from the second interval on, a migrant has no parents. Nor have predators in their first interval.
    bool has_migrants = false, predators_arrive = false;
    bool is_migrant(std::size_t organism) const;

    std::vector<simulation::Species> species_; // by id
};

/// The origins of the organisms of an island.
Origins origins_of(const WholeGeneration& whole, std::size_t island);

/// "prey" or "predator".
const char* species_name(simulation::Species species);

} // namespace evod::replay
