// Columns: what the tables that are read again, or written in two places, have in common.
#pragma once

#include "server/replay/table.h"
#include "server/simulation/statistics.h"

#include <string>
#include <vector>

namespace evod::replay {

/// Of every statistic of a generation.
std::vector<std::string> statistics_columns();
void write_row(Table& table, const simulation::GenerationStatistics& statistics);

/// Of a population that a world can begin with.
std::vector<std::string> population_columns();

} // namespace evod::replay
