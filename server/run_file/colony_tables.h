// Colony tables: the tables of a run file that only colonies have (simulation/colony.h): openings and births of
// intervals, what only colonies count, and the statistics of predators.
//
// Owner        Generations. The functions do nothing if the run is not a colony.
#pragma once

#include "server/run_file/records.h"
#include "server/run_file/run_database.h"

#include <memory>
#include <vector>

namespace evod::run_file {

class ColonyTables {
  public:
    using Statistics = std::vector<simulation::GenerationStatistics>;

    /// Both references must outlive this object.
    ColonyTables(RunDatabase& database, const RunIdentity& identity);
    ~ColonyTables();

    // Each adds to what has been read from the other tables. Refused if the file is damaged.
    base::Result<void> add_to(GenerationBegun& begun);
    base::Result<void> add_to(GenerationEnded& ended);
    /// rows  those of one generation, one per island.
    base::Result<void> add_to(Statistics& rows);

    void write(const GenerationBegun& begun);
    void write(const GenerationEnded& ended);
    /// Writes what the two functions above write of a generation's statistics.
    void write_inherited(const Statistics& rows);

  private:
    struct Writers;
    Writers& writers();
    base::Result<void> add_openings(GenerationBegun& begun);
    void write_genes(std::uint64_t generation, std::uint64_t island,
                     const std::vector<simulation::GeneStatistics>& statistics,
                     const std::optional<evolution::SelectionAccount>& account);
    void write_statistics(const simulation::GenerationStatistics& island);

    RunDatabase& database_;
    const RunIdentity& identity_;
    std::unique_ptr<Writers> writers_;
};

} // namespace evod::run_file
