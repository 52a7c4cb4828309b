#include "server/run_file/generations.h"

#include "server/run_file/more_genes.h"
#include "server/run_file/rows.h"
#include "server/run_file/schema.h"

#include <algorithm>
#include <utility>

namespace evod::run_file {
namespace {

using base::Result;

std::string accounts_text(std::uint64_t generation) {
    return "a row of the selection accounts of generation " + std::to_string(generation);
}

std::vector<std::int64_t> value_of(std::uint64_t generation) {
    return {static_cast<std::int64_t>(generation)};
}

std::string more_genes_text(std::uint64_t generation) {
    return "a row of the further genes of generation " + std::to_string(generation);
}

constexpr const char* of_generation = "generation = ? ORDER BY island";
constexpr const char* from_generation_to = "generation >= ? AND generation < ? ORDER BY generation, island";

} // namespace

struct Generations::Writers {
    Writers(RunDatabase& file, Database& database, bool with_more_genes)
        : generation{database}
        , population{database}
        , founders{database}
        , account{database}
        , outcome{database}
        , statistics{database} {
        if (with_more_genes) {
            more_genes.emplace(database);
        }
        if (has_ratings(file)) {
            rating.emplace(database);
        }
    }

    TableWriter<GenerationTable> generation;
    TableWriter<PopulationTable> population;
    TableWriter<FoundersTable> founders;
    TableWriter<SelectionAccountTable> account;
    TableWriter<OutcomeTable> outcome;
    TableWriter<StatisticsTable> statistics;
    std::optional<TableWriter<MoreGenesTable>> more_genes; // if the file has this table
    std::optional<TableWriter<RatingTable>> rating;        // if the file has this table
};

Generations::Generations(RunDatabase& database, const RunIdentity& identity, ParameterSets& parameter_sets,
                         Retention& retention)
    : database_{database}
    , identity_{identity}
    , parameter_sets_{parameter_sets}
    , retention_{retention}
    , colony_{database, identity} {}

Generations::~Generations() = default;

Generations::Writers& Generations::writers() {
    if (!writers_) {
        writers_ = std::make_unique<Writers>(database_, database_.database, has_more_genes(identity_.parameters));
    }
    return *writers_;
}

std::size_t Generations::gene_count() const {
    return evolution::gene_count(identity_.parameters);
}

void Generations::write_account(std::uint64_t generation, std::uint64_t island,
                                const std::optional<evolution::SelectionAccount>& account) {
    const bool in_columns = evolution::has_body_genes(identity_.parameters);
    writers().account.write(SelectionAccountTable::Row{generation, island, in_columns ? account : std::nullopt});
}

simulation::GenerationStatistics Generations::in_columns(simulation::GenerationStatistics statistics) const {
    if (!evolution::has_body_genes(identity_.parameters)) {
        statistics.genes.assign(evolution::body_gene_count, {});
    }
    return statistics;
}

std::uint64_t Generations::at_tick(std::uint64_t tick) {
    return std::max(
        identity_.first_generation,
        database_.natural("SELECT max(generation) FROM generation WHERE first_tick < " + std::to_string(tick)));
}

Result<std::optional<simulation::Opening>> Generations::opening_of(std::uint64_t generation) {
    TableReader<GenerationTable> reader{database_.database, "generation = ?", value_of(generation)};
    GenerationTable::Row row;
    if (!reader.next(row)) {
        return database_.unless_failed(std::optional<simulation::Opening>{});
    }
    if (!reader.sound()) {
        return database_.damaged(row_text(GenerationTable::name, generation));
    }
    const auto set = parameter_sets_.read(row.parameters);
    if (!set) {
        return set.error();
    }
    return std::optional{simulation::Opening{.moment = row.moment, .parameters = *set, .progress = row.progress}};
}

Result<std::vector<evolution::NextGeneration>> Generations::read_populations(const simulation::Opening& opening) {
    std::vector<evolution::NextGeneration> islands;
    TableReader<PopulationTable> rows{database_.database, of_generation, value_of(opening.moment.generation)};
    const auto bad = [&] {
        return database_.damaged("the population of generation " + std::to_string(opening.moment.generation) +
                                 " on island " + std::to_string(islands.size()));
    };
    PopulationTable::Row row{};
    const auto genes = static_cast<Eigen::Index>(evolution::gene_count(opening.parameters.active));
    while (rows.next(row)) {
        const auto organisms = static_cast<std::uint64_t>(row.born.genes.cols());
        if (organisms == 0 && row.organism_count == 0) { // an island where all have died
            row.born.genes.resize(genes, 0);
        }
        if (!rows.sound() || row.island != islands.size() || organisms != row.organism_count ||
            row.born.genes.rows() != genes || static_cast<std::size_t>(genes) != gene_count() ||
            // Organisms of the first generation have no parents.
            (!row.born.parents.empty() && row.born.parents.size() != organisms)) {
            return bad();
        }
        islands.push_back(std::move(row.born));
    }
    if (database_.failed()) {
        return database_.failure();
    }
    if (islands.size() != opening.parameters.active.island_count) {
        return bad();
    }
    return islands;
}

Result<simulation::Founders> Generations::founders_of(const GenerationBegun& begun) {
    simulation::Founders islands;
    const std::uint64_t generation = begun.opening.moment.generation;
    const auto bad = [&] {
        return database_.damaged("a row of the founders of generation " + std::to_string(generation));
    };
    TableReader<FoundersTable> rows{database_.database, of_generation, value_of(generation)};
    bool have_founders = true;
    FoundersTable::Row row{};
    while (rows.next(row)) {
        if (!rows.sound() || row.island != islands.size() || row.island >= begun.born.size()) {
            return bad();
        }
        have_founders &= row.founders.size() == static_cast<std::size_t>(begun.born[row.island].genes.cols());
        if (!have_founders && !row.founders.empty()) {
            return bad();
        }
        islands.push_back(std::move(row.founders));
    }
    if (database_.failed()) {
        return database_.failure();
    }
    if (islands.size() != begun.born.size()) {
        return bad();
    }
    return have_founders ? std::move(islands) : simulation::Founders{};
}

Result<Generations::Accounts> Generations::accounts_of(std::uint64_t generation, std::size_t island_count) {
    Accounts islands;
    TableReader<SelectionAccountTable> rows{database_.database, of_generation, value_of(generation)};
    SelectionAccountTable::Row row;
    while (rows.next(row)) {
        if (!rows.sound() || row.island != islands.size()) {
            return database_.damaged(accounts_text(generation));
        }
        islands.push_back(row.account);
    }
    if (database_.failed() || islands.size() != island_count) {
        return database_.damaged(accounts_text(generation));
    }
    if (has_more_genes(identity_.parameters)) {
        const auto more = more_genes_of(generation, island_count);
        if (!more) {
            return more.error();
        }
        for (std::size_t island = 0; island < island_count; ++island) {
            if (!add_account((*more)[island], identity_.parameters, islands[island])) {
                return database_.damaged(more_genes_text(generation));
            }
        }
    }
    return islands;
}

Result<std::vector<MoreGenesTable::Row>> Generations::more_genes_of(std::uint64_t generation,
                                                                    std::size_t island_count) {
    std::vector<MoreGenesTable::Row> islands(island_count);
    TableReader<MoreGenesTable> rows{database_.database, of_generation, value_of(generation)};
    MoreGenesTable::Row row;
    while (rows.next(row)) {
        if (!rows.sound() || row.island >= island_count) {
            return database_.damaged(more_genes_text(generation));
        }
        islands[row.island] = std::move(row);
    }
    return database_.unless_failed(std::move(islands));
}

Result<std::optional<GenerationBegun>> Generations::beginning_of(std::uint64_t generation) {
    auto opening = opening_of(generation);
    if (!opening) {
        return opening.error();
    }
    if (!*opening || !retention_.is_retained(generation)) {
        return std::optional<GenerationBegun>{};
    }
    auto born = read_populations(**opening);
    if (!born) {
        return born.error();
    }
    GenerationBegun begun{.opening = **opening, .born = *std::move(born)};
    auto founders = founders_of(begun);
    if (!founders) {
        return founders.error();
    }
    begun.founders = *std::move(founders);
    const auto accounts = accounts_of(generation, begun.born.size());
    if (!accounts) {
        return accounts.error();
    }
    for (std::size_t island = 0; island < accounts->size(); ++island) {
        begun.born[island].account = (*accounts)[island];
    }
    if (auto added = colony_.add_to(begun); !added) {
        return added.error();
    }
    return std::optional{std::move(begun)};
}

bool Generations::add_ratings(GenerationEnded& ended) {
    if (!has_ratings(database_)) {
        return true;
    }
    TableReader<RatingTable> rows{database_.database, of_generation, value_of(ended.generation)};
    RatingTable::Row row;
    while (rows.next(row)) {
        if (!rows.sound() || row.island >= ended.outcomes.size()) {
            return false;
        }
        simulation::IslandOutcome& outcome = ended.outcomes[row.island];
        const std::size_t organisms = outcome.fitness.size();
        if (organisms == 0 || row.objectives.size() % organisms != 0 || row.repaired.size() % organisms != 0) {
            return false;
        }
        outcome.objectives = std::move(row.objectives);
        outcome.repaired = std::move(row.repaired);
    }
    return true;
}

Result<std::optional<GenerationEnded>> Generations::outcome_of(std::uint64_t generation) {
    GenerationEnded ended{.generation = generation, .outcomes = {}, .statistics = {}};
    const auto bad = [&] { return database_.damaged("the outcome of generation " + std::to_string(generation)); };
    TableReader<OutcomeTable> rows{database_.database, of_generation, value_of(generation)};
    OutcomeTable::Row row{};
    while (rows.next(row)) {
        const std::size_t organisms = row.outcome.fitness.size();
        if (!rows.sound() || row.island != ended.outcomes.size() || row.outcome.lived_ticks.size() != organisms ||
            row.outcome.cause.size() != organisms) {
            return bad();
        }
        ended.outcomes.push_back(std::move(row.outcome));
    }
    if (database_.failed()) {
        return database_.failure();
    }
    if (!add_ratings(ended)) {
        return bad();
    }
    if (auto added = colony_.add_to(ended); !added) {
        return added.error();
    }
    if (ended.outcomes.empty() && !retention_.is_retained(generation)) {
        return std::optional<GenerationEnded>{};
    }
    auto statistics = statistics_of(generation);
    if (!statistics) {
        return statistics.error();
    }
    ended.statistics = *std::move(statistics);
    if (ended.outcomes.size() != ended.statistics.size()) {
        return bad();
    }
    if (ended.outcomes.empty()) {
        return std::optional<GenerationEnded>{};
    }
    return std::optional{std::move(ended)};
}

Result<std::vector<simulation::GenerationStatistics>> Generations::statistics_of(std::uint64_t generation) {
    std::vector<simulation::GenerationStatistics> statistics;
    TableReader<StatisticsTable> rows{database_.database, of_generation, value_of(generation)};
    simulation::GenerationStatistics island;
    while (rows.next(island)) {
        if (!rows.sound() || island.island != statistics.size()) {
            return database_.damaged("a row of the statistics of generation " + std::to_string(generation));
        }
        statistics.push_back(island);
    }
    if (database_.failed()) {
        return database_.failure();
    }
    if (statistics.empty()) {
        return statistics;
    }
    const auto accounts = accounts_of(generation, statistics.size());
    if (!accounts) {
        return accounts.error();
    }
    for (std::size_t i = 0; i < statistics.size(); ++i) {
        statistics[i].account = (*accounts)[i];
    }
    if (has_more_genes(identity_.parameters)) {
        const auto more = more_genes_of(generation, statistics.size());
        if (!more) {
            return more.error();
        }
        for (std::size_t i = 0; i < statistics.size(); ++i) {
            if (!add_statistics((*more)[i], identity_.parameters, statistics[i].genes)) {
                return database_.damaged(more_genes_text(generation));
            }
        }
    }
    if (auto added = colony_.add_to(statistics); !added) {
        return added.error();
    }
    return statistics;
}

Result<simulation::History> Generations::history(std::uint64_t before, std::size_t count) {
    simulation::History history;
    const std::uint64_t own = identity_.first_generation;
    const std::uint64_t first =
        std::max(own - identity_.inherited_generations, before - std::min<std::uint64_t>(before, count));
    if (first < own) {
        if (auto read = read_history(InheritedStatisticsTable::name, first, std::min(own, before), history); !read) {
            return read.error();
        }
        if (first + history.size() < std::min(own, before)) {
            return database_.damaged(row_text(InheritedStatisticsTable::name, first + history.size()));
        }
    }
    if (auto read = read_history(StatisticsTable::name, std::max(first, own), before, history); !read) {
        return read.error();
    }
    if (first + history.size() < std::min(before, last())) { // every generation before the last must have ended
        return database_.damaged(row_text(StatisticsTable::name, first + history.size()));
    }
    return history;
}

Result<void> Generations::read_history(const char* table, std::uint64_t first, std::uint64_t end,
                                       simulation::History& history) {
    const std::vector<std::int64_t> range{static_cast<std::int64_t>(first), static_cast<std::int64_t>(end)};
    TableReader<StatisticsTable> numbers{database_.database, from_generation_to, range, table};
    // Reads the selection accounts of the same generations, and of one more if the last generation has not ended.
    TableReader<SelectionAccountTable> accounts{database_.database, from_generation_to, range};
    std::optional<TableReader<MoreGenesTable>> more_genes;
    if (has_more_genes(identity_.parameters)) {
        more_genes.emplace(database_.database, from_generation_to, range);
    }
    std::uint64_t expected = first;
    std::vector<simulation::GenerationStatistics> rows; // rows of the generation `expected`
    const auto add_rows = [&]() -> Result<void> {
        auto added = colony_.add_to(rows);
        history.emplace_back(std::exchange(rows, {}));
        ++expected;
        return added;
    };
    simulation::GenerationStatistics statistics;
    SelectionAccountTable::Row account;
    while (numbers.next(statistics)) {
        if (statistics.island == 0 && !rows.empty()) {
            if (auto added = add_rows(); !added) {
                return added;
            }
        }
        if (!numbers.sound() || statistics.generation != expected || statistics.island != rows.size()) {
            return database_.damaged(row_text(table, expected));
        }
        if (!accounts.next(account) || !accounts.sound() || account.generation != expected ||
            account.island != statistics.island) {
            return database_.damaged(accounts_text(expected));
        }
        statistics.account = account.account;
        rows.push_back(statistics);
        if (more_genes) {
            MoreGenesTable::Row row;
            if (!more_genes->next(row) || !more_genes->sound() || row.generation != expected ||
                row.island != statistics.island || !add_statistics(row, identity_.parameters, rows.back().genes) ||
                !add_account(row, identity_.parameters, rows.back().account)) {
                return database_.damaged(more_genes_text(expected));
            }
        }
    }
    if (!rows.empty()) {
        if (auto added = add_rows(); !added) {
            return added;
        }
    }
    return database_.unless_failed();
}

void Generations::write_more_genes(std::uint64_t generation, std::uint64_t island,
                                   const std::vector<simulation::GeneStatistics>& statistics,
                                   const std::optional<evolution::SelectionAccount>& account) {
    if (writers().more_genes) {
        writers().more_genes->write(more_genes_row(
            generation, island, evolution::genes_of(evolution::GeneGroup::Body, identity_.parameters).count, statistics,
            account));
    }
}

void Generations::write(const Inherited& inherited) {
    TableWriter<InheritedStatisticsTable> statistics{database_.database};
    for (const simulation::GenerationRows& generation : inherited.history) {
        for (const simulation::GenerationStatistics& island : generation) {
            statistics.write(in_columns(island));
            write_account(island.generation, island.island, island.account);
            write_more_genes(island.generation, island.island, island.genes, island.account);
        }
        colony_.write_inherited({generation.begin(), generation.end()});
    }
}

void Generations::write(const GenerationBegun& begun) {
    const simulation::Opening& opening = begun.opening;
    const std::uint64_t generation = opening.moment.generation;
    const std::int64_t parameters = parameter_sets_.number_of(opening.parameters);
    writers().generation.write(GenerationTable::Row{opening.moment, parameters, opening.progress});
    const std::vector<std::uint32_t> unknown;
    for (std::size_t island = 0; island < begun.born.size(); ++island) {
        const evolution::NextGeneration& born = begun.born[island];
        writers().population.write(
            PopulationTable::View{generation, island, static_cast<std::uint64_t>(born.genes.cols()), born});
        writers().founders.write(
            FoundersTable::View{generation, island, begun.founders.empty() ? unknown : begun.founders[island]});
        write_account(generation, island, born.account);
        write_more_genes(generation, island, {}, born.account);
    }
    colony_.write(begun);
    // The previous generation was retained only while it was the newest.
    const std::uint64_t before = generation - 1;
    if (before <= identity_.first_generation || (before - identity_.first_generation) % retention_.keep_every() == 0) {
        return;
    }
    std::vector<const char*> tables = purged_tables(database_);
    tables.push_back(CheckpointRowTable::name);
    for (const char* table : tables) {
        database_.run("DELETE FROM " + std::string{table} + " WHERE generation = " + std::to_string(before));
    }
}

void Generations::write(const GenerationEnded& ended) {
    for (std::size_t island = 0; island < ended.outcomes.size(); ++island) {
        writers().outcome.write(OutcomeTable::View{ended.generation, island, ended.outcomes[island]});
        const simulation::IslandOutcome& outcome = ended.outcomes[island];
        if (!outcome.objectives.empty() || !outcome.repaired.empty()) {
            writers().rating->write(RatingTable::Row{ended.generation, island, outcome.objectives, outcome.repaired});
        }
    }
    colony_.write(ended);
    for (const simulation::GenerationStatistics& statistics : ended.statistics) {
        writers().statistics.write(in_columns(statistics));
        write_more_genes(ended.generation, statistics.island, statistics.genes, statistics.account);
    }
}

} // namespace evod::run_file
