// Columns: the columns of tables that two programs write, or that evod reads back.
#pragma once

#include "proto/codec/gene_texts.h"
#include "server/replay/table.h"
#include "server/simulation/statistics.h"

#include <span>
#include <string>
#include <vector>

namespace evod::replay {

/// Which columns of colonies the statistics table has.
enum class ColonyColumns { None, Prey, Both };
ColonyColumns colony_columns_of(const parameters::Parameters& parameters);

/// The columns of the statistics table. Those of predators have the prefix predators_.
///
/// gene_names  names of the first genes of the chromosomes, all of which the table then contains.
std::vector<std::string> statistics_columns(std::span<const std::string> gene_names,
                                            ColonyColumns colony = ColonyColumns::None);
/// Writes a row. Cells of a species that is not there are empty.
void write_row(Table& table, const simulation::GenerationStatistics& statistics,
               std::span<const std::string> gene_names, ColonyColumns colony = ColonyColumns::None);

/// Returns the columns of the table `population`, with which another world can begin.
std::vector<std::string> population_columns(std::span<const std::string> gene_names);

/// The names of the genes that the world of a run has.
std::vector<std::string> gene_names_of(const parameters::Parameters& parameters);
/// The texts of the genes that the world of a run has.
codec::GeneTexts gene_texts_of(const parameters::Parameters& parameters);
/// Writes a gene of an organism: the text of a choice, or a number.
void write_gene(Table& table, const codec::GeneTexts& texts, std::size_t gene, float value);
/// The names of the body genes, which every world has whose fitness no client computes.
std::vector<std::string> body_gene_names();

} // namespace evod::replay
