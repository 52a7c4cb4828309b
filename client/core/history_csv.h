// History as CSV: the statistics of ended generations under the names that they have in `evod run --csv`, `evod export`
// and `evoctl history --csv`, a row for each generation and island.
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

/// Names of the columns: "generation", "island", …, then four for each gene, then four of the account of each.
std::vector<std::string> history_columns(std::span<const std::string> gene_names);

/// A number for each of these columns; not a number where there is no account.
std::vector<double> history_numbers(const evod::v1::GenerationStatistics& statistics);

std::string history_heading(const std::vector<std::string>& gene_names);

/// With all digits; what is not a number is an empty cell.
std::string history_line(std::span<const double> numbers);

struct HistoryCsv {
    std::vector<std::string> gene_names;
    std::vector<std::vector<double>> rows; // of a number for each of history_columns(gene_names)
};

/// Columns may stand in any order, and others than ours are passed over. Those of accounts may be missing or empty. The
/// error names the line and the column.
Result<HistoryCsv> read_history_csv(std::string_view text);

} // namespace evod::core
