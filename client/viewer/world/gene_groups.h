// Gene groups: which genes of a world describe the body, which are weights of the brain, and which are free.
//
// Threads      none; plain data.
#pragma once

#include "evod/v1/world.pb.h"

#include <cstddef>
#include <vector>

namespace evod::viewer {

/// The group of each gene, in the order of the chromosome. The genes of a group are contiguous. Empty until known.
using GeneGroups = std::vector<evod::v1::GeneGroup>;

struct GeneRange {
    std::size_t first = 0, count = 0;
    bool contains(std::size_t gene) const { return gene >= first && gene - first < count; }
    friend bool operator==(const GeneRange&, const GeneRange&) = default;
};

/// Returns the genes of a group; an empty range if the chromosome has none.
GeneRange genes_of(const GeneGroups& groups, evod::v1::GeneGroup group);

} // namespace evod::viewer
