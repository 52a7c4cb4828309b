// Schema: creates the tables of a run file, and checks that a file has these tables and nothing else.
#pragma once

#include "server/parameters/model_parameters.h"
#include "server/run_file/run_database.h"

#include <vector>

namespace evod::run_file {

constexpr std::int64_t application_id = 0x45564f44; // "EVOD", at byte 68 of the file
/// Files of older formats are refused, because those formats were never released. All later versions of evod will read
/// this format.
constexpr std::int64_t format_version = 5;

/// Returns whether the chromosomes have genes beyond those of the body. If so, the file has the table of their numbers.
bool has_more_genes(const parameters::Parameters& parameters);

/// The tables whose rows exist only for generations that are retained. The population comes last.
std::vector<const char*> purged_tables(RunDatabase& database);

/// Whether the file has the table of ratings. Files of worlds that compute their fitness do not.
bool has_ratings(RunDatabase& database);

/// Returns whether the file of a run with these parameters has the tables of colonies.
bool has_colony_tables(const parameters::Parameters& parameters);

/// Marks a new database as the run file of a run with these parameters, and creates its tables.
void create_schema(RunDatabase& database, const parameters::Parameters& parameters);

/// Refuses the database unless it is a run file of this format, contains the tables of this format, and contains no
/// other table or index and no trigger or view. Reads only SQLite's own tables, because a view or trigger in an
/// untrusted file could run code.
base::Result<void> check_schema(RunDatabase& database);

/// Refuses the database unless it contains the tables that a run with these parameters needs.
base::Result<void> check_optional_tables(RunDatabase& database, const parameters::Parameters& parameters);

/// Whether the database has no tables and no application id. SQLite creates such a file before its first transaction.
bool is_empty(RunDatabase& database);
base::Refusal empty_file(const std::string& path);

} // namespace evod::run_file
