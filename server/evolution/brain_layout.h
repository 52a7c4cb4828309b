// Brain layout: the genes that are the weights of a brain.
#pragma once

#include "server/evolution/parameters.h"

#include <string>
#include <vector>

namespace evod::evolution {

/// The weights of a brain as genes.
struct BrainGenes {
    unsigned count = 0; // 0: organisms have no brain
    double limit = 0;   // weights stay in [−limit, limit]
    double initial = 0; // weights of the first generation are uniform in [−initial, initial]
};

/// Returns no genes: organisms have no brain.
inline BrainGenes brain_genes(const Parameters&) {
    return {};
}

/// Returns the names of the weights, in chromosome order.
inline std::vector<std::string> brain_gene_names(const Parameters&) {
    return {};
}

} // namespace evod::evolution
