// Run tables: writes the contents of a run file as rows for other programs.
//
//   generations  statistics, one row per generation and island, as `evod run --csv` writes them
//   organisms    one row per organism: parents, genes, fitness, death
//   lineage      one row per organism: its parents with their islands, and the number of its children
//   population   one row per organism of one generation, without predators: its genes. Another world can begin with
//                this table.
//   events       the journal: one row per applied command
//   notes        one row per note in the journal
//   births       one row per organism of a world with births: its birth, its death and its parents
//   file         not a table: the bytes of a copy of the run file (exported_file.h)
//
// Rows are written generation by generation. Generations that are not retained are simulated again.
#pragma once

#include "server/base/executor.h"
#include "server/base/stop_check.h"
#include "server/replay/table.h"
#include "server/run_file/run_file.h"

#include <optional>
#include <ostream>

namespace evod::replay {

enum class RunTable { Generations, Organisms, Lineage, Population, Events, Notes, File, Births };

/// An organism, identified by the generation and island in which it was born, and by its id there.
struct OrganismName {
    std::uint64_t generation = 0;
    std::uint32_t island = 0, organism = 0;
};

struct WantedTable {
    RunTable table = RunTable::Generations;
    Table::Format format = Table::Format::Csv; // of a file: ignored
    // Population table only: the generation to write; nullopt: the last generation that has begun.
    std::optional<std::uint64_t> generation = {};
    // Lineage table only: write this organism and its ancestors, newest first; nullopt: all organisms.
    std::optional<OrganismName> of = {};
    // Lineage table only: leave out earlier generations. At most the last generation that has begun.
    std::uint64_t first_generation = 0;
    // Events and file only: true writes the user who sent a command, but not the program and the address.
    bool only_users = false;
};

/// A run file with a pinned snapshot, an executor to simulate generations again, and what stops the work.
struct RunSource {
    run_file::RunFile& file;
    base::Executor& executor;
    base::StopCheck stop = {};
    // Of generations and organisms: only generations that this number divides, and the last one.
    std::uint32_t every = 1;
};

/// Writes a table. Refused if the file is damaged, or if it does not contain the generation or the organism. Also
/// refused if that generation is not retained and the run follows another model. Violations name the fields
/// "generation", "of.generation", "of.island" and "of.organism". Rows before the error are still written. Tables of all
/// organisms leave out generations that cannot be read, and leave unknown fields empty. The state of `out` shows
/// whether all rows could be written.
base::Result<void> write_table(const RunSource& run, const WantedTable& wanted, std::ostream& out);

/// The number of generations whose organisms are lost, because they are not retained and the run follows another model.
///
/// stop  stops the work; the number is then too small.
std::uint64_t generations_out_of_reach(run_file::RunFile& file, const base::StopCheck& stop = {});

/// Writes a population that is not from a run file as a table `population`.
void write_population(const std::vector<evolution::GeneMatrix>& population, const parameters::Parameters& parameters,
                      Table::Format format, std::ostream& out);

} // namespace evod::replay
