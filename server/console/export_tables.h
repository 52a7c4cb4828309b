// Export tables: what a run file holds, as rows for other programs.
//
//   generations  statistics, one row per generation and island, as `evod run --csv` writes them
//   organisms    one row per organism: parents, genes, fitness, death
//   lineage      one row per organism: parents and where they lived, and how many came of it
//   population   one row per organism of one generation: genes, for another world to begin with
//   events       the journal: one row per command that was applied
//
// Rows are written as they are read, a generation at a time; generations that are not held any more are simulated
// again.
#pragma once

#include "server/base/executor.h"
#include "server/console/table.h"
#include "server/storage/run_file.h"

#include <optional>
#include <ostream>

namespace evod::console {

/// A run file that is held still, and what simulates again what it does not hold.
struct Exported {
    storage::RunFile& file;
    base::Executor& executor;
};

/// An organism as it is named on the command line.
struct OrganismName {
    std::uint64_t generation = 0;
    std::uint32_t island = 0, organism = 0;
};

/// How many generations nobody can tell of any more: they are not held, and follow another model than this evod.
std::uint64_t generations_out_of_reach(storage::RunFile& file);

// Refused where the file is damaged, or follows another model and does not hold what is needed; rows before that are
// written. Whether they could be written is known by `out`.

base::Result<void> write_generations(const Exported& run, std::ostream& out, Table::Format format);
/// Without those that are out of reach.
base::Result<void> write_organisms(const Exported& run, std::ostream& out, Table::Format format);
/// of  only this organism and its ancestors, the newest first; refused if there is none of that name.
base::Result<void> write_lineage(const Exported& run, std::ostream& out, Table::Format format,
                                 const std::optional<OrganismName>& of);
/// As another world can begin with it (population_file.h).
///
/// generation  whose beginning is written; refused if the run has not begun it.
base::Result<void> write_population(const Exported& run, std::ostream& out, Table::Format format,
                                    std::uint64_t generation);
base::Result<void> write_population(std::ostream& out, Table::Format format,
                                    const std::vector<evolution::GeneMatrix>& population);
base::Result<void> write_events(const Exported& run, std::ostream& out, Table::Format format);

} // namespace evod::console
