// Lineage: the parents of organisms, including parents from other islands.
//
// The file stores each parent as an organism id on the island of the child, in the previous generation. If a migrant
// had replaced the organism with this id, the parent was a copy of an organism of another island. Then lineage reports
// that other organism. The migrants are recomputed from the fitness of the previous generation.
#pragma once

#include "server/base/executor.h"
#include "server/base/stop_check.h"
#include "server/replay/origins.h"
#include "server/run_file/run_file.h"

#include <array>
#include <cstdint>
#include <vector>

namespace evod::replay {

/// The island and the id of an organism in a given generation.
struct Place {
    std::uint32_t island = 0, organism = 0;
    friend bool operator==(const Place&, const Place&) = default;
};

/// In the place of a parent that an organism does not have.
constexpr Place nowhere{~0U, ~0U};

/// One island's part of a generation. Every vector is indexed by organism.
struct Family {
    Origins origins;
    // Of the organisms at the beginning, in the previous generation; empty if unknown. With births, a survivor is its
    // own parent, and the parents of children are in their own generation: see origins.
    std::vector<std::array<Place, 2>> parents;
    std::vector<double> fitness; // empty if the generation has not ended
    // For each organism: the number of its children in the next generation, or with births in the same one; and the
    // number of survivors in the next generation that are copies of it, or itself. Empty if the next generation has not
    // begun or is unknown.
    std::vector<std::uint32_t> child_count, kept_count;
};

/// Receives the families of one generation, one per island. Returns whether to continue.
using ReportFamilies = base::FunctionRef<bool(std::uint64_t generation, const std::vector<Family>& families)>;

// For a run of another model, migrants and generations that are not retained are unknown.

/// Calls `report` in ascending order for every generation, from `first` on, that has begun and can be read.
base::Result<void> each_generation(run_file::RunFile& file, base::Executor& executor, const base::StopCheck& stop,
                                   ReportFamilies report, std::uint64_t first = 0);
/// Calls `report` in descending order, from this generation to the first one of the file, or until a generation cannot
/// be read. Refused for the same reasons as GenerationReader::read().
base::Result<void> each_generation_back_from(run_file::RunFile& file, std::uint64_t generation,
                                             base::Executor& executor, const base::StopCheck& stop,
                                             ReportFamilies report);

} // namespace evod::replay
