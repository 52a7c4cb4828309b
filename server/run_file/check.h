// Check: reads a whole run file and compares every row with its checksum.
//
// Rows are numbered without gaps, so a missing row is found as well as a damaged one.
#pragma once

#include "server/base/executor.h"
#include "server/run_file/run_database.h"

namespace evod::run_file {

class RunFile;

/// Whether SQLite finds the file sound, and every row is as it was written.
///
/// progress  called with each generation before it is read.
base::Result<void> check(RunFile& file, base::FunctionRef<void(std::uint64_t generation)> progress);
base::Result<void> check(RunFile& file);

/// Whether the file contains as much as its end mark states; succeeds if there is no end mark.
base::Result<void> check_end_mark(RunFile& file);

/// Whether SQLite finds a table and its indices sound; "1": the whole file, up to the first fault.
base::Result<void> check_tree(RunDatabase& database, const std::string& table);

} // namespace evod::run_file
