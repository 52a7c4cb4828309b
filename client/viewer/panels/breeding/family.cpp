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
    if (count == 0 || (!alone && descendant.second_genes_size() != count) || (alone && descendant.from_second() != 0) ||
        (ordered && descendant.order_mutation().order_size() != count)) {
        return family;
    }
    const auto from_second = [&](int gene) {
        const int more = gene / 32 - 1;
        const std::uint32_t word = more < 0                                    ? descendant.from_second()
                                   : more < descendant.more_from_second_size() ? descendant.more_from_second(more)
                                                                               : 0;
        return (word >> (gene % 32) & 1) != 0;
    };
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

std::vector<GeneBlock> gene_blocks(const std::vector<std::string>& names, std::size_t first) {
    constexpr std::size_t unnamed_max = 16;
    std::vector<GeneBlock> blocks;
    for (std::size_t gene = first; gene < names.size(); ++gene) {
        const std::size_t cut = names[gene].find('<');
        const std::string neuron = cut == std::string::npos ? "" : names[gene].substr(0, cut);
        const bool same =
            !blocks.empty() && (neuron.empty() ? blocks.back().neuron.empty() && blocks.back().count < unnamed_max
                                               : blocks.back().neuron == neuron);
        if (same) {
            ++blocks.back().count;
        } else {
            blocks.push_back({neuron.empty() ? names[gene] : neuron, neuron, gene, 1});
        }
    }
    return blocks;
}

std::string gene_text(const Family& family, std::size_t gene, const std::string& name,
                      const evod::v1::Descendant& descendant) {
    const GeneOrigin& origin = family.arranged[gene];
    std::string text =
        name + ": " +
        (origin.blended ? print("%.4g, a mean of both parents", double{origin.value})
                        : print("%.4g of parent %u", double{origin.value},
                                origin.from_second ? descendant.second_parent() : descendant.first_parent()));
    for (const GeneChange& change : family.changes) {
        if (change.gene == gene) {
            text += print(", %s to %.4g", shown_mutation(change.kind), double{change.after});
        }
    }
    return text;
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
