// More genes: the rows of `more_genes`, and of `predator_more_genes`: the numbers of genes that have no columns in the
// statistics and in the selection accounts.
#pragma once

#include "server/run_file/rows.h"

#include <optional>
#include <vector>

namespace evod::run_file {

/// Returns the row for the genes that are not body genes.
///
/// first  the first of these genes.
MoreGenesTable::Row more_genes_row(std::uint64_t generation, std::uint64_t island, std::size_t first,
                                   const std::vector<simulation::GeneStatistics>& statistics,
                                   const std::optional<evolution::SelectionAccount>& account);

/// Adds the genes of a row to those of the body. Returns false if the result has not the number of genes of the
/// parameters.
bool add_account(const MoreGenesTable::Row& row, const parameters::Parameters& parameters,
                 std::optional<evolution::SelectionAccount>& account);
bool add_statistics(const MoreGenesTable::Row& row, const parameters::Parameters& parameters,
                    std::vector<simulation::GeneStatistics>& genes);

} // namespace evod::run_file
