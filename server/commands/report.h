// Report: the statistics of generations for people on a terminal.
#pragma once

#include "server/simulation/statistics.h"

#include <string>

namespace evod::commands {

/// The table's heading, and one row; columns of fixed width, no line end.
std::string table_heading(bool with_island);
std::string table_row(const simulation::GenerationStatistics& statistics, bool with_island);

} // namespace evod::commands
