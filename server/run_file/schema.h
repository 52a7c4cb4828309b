// Schema: creates the tables of a run file, and checks that a file has these tables and nothing else.
#pragma once

#include "server/run_file/run_database.h"

namespace evod::run_file {

constexpr std::int64_t application_id = 0x45564f44; // "EVOD", at byte 68 of the file
/// Older formats were never released and are refused; this one is read for ever.
constexpr std::int64_t format_version = 4;

/// Marks a new database as a run file and creates its tables.
void create_schema(RunDatabase& database);

/// Refused unless the database is a run file of this format with its tables and no other trigger, view or index.
/// Reads nothing but SQLite's own tables: a view or trigger in an untrusted file could run code.
base::Result<void> check_schema(RunDatabase& database);

/// Whether the database has no table and no application id: SQLite creates a file before its first transaction.
bool is_empty(RunDatabase& database);
base::Refusal empty_file(const std::string& path);

} // namespace evod::run_file
