// Report: formats the statistics of generations as a table for the terminal.
#pragma once

#include "server/simulation/statistics.h"

#include <string>

namespace evod::commands {

/// Formats the heading or one row of the table. The columns have fixed widths. The text does not end with a newline.
///
/// is_colony  whether the row has the numbers of births, of prey that died of predators and age, and of predators.
std::string table_heading(bool with_island, bool is_colony = false);
std::string table_row(const simulation::GenerationStatistics& statistics, bool with_island, bool is_colony = false);

/// Formats a speed: "0.3 × real time", "7269 × real time".
std::string real_time_text(double factor);

} // namespace evod::commands
