// Family: how crossover, order mutation, mutations and bounds turned the genes of the parents into those of a
// descendant.
//
// Owner        none: a value.
// Threads      none.
#pragma once

#include "evod/v1/commands.pb.h"

#include <cstdint>
#include <string>
#include <vector>

namespace evod::viewer {

struct GeneOrigin {
    float value = 0;
    bool from_second = false; // false: from the first parent, or blended from both parents
    bool blended = false;     // a weighted mean of the genes of both parents
    std::uint32_t gene = 0;   // index of the gene in that parent
};

/// A change of one gene, caused by a mutation or by clamping to its bounds.
struct GeneChange {
    evod::v1::MutationKind kind = evod::v1::MUTATION_KIND_UNSPECIFIED;
    std::uint32_t gene = 0;
    float before = 0, after = 0;
    double delta() const { return double{after} - double{before}; }
};

/// A gene value that the order mutation moved to another position of the chromosome.
struct GeneMove {
    std::uint32_t from = 0, to = 0;
    friend bool operator==(const GeneMove&, const GeneMove&) = default;
};

struct Family {
    std::vector<std::uint32_t> cuts;  // after gene g - 1, the child takes its genes from the other parent
    std::vector<GeneOrigin> crossed;  // by gene, after the crossover
    std::vector<GeneMove> moves;      // by the order mutation; genes that stayed are not included
    std::vector<GeneOrigin> arranged; // by gene, after the order mutation
    std::vector<GeneChange> changes;  // in the order in which they happened
    std::vector<float> genes;         // after all changes; computed here, not received

    /// Returns for each gene whether it was changed.
    std::vector<bool> changed() const {
        std::vector<bool> is_changed(genes.size());
        for (const GeneChange& change : changes) {
            is_changed[change.gene] = true;
        }
        return is_changed;
    }
};

/// Computes the family of a descendant. Returns a family without genes if the lists in `descendant` are malformed.
Family family_of(const evod::v1::Descendant& descendant);

/// Neighbouring genes of a long chromosome that are drawn side by side: the weights of one neuron, or a few genes that are
/// no weights.
struct GeneBlock {
    std::string label;  // the neuron, or the first gene
    std::string neuron; // empty: the genes are no weights
    std::size_t first = 0, count = 0;
    friend bool operator==(const GeneBlock&, const GeneBlock&) = default;
};
/// Divides the genes from `first` on into blocks.
std::vector<GeneBlock> gene_blocks(const std::vector<std::string>& names, std::size_t first);

/// Describes where a gene comes from: "hidden3<bias: 0.42 of parent 12, creep to 0.5".
std::string gene_text(const Family& family, std::size_t gene, const std::string& name,
                      const evod::v1::Descendant& descendant);

/// Returns the kind as text: "creep", "reset", "scale", "bit flip", "clamped".
const char* shown_mutation(evod::v1::MutationKind kind);
/// Returns a difference as text, with its sign and four significant digits: "+7.31", "−0.4".
std::string shown_delta(double delta);

} // namespace evod::viewer
