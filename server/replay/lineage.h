// Lineage: who came from whom, from island to island too.
//
// What is stored of an organism's parents are their places on its own island, in the generation before. Where migrants
// had come to that island, the organism in such a place was a copy of one that lived on another: that one is told. Who
// migrated follows from the fitness of the generation that had ended.
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
    std::vector<std::array<Place, 2>> parents; // in the generation before; empty where nobody knows
    bool initial = false;                      // nobody bred them
    std::uint32_t elite_count = 0, survivor_count = 0;
    std::vector<double> fitness; // empty while the generation has not ended
    // In the next generation: organisms bred from this one, and places in which it was kept itself. Empty if none has
    // begun, and where nobody knows.
    std::vector<std::uint32_t> child_count, kept_count;
};

/// families  one per island. Returns whether to go on.
using OfFamilies = base::FunctionRef<bool(std::uint64_t generation, const std::vector<Family>& families)>;

// Of a run that follows another model nobody knows what is not held, nor who migrated.

/// Every generation that has begun and is in reach, in order.
base::Result<void> each_generation(run_file::RunFile& file, base::Executor& executor, const std::stop_token& stop,
                                   OfFamilies told);
/// From this generation back to the file's first, or the last that is in reach. Refused where GenerationReader is.
base::Result<void> each_generation_back_from(run_file::RunFile& file, std::uint64_t generation,
                                             base::Executor& executor, const std::stop_token& stop, OfFamilies told);

} // namespace evod::replay
