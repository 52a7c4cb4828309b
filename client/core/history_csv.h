// History CSV: the statistics of ended generations as in `evod run --csv`, `evod export` and `evoctl history --csv`, one row per
// generation and island.
//
// Threads      none.
#pragma once

#include "client/core/connection.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::core {

/// Names of the columns: "generation", "island", …, then four for each gene, then four of each gene's selection account.
std::vector<std::string> history_columns(std::span<const std::string> gene_names);

/// Returns a number for each of these columns; NaN without a selection account.
std::vector<double> history_numbers(const evod::v1::GenerationStatistics& statistics);

std::string history_heading(const std::vector<std::string>& gene_names);

/// Formats with all digits; NaN becomes an empty cell.
std::string history_line(std::span<const double> numbers);

struct HistoryCsv {
    std::vector<std::string> gene_names;
    std::vector<std::vector<double>> rows; // shape (rows, history_columns(gene_names))
};

/// Parses a history. Columns may have any order; unknown columns are ignored; those of selection accounts may be missing or
/// empty. An error names the line and the column.
Result<HistoryCsv> read_history_csv(std::string_view text);

} // namespace evod::core
