// Report: the statistics of generations for people on a terminal, and for other programs.
#pragma once

#include "server/console/table.h"
#include "server/simulation/statistics.h"

#include <string>
#include <vector>

namespace evod::console {

/// The table's heading, and one row; columns of fixed width, no line end.
std::string table_heading(bool with_island);
std::string table_row(const simulation::GenerationStatistics& statistics, bool with_island);

/// The columns of a Table with every statistic, and one row of it.
std::vector<std::string> statistics_columns();
void write_row(Table& table, const simulation::GenerationStatistics& statistics);

} // namespace evod::console
