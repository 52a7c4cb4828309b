// Rows: declares every table of a run file, each once (table.h). docs/RUN_FILE.md explains the columns.
//
// The declarations define the file format. A different name, type or order is a different format.
#pragma once

#include "server/run_file/records.h"
#include "server/run_file/table.h"
#include "server/simulation/colony.h"

#include <array>
#include <string>
#include <vector>

namespace evod::run_file {

struct RunTable {
    static constexpr const char* name = "run";
    static constexpr std::size_t key_columns = 1;
    struct Row {
        std::string key, value;
    };
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("key", row.key);
        column("value", row.value);
    }
};

struct FirstPopulationTable {
    static constexpr const char* name = "first_population";
    static constexpr std::size_t key_columns = 1;
    struct Row {
        std::uint64_t island = 0, organism_count = 0;
        evolution::GeneMatrix chromosomes;
    };
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("island", row.island);
        column("organism_count", row.organism_count);
        column("chromosomes", GeneBlob{row.chromosomes, row.organism_count});
    }
};

struct ParametersTable {
    static constexpr const char* name = "parameters";
    static constexpr std::size_t key_columns = 1;
    struct Row {
        std::int64_t number = 0;
        std::uint64_t revision = 0;
        std::string active, requested; // texts of experiment files
    };
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("number", row.number);
        column("revision", row.revision);
        column("active", row.active);
        column("requested", row.requested);
    }
};

struct JournalTable {
    static constexpr const char* name = "journal";
    static constexpr std::size_t key_columns = 1;
    using Row = JournalEntry;
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("number", row.number);
        column("tick", row.tick);
        column("sender", row.origin.by.kind);
        column("user", row.origin.by.user);
        column("program", row.origin.by.program);
        column("address", row.origin.by.address);
        column("client_key", row.origin.client_key);
        column("request_id", row.origin.request_id);
        column("request", Blob{row.origin.request});
        column("answer", Blob{row.answer});
        column("endless", row.control.endless);
        column("until_generation", row.control.until_generation);
        column("until_tick", row.control.until_tick);
        column("paused", pause_column(row.control));
        column("speed", row.control.speed);
    }

  private:
    template <class Control>
    static auto pause_column(Control& control) {
        using Flag = std::remove_reference_t<decltype((control.paused))>;
        return PauseColumn<Flag>{control.paused, control.leased};
    }
};

struct GenerationTable {
    static constexpr const char* name = "generation";
    static constexpr std::size_t key_columns = 1;
    struct Row {
        simulation::Moment moment;
        std::int64_t parameters = 0; // ParametersTable::Row::number
        evolution::Progress progress;
    };
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("generation", row.moment.generation);
        column("first_tick", row.moment.tick);
        column("simulated_s", row.moment.simulated_s);
        column("parameters", row.parameters);
        column("generations_over", row.progress.generations);
        column("stagnant", row.progress.stagnant);
        column("best_fitness", row.progress.best_fitness);
        column("last_best_fitness", row.progress.last_best_fitness);
        column("last_died_out", row.progress.last_died_out);
    }
};

struct PopulationTable {
    static constexpr const char* name = "population";
    static constexpr std::size_t key_columns = 2;
    template <class Born>
    struct RowOf {
        std::uint64_t generation, island, organism_count;
        Born born;
    };
    using Row = RowOf<evolution::NextGeneration>;
    using View = RowOf<const evolution::NextGeneration&>;
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("generation", row.generation);
        column("island", row.island);
        column("organism_count", row.organism_count);
        column("elite_count", row.born.elite_count);
        column("survivor_count", row.born.survivor_count);
        column("clamped_count", row.born.clamped_count);
        column("chromosomes", GeneBlob{row.born.genes, row.organism_count});
        column("parents", Blob{row.born.parents});
    }
};

struct FoundersTable {
    static constexpr const char* name = "founders";
    static constexpr std::size_t key_columns = 2;
    template <class Founders>
    struct RowOf {
        std::uint64_t generation, island;
        Founders founders; // empty: unknown
    };
    using Row = RowOf<std::vector<std::uint32_t>>;
    using View = RowOf<const std::vector<std::uint32_t>&>;
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("generation", row.generation);
        column("island", row.island);
        column("founders", Blob{row.founders});
    }
};

struct SelectionAccountTable {
    static constexpr const char* name = "selection_account";
    static constexpr std::size_t key_columns = 2;
    static constexpr bool one_line = true;
    struct Row {
        std::uint64_t generation = 0, island = 0;
        std::optional<evolution::SelectionAccount> account;
    };
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("generation", row.generation);
        column("island", row.island);
        column("", AccountColumns<std::remove_reference_t<decltype((row.account))>>{row.account});
    }
};

struct OutcomeTable {
    static constexpr const char* name = "outcome";
    static constexpr std::size_t key_columns = 2;
    template <class Outcome>
    struct RowOf {
        std::uint64_t generation, island;
        Outcome outcome;
    };
    using Row = RowOf<IslandOutcome>;
    using View = RowOf<const IslandOutcome&>;
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("generation", row.generation);
        column("island", row.island);
        column("fitness", Blob{row.outcome.fitness});
        column("lived_ticks", Blob{row.outcome.lived_ticks});
        column("cause", Blob{row.outcome.cause});
    }
};

/// What clients have given beside the fitness; rows only of islands with several objectives or repaired chromosomes. A
/// file of a world that computes its fitness lacks this table.
struct RatingTable {
    static constexpr const char* name = "rating";
    static constexpr std::size_t key_columns = 2;
    struct Row {
        std::uint64_t generation = 0, island = 0;
        std::vector<double> objectives; // as in IslandOutcome
        std::vector<float> repaired;
    };
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("generation", row.generation);
        column("island", row.island);
        column("objectives", Blob{row.objectives});
        column("repaired", Blob{row.repaired});
    }
};

struct StatisticsTable {
    static constexpr const char* name = "statistics";
    static constexpr std::size_t key_columns = 2;
    static constexpr bool one_line = true;
    using Row = simulation::GenerationStatistics;
    template <class R, class C>
    static void columns(R& row, C&& column) {
        simulation::for_each_number(row, column);
        simulation::for_each_gene_number(row, evolution::body_gene_names, column);
    }
};

/// The numbers that have no columns in the statistics and in the selection accounts: those of the genes that are not
/// body genes, in chromosome order. A file of chromosomes with body genes alone lacks this table.
struct MoreGenesTable {
    static constexpr const char* name = "more_genes";
    static constexpr std::size_t key_columns = 2;
    struct Row {
        std::uint64_t generation = 0, island = 0;
        std::vector<double> statistics; // mean, deviation, min, max of each gene; empty: the generation has not ended
        std::vector<double> account;    // selection, transmission, migration, change of each gene; empty: unknown
    };
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("generation", row.generation);
        column("island", row.island);
        column("statistics", Blob{row.statistics});
        column("account", Blob{row.account});
    }
};

// The tables of colonies (colony.h), which other files lack.

/// The opening of each interval, from the second one on; only with births.
struct IntervalTable {
    static constexpr const char* name = "interval";
    static constexpr std::size_t key_columns = 2;
    struct Row {
        std::uint64_t generation = 0, island = 0;
        std::string opening; // packed (checkpoint.h)
    };
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("generation", row.generation);
        column("island", row.island);
        column("opening", Blob{row.opening});
    }
};

/// The births of each interval, as in IslandOutcome; only with births.
struct BirthTable {
    static constexpr const char* name = "birth";
    static constexpr std::size_t key_columns = 2;
    template <class Births>
    struct RowOf {
        std::uint64_t generation, island;
        Births births;
    };
    using Row = RowOf<std::vector<simulation::Birth>>;
    using View = RowOf<const std::vector<simulation::Birth>&>;
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("generation", row.generation);
        column("island", row.island);
        column("births", Blob{row.births});
    }
};

/// What only colonies have: a row of the prey, and one of the predators if there are any. A fork also has the rows of
/// the generations that it inherited, as in the two tables that follow.
struct ColonyTable {
    static constexpr const char* name = "colony";
    static constexpr std::size_t key_columns = 3;
    static constexpr bool one_line = true;
    struct Row {
        std::uint64_t generation = 0, island = 0;
        simulation::Species species = simulation::Species::Prey;
        simulation::ColonyStatistics colony;
    };
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("generation", row.generation);
        column("island", row.island);
        column("species", row.species);
        simulation::for_each_colony_number(row.colony, column);
    }
};

/// The statistics of predators; `statistics` and the tables that follow it contain those of the prey.
struct PredatorStatisticsTable : StatisticsTable {
    static constexpr const char* name = "predator_statistics";
};
struct PredatorAccountTable : SelectionAccountTable {
    static constexpr const char* name = "predator_account";
};
struct PredatorMoreGenesTable : MoreGenesTable {
    static constexpr const char* name = "predator_more_genes";
};

/// A fork's copy of its origin's statistics, for the generations before the fork's first one.
struct InheritedStatisticsTable : StatisticsTable {
    static constexpr const char* name = "inherited_statistics";
};

struct StateHashTable {
    static constexpr const char* name = "state_hash";
    static constexpr std::size_t key_columns = 1;
    using Row = HashRecord;
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("tick", row.tick);
        column("low", row.hash.low);
        column("high", row.hash.high);
    }
};

struct CheckpointRowTable {
    static constexpr const char* name = "checkpoint";
    static constexpr std::size_t key_columns = 1;
    template <class State>
    struct RowOf {
        simulation::Moment moment;
        std::int64_t parameters = 0; // ParametersTable::Row::number
        std::uint64_t journal_entries = 0;
        base::StateHash hash;
        CoveredChecksums parts; // checksums of the rows with the parts of this checkpoint, in order
        State state;            // the bytes after the parts
    };
    using Row = RowOf<std::string>;
    using View = RowOf<const std::span<const std::byte>&>;
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("tick", row.moment.tick);
        column("generation", row.moment.generation);
        column("generation_tick", row.moment.generation_tick);
        column("simulated_s", row.moment.simulated_s);
        column("parameters", row.parameters);
        column("journal_entries", row.journal_entries);
        column("low", row.hash.low);
        column("high", row.hash.high);
        column("", row.parts);
        column("state", Blob{row.state});
    }
};

struct CheckpointPartTable {
    static constexpr const char* name = "checkpoint_part";
    static constexpr std::size_t key_columns = 2;
    template <class Bytes>
    struct RowOf {
        std::uint64_t tick, part;
        Bytes bytes;
    };
    using Row = RowOf<std::string>;
    using View = RowOf<const std::span<const std::byte>&>;
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("tick", row.tick);
        column("part", row.part);
        column("bytes", Blob{row.bytes});
    }
};

/// The retention rules of a file. The row with the greatest number is in effect.
struct ThinnedTable {
    static constexpr const char* name = "thinned";
    static constexpr std::size_t key_columns = 1;
    struct Row {
        std::uint64_t number = 0;
        RetentionRule rule;
    };
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("number", row.number);
        column("keep_every", row.rule.keep_every);
        column("until_generation", row.rule.until_generation);
        column("until_tick", row.rule.until_tick);
    }
};

struct EndMarkTable {
    static constexpr const char* name = "end_mark";
    static constexpr std::size_t key_columns = 1;
    struct Row {
        std::uint64_t number = 1;
        std::string how; // "ended" or "closed"
        EndMark mark;
    };
    template <class R, class C>
    static void columns(R& row, C&& column) {
        column("number", row.number);
        column("how", row.how);
        column("tick", row.mark.tick);
        column("journal_entries", row.mark.journal_entries);
        column("generations", row.mark.generations);
        column("links", row.mark.hashes);
    }
};

} // namespace evod::run_file
