// Report: formats the statistics of generations as a table for the terminal.
#pragma once

#include "server/simulation/statistics.h"

#include <string>

namespace evod::commands {

/// Formats the heading or one row of the table. The columns have fixed widths. The text does not end with a newline.
std::string table_heading(bool with_island);
std::string table_row(const simulation::GenerationStatistics& statistics, bool with_island);

/// Formats a speed: "0.3 × real time", "7269 × real time".
std::string real_time_text(double factor);

} // namespace evod::commands
