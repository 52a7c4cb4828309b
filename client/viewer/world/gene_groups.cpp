#include "client/viewer/world/gene_groups.h"

#include <algorithm>

namespace evod::viewer {

GeneRange genes_of(const GeneGroups& groups, evod::v1::GeneGroup group) {
    const auto first = std::ranges::find(groups, group);
    return {static_cast<std::size_t>(first - groups.begin()),
            static_cast<std::size_t>(std::ranges::count(groups, group))};
}

std::vector<evod::v1::GeneGroup> distinct_groups(const GeneGroups& groups) {
    std::vector<evod::v1::GeneGroup> distinct;
    for (const evod::v1::GeneGroup group : groups) {
        if (std::ranges::find(distinct, group) == distinct.end()) {
            distinct.push_back(group);
        }
    }
    return distinct;
}

std::string_view name_of(evod::v1::GeneGroup group) {
    switch (group) {
    case evod::v1::GENE_GROUP_BODY:
        return "body";
    case evod::v1::GENE_GROUP_BRAIN:
        return "brain";
    default:
        return "free";
    }
}

} // namespace evod::viewer
