// Family: how the genes of a descendant came about, step by step, from what its parents had.
//
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

/// What a value-making mutation, or a bound, made of a gene.
struct GeneChange {
    evod::v1::MutationKind kind = evod::v1::MUTATION_KIND_UNSPECIFIED;
    std::uint32_t gene = 0;
    float before = 0, after = 0;
    double delta() const { return double{after} - double{before}; }
};

/// A gene's value that went elsewhere in the chromosome.
struct GeneMove {
    std::uint32_t from = 0, to = 0;
    friend bool operator==(const GeneMove&, const GeneMove&) = default;
};

struct Family {
    std::vector<std::uint32_t> cuts;  // g: between gene g - 1 and gene g the child changes from one parent to the other
    std::vector<GeneOrigin> crossed;  // after the crossover
    std::vector<GeneMove> moves;      // of the permutation mutation; genes that stayed are not among them
    std::vector<GeneOrigin> arranged; // after it
    std::vector<GeneChange> changes;  // in the order in which they happened
    std::vector<float> genes;         // after them, worked out here
};

/// A descendant of malformed lists has a family without genes.
Family family_of(const evod::v1::Descendant& descendant);

/// "creep", "reset", "bit flip", "clamped".
const char* shown_mutation(evod::v1::MutationKind kind);
/// "+7.31", "−0.4": with the sign that it has, and as many digits as can be told apart.
std::string shown_delta(double delta);

} // namespace evod::viewer
