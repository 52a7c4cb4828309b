// Lineage: the parents of organisms, including parents from other islands.
//
// The file stores each parent as a place on the island of the child, in the previous generation. If a migrant had taken
// over this place, it was a copy of an organism of another island, and lineage reports that organism. The migrants are
// recomputed from the fitness of the previous generation.
#pragma once

#include "server/base/executor.h"
#include "server/run_file/run_file.h"

#include <array>
#include <cstdint>
#include <stop_token>
#include <vector>

namespace evod::replay {

/// The island and the id of an organism in a given generation.
struct Place {
    std::uint32_t island = 0, organism = 0;
    friend bool operator==(const Place&, const Place&) = default;
};

/// One island's part of a generation. Every vector is indexed by organism.
struct Family {
    std::uint32_t organism_count = 0;
    std::vector<std::array<Place, 2>> parents; // in the previous generation; empty if unknown
    bool initial = false;                      // the organisms have no parents
    std::uint32_t elite_count = 0, survivor_count = 0;
    std::vector<double> fitness; // empty if the generation has not ended
    // For each organism: the number of its children in the next generation, and the number of places in which it
    // survived itself. Empty if the next generation has not begun or is unknown.
    std::vector<std::uint32_t> child_count, kept_count;
};

/// families  one per island. The function returns whether to continue.
using OfFamilies = base::FunctionRef<bool(std::uint64_t generation, const std::vector<Family>& families)>;

// For a run of another model, migrants and generations that are not retained are unknown.

/// Calls `report` in ascending order for every generation that has begun and can be read.
base::Result<void> each_generation(run_file::RunFile& file, base::Executor& executor, const std::stop_token& stop,
                                   OfFamilies report);
/// Calls `report` in descending order, from this generation to the first one of the file, or until a generation cannot
/// be read. Refused for the same reasons as in GenerationReader.
base::Result<void> each_generation_back_from(run_file::RunFile& file, std::uint64_t generation,
                                             base::Executor& executor, const std::stop_token& stop, OfFamilies report);

} // namespace evod::replay
