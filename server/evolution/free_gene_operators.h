// Free gene operators: initial values, crossover and mutation of free genes that have a list (free_genes.h). They
// follow the same parameters as the other genes, but every gene keeps to its own values.
//
// Determinism  the caller passes the stream. The number of words drawn depends on which genes change.
// Source       Davis 1985, "Applying adaptive algorithms to epistatic domains" (order crossover); Goldberg 1989,
//              Genetic Algorithms in Search, Optimization and Machine Learning, 5 (order crossover as written here).
#pragma once

#include "server/base/random.h"
#include "server/evolution/chance.h"
#include "server/evolution/chromosome.h"
#include "server/evolution/crossover.h"
#include "server/evolution/free_genes.h"
#include "server/evolution/mutation.h"
#include "server/evolution/order_mutation.h"

#include <optional>
#include <span>
#include <vector>

namespace evod::evolution {

class FreeGeneOperators {
  public:
    /// Without a list nothing is ever changed.
    explicit FreeGeneOperators(const Parameters& parameters);

    bool empty() const { return entries_.empty(); }

    /// Draws the slices of order crossover for a pair that is crossed: two different places of each permutation, every
    /// pair of places equally likely.
    void draw_slices(Mixture<>& mixture, base::RandomStream& random) const;

    /// Gives the listed genes of `child` their values after a crossover.
    ///
    /// permutation  order crossover: the slice of the nearer parent, then the other parent's elements that are not in
    ///              it, in their order, from behind the slice and around the end. The nearer parent is the second one
    ///              if the mask contains the permutation's first gene.
    /// choice       that of the parent that the mask states.
    /// number       blend and simulated_binary compute with positions (GeneValues), and the value nearest to the result
    ///              is taken; other methods copy.
    ///
    /// Without a slice for it, because the pair is not crossed, a permutation is copied from the nearer parent.
    void cross(ConstGenes first, ConstGenes second, const GeneMask<>& from_second, const Mixture<>& mixture,
               Genes child) const;

    /// Mutates the listed genes of mutate_group as ValueMutation describes, with these differences. A number with a
    /// step moves by at least one step when it creeps, and every value is equally likely when it is reset or drawn
    /// again. It is mirrored half a step beyond its bounds, so the uniform law stays the same. A choice creeps to any
    /// other choice. A logarithmic number creeps, is reset and is mirrored by its logarithm. Permutations do not
    /// change.
    ///
    /// change(gene, kind, value)  must set a gene.
    /// returns  the number of genes that left their bounds.
    template <class Change>
    unsigned mutate(ConstGenes genes, base::RandomStream& random, const Change& change) const;

    /// Applies an order mutation to each permutation, each with probability rearrange_chance. Returns whether it did.
    template <class T>
    bool rearrange(const OrderMutation& by, std::span<T> items, base::RandomStream& random) const;

    /// Draws values for one chromosome: every value is equally likely, a logarithmic number by its logarithm, and every
    /// order of a permutation.
    void draw(Genes genes, base::RandomStream& random) const;
    /// Replaces the numbers and choices of an island's first generation by a Latin hypercube: with n organisms, each
    /// n-th part of a gene's range contains the gene of exactly one organism.
    void fill_latin_hypercube(GeneMatrix& genes, const base::RandomKey& key) const;

    /// Returns the listed gene (its index in a chromosome) with a value that its entry does not allow; nullopt if there
    /// is none. The genes of a permutation must contain each number once.
    std::optional<unsigned> first_fault(ConstGenes genes) const;

  private:
    struct Entry {
        FreeGene::Kind kind;
        GeneValues values;
        unsigned first, count; // genes
    };
    double crept(const Entry& entry, double position, base::RandomStream& random) const;
    double redrawn(const Entry& entry, base::RandomStream& random) const;

    std::vector<Entry> entries_;
    bool mutates_; // mutate_group contains the free genes
    Creep creep_;
    double share_, spread_index_, scale_range_, crossover_index_;
    Chance creep_chance_, reset_chance_, scale_chance_, bit_flip_chance_;
    unsigned bits_;
    OutOfBounds out_of_bounds_;
};

} // namespace evod::evolution
