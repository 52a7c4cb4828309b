// Columns: the columns of tables that two programs write, or that evod reads back.
#pragma once

#include "server/replay/table.h"
#include "server/simulation/statistics.h"

#include <string>
#include <vector>

namespace evod::replay {

/// The columns of the statistics table.
std::vector<std::string> statistics_columns();
void write_row(Table& table, const simulation::GenerationStatistics& statistics);

/// Returns the columns of the table `population`, with which another world can begin.
std::vector<std::string> population_columns();

} // namespace evod::replay
