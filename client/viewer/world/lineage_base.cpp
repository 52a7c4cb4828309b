#include "client/viewer/world/lineage_base.h"

#include <algorithm>
#include <numeric>
#include <span>

namespace evod::viewer {

namespace {

/// Whether one founder has nearly all organisms. The numbers of founders are less than `founder_count`, or
/// Lineage::none.
bool taken_over(std::span<const std::uint32_t> founders, std::size_t founder_count) {
    std::vector<std::uint32_t> sizes(founder_count);
    std::uint32_t most = 0;
    for (const std::uint32_t founder : founders) {
        if (founder != Lineage::none) {
            most = std::max(most, ++sizes[founder]);
        }
    }
    return most >= taken_over_share * static_cast<double>(founders.size());
}

/// Returns the ancestor of every organism of all islands, in the generation `since`.
std::vector<std::uint32_t> all_ancestors_of(const Lineage& lineage, std::uint64_t generation, std::uint64_t since) {
    std::vector<std::uint32_t> ancestors;
    for (std::uint32_t island = 0; island < lineage.at(generation).begins.size(); ++island) {
        const auto of_island = ancestors_of(lineage, generation, island, since);
        ancestors.insert(ancestors.end(), of_island.begin(), of_island.end());
    }
    return ancestors;
}

} // namespace

std::vector<std::uint64_t> lineage_bases(const Lineage& lineage, std::uint32_t island) {
    std::vector<std::uint64_t> bases;
    if (lineage.empty()) {
        return bases;
    }
    std::uint64_t since = lineage.first();
    std::vector<std::uint32_t> founders(lineage.at(since).organisms.size()), next; // of all organisms
    std::iota(founders.begin(), founders.end(), 0u);
    bases.push_back(since);
    for (std::uint64_t generation = since + 1; generation <= lineage.last(); ++generation) {
        next.clear();
        for (const Lineage::Organism& organism : lineage.at(generation).organisms) {
            const std::uint32_t parent = organism.parents[0];
            next.push_back(parent == Lineage::none ? Lineage::none : founders[parent]);
        }
        std::swap(founders, next);
        const auto [begin, count] = lineage.island_range(generation, island);
        const auto has_takeover = [&, begin = begin, count = count] {
            return taken_over(std::span{founders}.subspan(begin, count), lineage.at(since).organisms.size());
        };
        if (count > 0 && has_takeover()) {
            since = generation - std::min(generations_back, generation - lineage.first());
            founders = all_ancestors_of(lineage, generation, since);
            while (since < generation && has_takeover()) {
                founders = all_ancestors_of(lineage, generation, ++since);
            }
        }
        bases.push_back(since);
    }
    return bases;
}

} // namespace evod::viewer
