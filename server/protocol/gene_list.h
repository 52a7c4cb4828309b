// Converts lists of free genes to messages and back.
#pragma once

#include "evod/v1/world.pb.h"
#include "server/base/result.h"
#include "server/evolution/free_genes.h"

#include <string_view>
#include <vector>

namespace evod::protocol {

/// Returns the list in a message. Adds what is wrong with it to `violations`, which are named `field` + "[2].step".
evolution::FreeGenes to_gene_list(const v1::FreeGeneList& message, std::string_view field,
                                  std::vector<base::Violation>& violations);
void to_proto(const evolution::FreeGenes& genes, v1::FreeGeneList& message);

} // namespace evod::protocol
