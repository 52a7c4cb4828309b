// Crossover: mixes the genes of two parents into two children.
//
// Every method draws one mask per pair: the genes that the first child inherits from the second parent. The second
// child has the complementary mask, so no gene of either parent is lost.
// Source  De Jong 1975 and Eshelman, Caruana & Schaffer 1989 (cut points); Syswerda 1989, "Uniform crossover in genetic
//         algorithms".
#pragma once

#include "server/base/random.h"
#include "server/evolution/chance.h"
#include "server/evolution/chromosome.h"
#include "server/evolution/parameters.h"

#include <array>
#include <cstdint>
#include <optional>

namespace evod::evolution {

/// A set of genes: bit g is 1 if gene g is in the set.
using GeneMask = std::uint32_t;

constexpr GeneMask all_genes = (1u << gene_count) - 1;

/// Returns the mask for a set of cuts. At every cut, inheritance changes to the other parent. Bit c of `cuts` (c = 1 …
/// gene_count − 1) is a cut before gene c.
GeneMask mask_of_cuts(GeneMask cuts);

class Crossover {
  public:
    explicit Crossover(const Parameters& parameters);

    /// Draws the mask of one pair, with probability crossover_chance. Otherwise returns nullopt: the children are
    /// copies of their parents.
    ///
    /// uniform       each of the 64 masks is equally likely.
    /// single_point  each of the 5 interior cuts is equally likely.
    /// multi_point   each set of crossover_cuts different interior cuts is equally likely.
    /// none          always nullopt.
    std::optional<GeneMask> draw(base::RandomStream& random) const;

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

} // namespace evod::evolution
