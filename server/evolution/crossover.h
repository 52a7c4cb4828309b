// Crossover: mixes the genes of two parents into two children.
//
// Every method except blend draws one mask per pair: the genes that the first child inherits from the second parent. The
// second child has the complementary mask, so no gene of either parent is lost. Blend draws one weight per pair: every
// gene of the first child is a weighted mean of the parents' genes, and the second child has the complementary weights.
// Source  De Jong 1975 and Eshelman, Caruana & Schaffer 1989 (cut points); Syswerda 1989, "Uniform crossover in genetic
//         algorithms"; Michalewicz 1996, "Genetic Algorithms + Data Structures = Evolution Programs" (arithmetic
//         crossover).
#pragma once

#include "server/base/random.h"
#include "server/evolution/chance.h"
#include "server/evolution/chromosome.h"
#include "server/evolution/parameters.h"

#include <array>
#include <cstdint>

namespace evod::evolution {

/// A set of genes: bit g is 1 if gene g is in the set.
using GeneMask = std::uint32_t;

constexpr GeneMask all_genes = (1u << gene_count) - 1;

/// How the genes of a pair are mixed into its first child. The default is a copy of the first parent. The second child
/// has the complement of the mask and the same share.
struct Mixture {
    GeneMask from_second = 0; // the genes of which the second parent gives all or, with blend, the larger share
    double second_share = 0;  // blend: the smaller of the two parents' weights, in (0, ½); other methods: 0
};

/// Returns the mask for a set of cuts. At every cut, inheritance changes to the other parent. Bit c of `cuts` (c = 1 …
/// gene_count − 1) is a cut before gene c.
GeneMask mask_of_cuts(GeneMask cuts);

class Crossover {
  public:
    explicit Crossover(const Parameters& parameters);

    /// Draws the mixture of one pair and returns true, with probability crossover_chance. Otherwise returns false and
    /// does not change `mixture`: the children are copies of their parents.
    ///
    /// uniform       each of the 64 masks is equally likely.
    /// single_point  each of the 5 interior cuts is equally likely.
    /// multi_point   each set of crossover_cuts different interior cuts is equally likely.
    /// blend         the weight of the second parent is (k + ½)/2^32, where each of the 2^32 values of k is equally
    ///               likely; draws one word. The weight is never ½, and 1 − weight is exact. The mask contains all genes
    ///               if the weight is above ½, otherwise none.
    /// none          always false.
    bool draw(Mixture& mixture, base::RandomStream& random) const;

  private:
    CrossoverMethod method_;
    Chance chance_;
    std::array<GeneMask, 10> masks_{}; // the masks to choose from
    std::uint32_t mask_count_ = 0;
};

/// Gives `child` the genes of `second` where the mask has a 1, and the genes of `first` where it has a 0.
inline void cross(ConstGenes first, ConstGenes second, GeneMask mask, Genes child) {
    for (unsigned gene = 0; gene < gene_count; ++gene) {
        child[gene] = (mask >> gene & 1) != 0 ? second[gene] : first[gene];
    }
}

/// Gives every gene of `child` the value first + second_share · (second − first), computed in double and rounded to
/// float. The result is between the parents' genes, ends included. If the parents of the other child are given in the
/// opposite order and with the same share, the sum of the children's genes differs from that of the parents by rounding
/// alone: by at most 2^-23 of the larger absolute value of the two genes.
///
/// second_share  in (0, ½].
void blend(ConstGenes first, ConstGenes second, double second_share, Genes child);

} // namespace evod::evolution
