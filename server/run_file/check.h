// Check: reads a whole run file and compares every row with its checksum.
//
// Rows are numbered without gaps, so the check detects missing rows as well as damaged ones.
#pragma once

#include "server/base/executor.h"
#include "server/run_file/run_database.h"

namespace evod::run_file {

class RunFile;

/// Checks that SQLite finds no damage, that no row is missing, and that every row has the right checksum.
///
/// progress  called with the number of each generation before that generation is read.
base::Result<void> check(RunFile& file, base::FunctionRef<void(std::uint64_t generation)> progress);
base::Result<void> check(RunFile& file);

/// Checks that the file contains as many rows as its end mark states. Succeeds if there is no end mark.
base::Result<void> check_end_mark(RunFile& file);

/// Lets SQLite check a table and its indices for damage. With "1" as `table`, SQLite checks the whole file and stops at
/// the first fault.
base::Result<void> check_tree(RunDatabase& database, const std::string& table);

} // namespace evod::run_file
