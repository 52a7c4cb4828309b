#include "client/viewer/world/gene_groups.h"

#include <algorithm>

namespace evod::viewer {

GeneRange genes_of(const GeneGroups& groups, evod::v1::GeneGroup group) {
    const auto first = std::ranges::find(groups, group);
    return {static_cast<std::size_t>(first - groups.begin()),
            static_cast<std::size_t>(std::ranges::count(groups, group))};
}

} // namespace evod::viewer
