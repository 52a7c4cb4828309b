// Generations: the tables of a run file that describe generations: how each generation began, its populations,
// founders, selection accounts, outcomes and statistics.
//
// Owner        a RunFile.
#pragma once

#include "server/run_file/colony_tables.h"
#include "server/run_file/parameter_sets.h"
#include "server/run_file/records.h"
#include "server/run_file/retention.h"
#include "server/run_file/rows.h"
#include "server/run_file/run_database.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::run_file {

class Generations {
  public:
    /// All references that are passed in must outlive this object.
    Generations(RunDatabase& database, const RunIdentity& identity, ParameterSets& parameter_sets,
                Retention& retention);
    ~Generations();

    /// The newest generation that has begun; 0 if none has begun.
    std::uint64_t last() { return database_.natural("SELECT max(generation) FROM generation"); }
    /// The newest generation that has ended; 0 if none has ended.
    std::uint64_t last_ended() { return database_.natural("SELECT max(generation) FROM statistics"); }
    /// Returns the generation that the run had reached after this tick; the first generation if the run had not begun.
    std::uint64_t at_tick(std::uint64_t tick);

    /// The opening of a generation; nullopt if the generation has not begun.
    base::Result<std::optional<simulation::Opening>> opening_of(std::uint64_t generation);
    /// The beginning of a generation; nullopt if the generation has not begun or is not retained.
    base::Result<std::optional<GenerationBegun>> beginning_of(std::uint64_t generation);
    /// The outcome of a generation; nullopt if the generation has not ended or is not retained.
    base::Result<std::optional<GenerationEnded>> outcome_of(std::uint64_t generation);
    /// The statistics of a generation, one entry per island; empty if the generation has not ended.
    base::Result<std::vector<simulation::GenerationStatistics>> statistics_of(std::uint64_t generation);
    /// The statistics of the last `count` generations before generation `before`, oldest first. For a fork, they
    /// include inherited statistics.
    base::Result<simulation::History> history(std::uint64_t before, std::size_t count);

    void write(const Inherited& inherited);
    void write(const GenerationBegun& begun);
    void write(const GenerationEnded& ended);

  private:
    struct Writers;
    using Accounts = std::vector<std::optional<evolution::SelectionAccount>>;

    /// The number of genes of each chromosome of the run.
    std::size_t gene_count() const;
    base::Result<std::vector<evolution::NextGeneration>> read_populations(const simulation::Opening& opening);
    base::Result<simulation::Founders> founders_of(const GenerationBegun& begun);
    /// The selection accounts of a generation, one per island. A fork also has them for the generations that it
    /// inherited.
    base::Result<Accounts> accounts_of(std::uint64_t generation, std::size_t island_count);
    /// Reads statistics from a table and appends them to `history`, from generation `first` up to but not including
    /// `end`.
    base::Result<void> read_history(const char* table, std::uint64_t first, std::uint64_t end,
                                    simulation::History& history);
    /// The numbers of the genes beyond those of the body in a generation, one row per island.
    /// Adds what the table `rating` contains; false: the file is damaged.
    bool add_ratings(GenerationEnded& ended);
    base::Result<std::vector<MoreGenesTable::Row>> more_genes_of(std::uint64_t generation, std::size_t island_count);
    void write_account(std::uint64_t generation, std::uint64_t island,
                       const std::optional<evolution::SelectionAccount>& account);
    /// Returns the statistics as their columns contain them: 0 for the genes of the body if the run has none.
    simulation::GenerationStatistics in_columns(simulation::GenerationStatistics statistics) const;
    void write_more_genes(std::uint64_t generation, std::uint64_t island,
                          const std::vector<simulation::GeneStatistics>& statistics,
                          const std::optional<evolution::SelectionAccount>& account);
    Writers& writers();

    RunDatabase& database_;
    const RunIdentity& identity_;
    ParameterSets& parameter_sets_;
    Retention& retention_;
    ColonyTables colony_;
    std::unique_ptr<Writers> writers_;
};

} // namespace evod::run_file
