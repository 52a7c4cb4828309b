#include "client/viewer/panels/breeding/family.h"

#include "client/viewer/text/numbers.h"

#include <cmath>

namespace evod::viewer {

Family family_of(const evod::v1::Descendant& descendant) {
    Family family;
    const int count = descendant.first_genes_size();
    // The only parent of a survivor is the survivor itself.
    const bool alone = descendant.second_genes_size() == 0;
    const bool ordered = descendant.has_order_mutation();
    if (count == 0 || count > 32 || (!alone && descendant.second_genes_size() != count) ||
        (alone && descendant.from_second() != 0) || (ordered && descendant.order_mutation().order_size() != count)) {
        return family;
    }
    const auto from_second = [&](int gene) { return (descendant.from_second() >> gene & 1) != 0; };
    for (int gene = 0; gene < count; ++gene) {
        if (!alone && descendant.second_share() > 0) {
            const double first = double{descendant.first_genes(gene)}, second = double{descendant.second_genes(gene)};
            family.crossed.push_back({static_cast<float>(first + descendant.second_share() * (second - first)), false,
                                      true, static_cast<std::uint32_t>(gene)});
            continue;
        }
        const bool second = from_second(gene);
        family.crossed.push_back({second ? descendant.second_genes(gene) : descendant.first_genes(gene), second, false,
                                  static_cast<std::uint32_t>(gene)});
        if (gene > 0 && second != from_second(gene - 1)) {
            family.cuts.push_back(static_cast<std::uint32_t>(gene));
        }
    }
    family.arranged = family.crossed;
    for (int gene = 0; ordered && gene < count; ++gene) {
        const std::uint32_t from = descendant.order_mutation().order(gene);
        if (from >= static_cast<std::uint32_t>(count)) {
            return {};
        }
        family.arranged[static_cast<std::size_t>(gene)] = family.crossed[from];
        if (from != static_cast<std::uint32_t>(gene)) {
            family.moves.push_back({from, static_cast<std::uint32_t>(gene)});
        }
    }
    for (const GeneOrigin& gene : family.arranged) {
        family.genes.push_back(gene.value);
    }
    for (const evod::v1::Mutation& mutation : descendant.mutations()) {
        if (mutation.gene() >= static_cast<std::uint32_t>(count)) {
            return {};
        }
        family.changes.push_back({mutation.kind(), mutation.gene(), mutation.before(), mutation.after()});
        family.genes[mutation.gene()] = mutation.after();
    }
    return family;
}

const char* shown_mutation(evod::v1::MutationKind kind) {
    switch (kind) {
    case evod::v1::MUTATION_KIND_CREEP:
        return "creep";
    case evod::v1::MUTATION_KIND_RESET:
        return "reset";
    case evod::v1::MUTATION_KIND_SCALE:
        return "scale";
    case evod::v1::MUTATION_KIND_BIT_FLIP:
        return "bit flip";
    case evod::v1::MUTATION_KIND_CLAMP:
        return "clamped";
    default:
        return "mutation";
    }
}

std::string shown_delta(double delta) {
    return print("%s%.4g", delta < 0 ? "−" : "+", std::abs(delta));
}

} // namespace evod::viewer
