#include "server/run_file/schema.h"

#include "server/evolution/gene_layout.h"
#include "server/run_file/rows.h"

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

namespace evod::run_file {
namespace {

using base::RefusalCode;
using base::Result;

/// A row of SQLite's table sqlite_schema.
struct SchemaRow {
    std::string type, name, table, sql;
    friend auto operator<=>(const SchemaRow&, const SchemaRow&) = default;
};
using Schema = std::set<SchemaRow>;

constexpr const char* all_of_schema = "SELECT type, name, tbl_name, sql FROM sqlite_schema";

SchemaRow read_schema_row(const Statement& row) {
    return {.type = row.text(0), .name = row.text(1), .table = row.text(2), .sql = row.text(3)};
}

template <class... Tables>
void create_tables(Database& database) {
    (database.run(create_statement<Tables>().c_str()), ...);
}

/// The order of the tables is part of the format, because it determines the number of each table's first page in the
/// file.
void create_all_tables(Database& database) {
    create_tables<RunTable, FirstPopulationTable, ParametersTable, JournalTable, GenerationTable, PopulationTable,
                  OutcomeTable, StateHashTable, ThinnedTable, EndMarkTable, StatisticsTable, InheritedStatisticsTable,
                  CheckpointRowTable, CheckpointPartTable, FoundersTable, SelectionAccountTable>(database);
    // Journal::used_keys() reads it.
    database.run("CREATE INDEX journal_key ON journal (user, client_key, request_id)");
}

void create_colony_tables(Database& database) {
    create_tables<IntervalTable, BirthTable, ColonyTable, PredatorStatisticsTable, PredatorAccountTable,
                  PredatorMoreGenesTable>(database);
}

constexpr std::string_view colony_tables[] = {IntervalTable::name,        BirthTable::name,
                                              ColonyTable::name,          PredatorStatisticsTable::name,
                                              PredatorAccountTable::name, PredatorMoreGenesTable::name};

/// Files that were created in a format before 4 may lack the first of these tables. Files of chromosomes with body
/// genes alone lack the second, and files of worlds that are not colonies lack colony_tables: check_optional_tables().
/// Files of worlds that compute their fitness lack the third.
constexpr std::string_view optional_tables[] = {FirstPopulationTable::name, MoreGenesTable::name, RatingTable::name};

bool is_optional(std::string_view table) {
    return std::ranges::find(optional_tables, table) != std::end(optional_tables) ||
           std::ranges::find(colony_tables, table) != std::end(colony_tables);
}

const Schema& expected_schema() {
    static const Schema expected = [] {
        Database database{":memory:", Database::Mode::Write};
        create_all_tables(database);
        create_tables<MoreGenesTable, RatingTable>(database);
        create_colony_tables(database);
        Schema schema;
        for (Statement rows{database, all_of_schema}; rows.row();) {
            schema.insert(read_schema_row(rows));
        }
        return schema;
    }();
    return expected;
}

/// The description of a row in an error message: `the table "run"`. The name may come from an untrusted file.
std::string described(const SchemaRow& row) {
    constexpr std::size_t name_bytes_max = 64;
    std::string text = "the " + row.type.substr(0, name_bytes_max) + " \"" + row.name.substr(0, name_bytes_max) + '"';
    std::ranges::replace_if(
        text, [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
    return text;
}

bool has_table(RunDatabase& database, std::string_view name) {
    return database.number("SELECT count(*) FROM sqlite_schema WHERE name = '" + std::string{name} + "'") > 0;
}

Result<void> check_tables(RunDatabase& database) {
    Schema found;
    for (Statement rows{database.database, all_of_schema}; rows.row();) {
        SchemaRow row = read_schema_row(rows);
        if (!expected_schema().contains(row)) {
            return refusal(RefusalCode::DataLoss, database.path + " is not as evod wrote it: " + described(row) +
                                                      " does not belong to a run file and could change what is read");
        }
        found.insert(std::move(row));
    }
    if (database.failed()) {
        return database.failure();
    }
    const Schema& expected = expected_schema();
    for (auto row = expected.rbegin(); row != expected.rend(); ++row) { // reports a missing table before its indices
        if (!found.contains(*row) && !is_optional(row->table)) {
            return refusal(RefusalCode::DataLoss, database.path + " is damaged: it lacks " + described(*row));
        }
    }
    return {};
}

} // namespace

bool has_more_genes(const parameters::Parameters& parameters) {
    return evolution::genes_of(evolution::GeneGroup::All, parameters) !=
           evolution::genes_of(evolution::GeneGroup::Body, parameters);
}

bool has_colony_tables(const parameters::Parameters& parameters) {
    return simulation::is_colony(parameters);
}

std::vector<const char*> purged_tables(RunDatabase& database) {
    std::vector<const char*> tables;
    for (const char* table : {RatingTable::name, IntervalTable::name, BirthTable::name, OutcomeTable::name,
                              FoundersTable::name, PopulationTable::name}) {
        if (has_table(database, table)) {
            tables.push_back(table);
        }
    }
    return tables;
}

bool has_ratings(RunDatabase& database) {
    return has_table(database, RatingTable::name);
}

void create_schema(RunDatabase& database, const parameters::Parameters& parameters) {
    database.run("PRAGMA application_id = " + std::to_string(application_id));
    database.run("PRAGMA user_version = " + std::to_string(format_version));
    create_all_tables(database.database);
    if (has_more_genes(parameters)) {
        create_tables<MoreGenesTable>(database.database);
    }
    if (parameters.fitness == parameters::FitnessFunction::External) {
        create_tables<RatingTable>(database.database);
    }
    if (has_colony_tables(parameters)) {
        create_colony_tables(database.database);
    }
}

bool is_empty(RunDatabase& database) {
    return database.number("PRAGMA application_id") == 0 &&
           database.number("SELECT count(*) FROM sqlite_schema") == 0 && !database.failed();
}

base::Refusal empty_file(const std::string& path) {
    return refusal(RefusalCode::DataLoss, path + " is damaged: the file is empty");
}

Result<void> check_schema(RunDatabase& database) {
    const std::int64_t application = database.number("PRAGMA application_id");
    const std::int64_t format = database.number("PRAGMA user_version");
    if (database.failed()) {
        return database.failure();
    }
    if (is_empty(database)) {
        return empty_file(database.path);
    }
    if (application != application_id) {
        return refusal(RefusalCode::InvalidArgument, database.path + " is not a run file of evod");
    }
    if (format != format_version) {
        return refusal(RefusalCode::FailedPrecondition,
                       database.path + " was written by " + (format > format_version ? "a newer" : "an older") +
                           " evod: its format is version " + std::to_string(format) + ", this evod reads version " +
                           std::to_string(format_version));
    }
    return check_tables(database);
}

Result<void> check_optional_tables(RunDatabase& database, const parameters::Parameters& parameters) {
    std::vector<std::string_view> needed;
    if (has_more_genes(parameters)) {
        needed.emplace_back(MoreGenesTable::name);
    }
    if (has_colony_tables(parameters)) {
        needed.insert(needed.end(), std::begin(colony_tables), std::end(colony_tables));
    }
    for (const std::string_view table : needed) {
        if (!has_table(database, table)) {
            return refusal(RefusalCode::DataLoss,
                           database.path + " is damaged: it lacks the table \"" + std::string{table} + '"');
        }
    }
    return {};
}

} // namespace evod::run_file
