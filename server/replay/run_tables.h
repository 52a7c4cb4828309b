// Run tables: the contents of a run file as rows for other programs.
//
//   generations  statistics, one row per generation and island, as `evod run --csv` writes them
//   organisms    one row per organism: parents, genes, fitness, death
//   lineage      one row per organism: its parents with their islands, and its number of children
//   population   one row per organism of one generation: genes; another world can begin with them
//   events       the journal: one row per applied command
//
// Rows are written generation by generation; generations that are not retained are simulated again.
#pragma once

#include "server/base/executor.h"
#include "server/replay/table.h"
#include "server/run_file/run_file.h"

#include <optional>
#include <ostream>
#include <stop_token>

namespace evod::replay {

enum class RunTable { Generations, Organisms, Lineage, Population, Events };

/// An organism, identified by where it was born.
struct OrganismName {
    std::uint64_t generation = 0;
    std::uint32_t island = 0, organism = 0;
};

struct WantedTable {
    RunTable table = RunTable::Generations;
    Table::Format format = Table::Format::Csv;
    std::optional<std::uint64_t> generation = {}; // of the population; nothing: the last that has begun
    std::optional<OrganismName> of = {}; // of the lineage: it and its ancestors, newest first; nothing: all organisms
    bool only_users = false; // of the events: name only the user who sent a command, without program and address
};

/// A run file with a pinned snapshot, and an executor for what has to be simulated again. `stop` cancels.
struct RunSource {
    run_file::RunFile& file;
    base::Executor& executor;
    std::stop_token stop = {};
};

/// Refused if the file is damaged, has no such generation or organism, or does not retain it and follows another model
/// (fields "generation", "of.generation", "of.island", "of.organism"); earlier rows are written all the same. Tables of
/// all organisms leave out generations that cannot be read, and leave fields empty that are not known. The state of `out`
/// shows whether the rows could be written.
base::Result<void> write_table(const RunSource& run, const WantedTable& wanted, std::ostream& out);

/// The number of generations whose organisms are lost: they are not retained, and the run follows another model.
std::uint64_t generations_out_of_reach(run_file::RunFile& file);

/// Writes a population that is in no run file as such a table.
void write_population(const std::vector<evolution::GeneMatrix>& population, Table::Format format, std::ostream& out);

} // namespace evod::replay
