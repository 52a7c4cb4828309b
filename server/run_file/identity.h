// Identity: the tables `run` and `first_population` of a run file. They store the initial state and settings of the
// run.
#pragma once

#include "server/run_file/records.h"
#include "server/run_file/run_database.h"

namespace evod::run_file {

struct StoredIdentity {
    RunIdentity run;
    std::uint64_t keep_every = 1; // the value of Retention::keep_every()
    // false: the run is not a fork, or an earlier evod wrote the file; then `run.parameters` are those that were
    // requested.
    bool has_parameters_in_effect = true;
};

void write_identity(RunDatabase& database, const StoredIdentity& identity);

/// Reads both tables. Returns DATA_LOSS if a row is damaged, is missing or contradicts another row.
base::Result<StoredIdentity> read_identity(RunDatabase& database);

} // namespace evod::run_file
