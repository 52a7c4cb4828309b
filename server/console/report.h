// Report: the statistics of generations as a table on a terminal and as CSV.
#pragma once

#include "server/simulation/statistics.h"

#include <string>

namespace evod::console {

/// The table's heading, and one row; columns of fixed width, no line end.
std::string table_heading(bool with_island);
std::string table_row(const simulation::GenerationStatistics& statistics, bool with_island);

/// Column names and one line of CSV with every statistic, numbers so that they read back exactly; no line end.
std::string csv_heading();
std::string csv_row(const simulation::GenerationStatistics& statistics);

} // namespace evod::console
