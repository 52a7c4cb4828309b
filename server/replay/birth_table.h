// Birth table: the lives of a world with births, as one row per organism: its birth, its parents and its death.
//
// An organism is named by its island and its number there, which it keeps in all intervals. Rows are written when the
// organism's life is complete, and for the living at the end.
#pragma once

#include "server/replay/run_tables.h"

namespace evod::replay {

/// Writes the table. Refused if the world of the run has no births, or if the file is damaged.
base::Result<void> write_births(const RunSource& run, std::ostream& out, Table::Format format);

} // namespace evod::replay
