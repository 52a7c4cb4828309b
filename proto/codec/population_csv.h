// Population CSV: the chromosomes of a generation as text. Another world can start from this text.
//
//   island,organism,normal_speed,impulse,body_size,base_health,food_radius,poison_radius
//   0,0,103.2,97.5,…
//
// There is a column for each gene of the chromosomes, in their order. evod numbers islands and
// organisms from 0, in order, and writes each gene as the shortest text that parses to the same float. A gene that is
// a choice is the text of the choice. Readers accept its index, too, unless a choice has this text.
//
// A file that another program has changed may have its columns in any order, cells in quotation marks or with blanks,
// empty rows, and a first column without a name (R). If semicolons or tabs separate cells, numbers may have a decimal
// comma. Numbers of islands and organisms need not count from 0 and may repeat: islands are read in order of their
// numbers, and the organisms of an island in the order of their rows. So rows of several files can be put together.
#pragma once

#include "evod/v1/world.pb.h"
#include "proto/codec/result.h"

#include <cstddef>
#include <istream>
#include <string>
#include <string_view>
#include <vector>

namespace evod::codec {

/// The heading of a file of chromosomes with the genes of the body alone.
constexpr std::string_view population_heading =
    "island,organism,normal_speed,impulse,body_size,base_health,food_radius,poison_radius";
constexpr std::size_t genes_max = 10'000; // columns of genes in a file

struct Population {
    std::vector<std::string> gene_names;     // at least one; those of the body come first
    std::vector<std::vector<float>> islands; // shape (islands, organisms · gene_names.size()): organism by organism

    std::size_t organism_count(std::size_t island) const { return islands[island].size() / gene_names.size(); }
};

/// Reads the genes, those of the body first. Does not check whether a world can start with them. Damage
/// reads "line 3: got …, allowed …", and names the column.
///
/// list  of the free genes, whose choices may be texts.
Result<Population> read_population(std::istream& in, const v1::FreeGeneList& list = {});

/// Returns the text of a file with these genes.
std::string population_text(const Population& population);

} // namespace evod::codec
