// Descendant: reads the origin of a descendant's genes from the protocol's message.
#pragma once

#include "evod/v1/commands.pb.h"

#include <string>

namespace evod::codec {

/// Returns whether the gene with this index comes from the second parent.
bool comes_from_second(const evod::v1::Descendant& descendant, int gene);

/// Returns the parent of each gene, 1 or 2, in the order of the genes: "112222". Chromosomes of more than 12 genes are
/// summarised: "2x1 310x2 16x1" states that the first 2 genes come from parent 1 and the next 310 from parent 2.
std::string parents_of_genes(const evod::v1::Descendant& descendant);

} // namespace evod::codec
