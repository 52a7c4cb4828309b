#include "server/run_file/colony_tables.h"

#include "server/evolution/gene_layout.h"
#include "server/run_file/checkpoint.h"
#include "server/run_file/more_genes.h"
#include "server/run_file/rows.h"
#include "server/run_file/schema.h"

#include <utility>

namespace evod::run_file {
namespace {

using base::Result;
using simulation::Species;

/// Calls visit(row) for each row of a generation. Returns false if a row is damaged, if it belongs to no island, or if
/// visit() returns false.
template <class Table, class Visit>
bool for_each_row(RunDatabase& database, std::uint64_t generation, std::size_t island_count, Visit&& visit) {
    TableReader<Table> rows{
        database.database, "generation = ? ORDER BY island", {static_cast<std::int64_t>(generation)}};
    typename Table::Row row{};
    while (rows.next(row)) {
        if (!rows.sound() || row.island >= island_count || !visit(row)) {
            return false;
        }
    }
    return true;
}

} // namespace

struct ColonyTables::Writers {
    explicit Writers(Database& database)
        : interval{database}
        , birth{database}
        , colony{database}
        , statistics{database}
        , account{database}
        , more_genes{database} {}

    TableWriter<IntervalTable> interval;
    TableWriter<BirthTable> birth;
    TableWriter<ColonyTable> colony;
    TableWriter<PredatorStatisticsTable> statistics;
    TableWriter<PredatorAccountTable> account;
    TableWriter<PredatorMoreGenesTable> more_genes;
};

ColonyTables::ColonyTables(RunDatabase& database, const RunIdentity& identity)
    : database_{database}, identity_{identity} {}

ColonyTables::~ColonyTables() = default;

ColonyTables::Writers& ColonyTables::writers() {
    if (!writers_) {
        writers_ = std::make_unique<Writers>(database_.database);
    }
    return *writers_;
}

Result<void> ColonyTables::add_openings(GenerationBegun& begun) {
    const std::uint64_t generation = begun.opening.moment.generation;
    const auto bad = [&] {
        return database_.damaged("a row of the openings of interval " + std::to_string(generation));
    };
    const bool sound = for_each_row<IntervalTable>(database_, generation, begun.born.size(), [&](const auto& row) {
        auto opening = unpack_opening(row.opening);
        const bool fits = opening && row.island == begun.openings.size() &&
                          std::ssize(opening->numbers) == begun.born[row.island].genes.cols();
        if (fits) {
            begun.born[row.island].predator_count = opening->predator_count;
            begun.openings.push_back(*std::move(opening));
        }
        return fits;
    });
    if (database_.failed()) {
        return database_.failure();
    }
    return sound && begun.openings.size() == begun.born.size() ? Result<void>{} : bad();
}

Result<void> ColonyTables::add_to(GenerationBegun& begun) {
    const parameters::Parameters& parameters = begun.opening.parameters.active;
    const std::uint64_t generation = begun.opening.moment.generation;
    if (!has_colony_tables(identity_.parameters)) {
        return {};
    }
    for (evolution::NextGeneration& born : begun.born) {
        born.predator_count = generation >= parameters.predator_from ? parameters.predator_count : 0;
    }
    if (parameters::has_births(parameters) && generation > 1) {
        if (auto added = add_openings(begun); !added) {
            return added;
        }
    }
    bool sound = for_each_row<PredatorAccountTable>(database_, generation, begun.born.size(), [&](const auto& row) {
        begun.born[row.island].predator_account = row.account;
        return true;
    });
    sound &= !has_more_genes(identity_.parameters) ||
             for_each_row<PredatorMoreGenesTable>(database_, generation, begun.born.size(), [&](const auto& row) {
                 return add_account(row, identity_.parameters, begun.born[row.island].predator_account);
             });
    if (!sound) {
        return database_.damaged("a row of the selection accounts of the predators of generation " +
                                 std::to_string(generation));
    }
    return database_.unless_failed();
}

Result<void> ColonyTables::add_to(GenerationEnded& ended) {
    if (!parameters::has_births(identity_.parameters)) {
        return {};
    }
    std::size_t islands = 0;
    const bool sound = for_each_row<BirthTable>(database_, ended.generation, ended.outcomes.size(), [&](auto& row) {
        ended.outcomes[row.island].births = std::move(row.births);
        return row.island == islands++;
    });
    if (!sound || islands != ended.outcomes.size()) {
        return database_.damaged("a row of the births of interval " + std::to_string(ended.generation));
    }
    return database_.unless_failed();
}

Result<void> ColonyTables::add_to(Statistics& rows) {
    if (!has_colony_tables(identity_.parameters) || rows.empty()) {
        return {};
    }
    const std::uint64_t generation = rows.front().generation;
    std::vector<std::optional<simulation::ColonyStatistics>> of_predators(rows.size());
    bool sound = for_each_row<ColonyTable>(database_, generation, rows.size(), [&](const auto& row) {
        (row.species == Species::Prey ? rows[row.island].colony : of_predators[row.island]) = row.colony;
        return row.species <= Species::Predator;
    });
    sound &= for_each_row<PredatorStatisticsTable>(database_, generation, rows.size(), [&](const auto& row) {
        rows[row.island].predators = {row};
        rows[row.island].predators.front().colony = of_predators[row.island];
        return row.predators.empty() && of_predators[row.island].has_value();
    });
    for (std::size_t island = 0; island < rows.size(); ++island) {
        sound &= rows[island].colony.has_value() && rows[island].predators.empty() != of_predators[island].has_value();
    }
    const auto predators_of = [&](const auto& row) {
        auto& predators = rows[row.island].predators;
        return predators.empty() ? nullptr : &predators.front();
    };
    sound &= for_each_row<PredatorAccountTable>(database_, generation, rows.size(), [&](const auto& row) {
        if (auto* predators = predators_of(row)) {
            predators->account = row.account;
        }
        return true;
    });
    sound &= !has_more_genes(identity_.parameters) ||
             for_each_row<PredatorMoreGenesTable>(database_, generation, rows.size(), [&](const auto& row) {
                 auto* predators = predators_of(row);
                 return predators == nullptr || (add_account(row, identity_.parameters, predators->account) &&
                                                 add_statistics(row, identity_.parameters, predators->genes));
             });
    if (!sound) {
        return database_.damaged("a row of the statistics of the colony in generation " + std::to_string(generation));
    }
    return database_.unless_failed();
}

void ColonyTables::write_genes(std::uint64_t generation, std::uint64_t island,
                               const std::vector<simulation::GeneStatistics>& statistics,
                               const std::optional<evolution::SelectionAccount>& account) {
    if (has_more_genes(identity_.parameters)) {
        const auto body = evolution::genes_of(evolution::GeneGroup::Body, identity_.parameters);
        writers().more_genes.write(more_genes_row(generation, island, body.count, statistics, account));
    }
}

void ColonyTables::write(const GenerationBegun& begun) {
    if (!has_colony_tables(identity_.parameters)) {
        return;
    }
    const std::uint64_t generation = begun.opening.moment.generation;
    for (std::size_t island = 0; island < begun.openings.size(); ++island) {
        writers().interval.write(IntervalTable::Row{generation, island, pack(begun.openings[island])});
    }
    for (std::size_t island = 0; island < begun.born.size(); ++island) {
        const evolution::NextGeneration& born = begun.born[island];
        if (born.predator_count > 0) {
            writers().account.write(PredatorAccountTable::Row{generation, island, born.predator_account});
            write_genes(generation, island, {}, born.predator_account);
        }
    }
}

void ColonyTables::write_statistics(const simulation::GenerationStatistics& island) {
    const std::uint64_t generation = island.generation;
    if (island.colony) {
        writers().colony.write(ColonyTable::Row{generation, island.island, Species::Prey, *island.colony});
    }
    for (const simulation::GenerationStatistics& predators : island.predators) {
        writers().statistics.write(predators);
        write_genes(generation, island.island, predators.genes, predators.account);
        if (predators.colony) {
            writers().colony.write(ColonyTable::Row{generation, island.island, Species::Predator, *predators.colony});
        }
    }
}

void ColonyTables::write(const GenerationEnded& ended) {
    if (!has_colony_tables(identity_.parameters)) {
        return;
    }
    if (parameters::has_births(identity_.parameters)) {
        for (std::size_t island = 0; island < ended.outcomes.size(); ++island) {
            writers().birth.write(BirthTable::View{ended.generation, island, ended.outcomes[island].births});
        }
    }
    for (const simulation::GenerationStatistics& island : ended.statistics) {
        write_statistics(island);
    }
}

void ColonyTables::write_inherited(const Statistics& rows) {
    if (!has_colony_tables(identity_.parameters)) {
        return;
    }
    for (const simulation::GenerationStatistics& island : rows) {
        write_statistics(island);
        for (const simulation::GenerationStatistics& predators : island.predators) {
            writers().account.write(PredatorAccountTable::Row{predators.generation, island.island, predators.account});
        }
    }
}

} // namespace evod::run_file
