// History CSV: the statistics of ended generations as CSV, one row per generation and island. `evod run --csv`, `evod
// export` and `evoctl history --csv` write this format.
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

/// Whether a history has the columns of colonies, and those of predators.
struct ColonyColumns {
    bool colony = false, predators = false;
};
ColonyColumns colony_columns_of(const google::protobuf::RepeatedPtrField<evod::v1::GenerationStatistics>& generations);

/// Returns the names of the columns: "generation", "island", …, then four statistics for each gene, then the four
/// columns of the selection account for each gene, then the columns of colonies. Those of predators, which come last,
/// have the prefix predators_.
std::vector<std::string> history_columns(std::span<const std::string> gene_names, ColonyColumns with = {});

/// Returns one number for each column of history_columns(). Numbers that the statistics do not contain are NaN.
std::vector<double> history_numbers(const evod::v1::GenerationStatistics& statistics, ColonyColumns with = {});

std::string history_heading(const std::vector<std::string>& gene_names, ColonyColumns with = {});

/// Formats one row of CSV, with all digits of each number; NaN becomes an empty cell.
std::string history_line(std::span<const double> numbers);

struct HistoryCsv {
    std::vector<std::string> gene_names;
    std::vector<std::vector<double>> rows; // shape (rows, history_columns(gene_names))
};

/// Parses a history. Columns may have any order. Unknown columns are ignored. Columns of the selection account may be
/// missing or empty. An error names the line and the column.
Result<HistoryCsv> read_history_csv(std::string_view text);

} // namespace evod::core
