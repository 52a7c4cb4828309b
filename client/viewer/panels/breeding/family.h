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
};

/// Computes the family of a descendant. Returns a family without genes if the lists in `descendant` are malformed.
Family family_of(const evod::v1::Descendant& descendant);

/// Returns the kind as text: "creep", "reset", "scale", "bit flip", "clamped".
const char* shown_mutation(evod::v1::MutationKind kind);
/// Returns a difference as text, with its sign and four significant digits: "+7.31", "−0.4".
std::string shown_delta(double delta);

} // namespace evod::viewer
