// Run tables: what a run file holds, as rows for other programs.
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
#include "server/replay/table.h"
#include "server/run_file/run_file.h"

#include <optional>
#include <ostream>
#include <stop_token>

namespace evod::replay {

enum class RunTable { Generations, Organisms, Lineage, Population, Events };

/// An organism by its birth.
struct OrganismName {
    std::uint64_t generation = 0;
    std::uint32_t island = 0, organism = 0;
};

struct WantedTable {
    RunTable table = RunTable::Generations;
    Table::Format format = Table::Format::Csv;
    std::optional<std::uint64_t> generation =
        {};                              // of the population: whose beginning; nothing: the last that has begun
    std::optional<OrganismName> of = {}; // of the lineage: it and its ancestors, newest first; nothing: everyone
    bool only_users = false; // of the events: who sent a command is the name of a token, without client and address
};

/// A run file that is held still, and what simulates again what it does not hold, until `stop` is asked for.
struct RunSource {
    run_file::RunFile& file;
    base::Executor& executor;
    std::stop_token stop = {};
};

/// Refused where the file is damaged, or has no such generation or organism, or follows another model and does not hold
/// it (fields "generation", "of.generation", "of.island", "of.organism"); rows before that are written. Of all
/// organisms those that are out of reach are left out, and of the others what is not known. Whether rows could be
/// written is known by `out`.
base::Result<void> write_table(const RunSource& run, const WantedTable& wanted, std::ostream& out);

/// How many generations' organisms nobody can tell of any more: they are not held, and follow another model than this
/// evod.
std::uint64_t generations_out_of_reach(run_file::RunFile& file);

/// A population that is in no run file, as such a table has it.
void write_population(const std::vector<evolution::GeneMatrix>& population, Table::Format format, std::ostream& out);

} // namespace evod::replay
