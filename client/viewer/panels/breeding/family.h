// Family: how a descendant's genes were made from its parents' genes: crossover, order mutation, mutations, bounds.
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
    bool from_second = false; // parent
    std::uint32_t gene = 0;   // of the parent
};

/// A change of one gene by a mutation or by its bound.
struct GeneChange {
    evod::v1::MutationKind kind = evod::v1::MUTATION_KIND_UNSPECIFIED;
    std::uint32_t gene = 0;
    float before = 0, after = 0;
    double delta() const { return double{after} - double{before}; }
};

/// A gene value that the order mutation moved to another place of the chromosome.
struct GeneMove {
    std::uint32_t from = 0, to = 0;
    friend bool operator==(const GeneMove&, const GeneMove&) = default;
};

struct Family {
    std::vector<std::uint32_t> cuts;  // g: between gene g - 1 and gene g the child changes from one parent to the other
    std::vector<GeneOrigin> crossed;  // after the crossover
    std::vector<GeneMove> moves;      // of the order mutation, without the genes that stayed
    std::vector<GeneOrigin> arranged; // after the order mutation
    std::vector<GeneChange> changes;  // in the order in which they happened
    std::vector<float> genes;         // after the changes, computed here
};

/// Returns a family without genes if the lists of the descendant are malformed.
Family family_of(const evod::v1::Descendant& descendant);

/// "creep", "reset", "bit flip", "clamped".
const char* shown_mutation(evod::v1::MutationKind kind);
/// "+7.31", "−0.4": always with a sign, four significant digits.
std::string shown_delta(double delta);

} // namespace evod::viewer
