// Lineage: the parents of organisms, across islands too.
//
// The file stores an organism's parents as places on its own island, in the generation before. If a migrant had taken
// such a place, it was a copy of an organism of another island, and lineage reports that organism. The migrants follow
// from the fitness of the generation that had ended.
#pragma once

#include "server/base/executor.h"
#include "server/run_file/run_file.h"

#include <array>
#include <cstdint>
#include <stop_token>
#include <vector>

namespace evod::replay {

/// Where an organism of a generation lived.
struct Place {
    std::uint32_t island = 0, organism = 0;
    friend bool operator==(const Place&, const Place&) = default;
};

/// One island's part of a generation; vectors by organism.
struct Family {
    std::uint32_t organism_count = 0;
    std::vector<std::array<Place, 2>> parents; // in the generation before; empty if not known
    bool initial = false;                      // the organisms have no parents
    std::uint32_t elite_count = 0, survivor_count = 0;
    std::vector<double> fitness; // empty while the generation has not ended
    // In the next generation: the number of children, and of places in which the organism itself survived. Empty if the
    // next generation has not begun or is not known.
    std::vector<std::uint32_t> child_count, kept_count;
};

/// families  one per island. Returns whether to continue.
using OfFamilies = base::FunctionRef<bool(std::uint64_t generation, const std::vector<Family>& families)>;

// If a run follows another model, its generations that are not retained and its migrants are not known.

/// Calls `report` for every generation that has begun and can be read, in order.
base::Result<void> each_generation(run_file::RunFile& file, base::Executor& executor, const std::stop_token& stop,
                                   OfFamilies report);
/// The same from this generation back to the file's first one, or the last that can be read. Refused where
/// GenerationReader is.
base::Result<void> each_generation_back_from(run_file::RunFile& file, std::uint64_t generation,
                                             base::Executor& executor, const std::stop_token& stop, OfFamilies report);

} // namespace evod::replay
