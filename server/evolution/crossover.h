// Crossover: mixes the genes of two parents into two children.
//
// Every method gives one mask: the genes that the first child takes from the second parent. The second child is the
// complement, so no gene of either parent is lost.
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

/// Bit g stands for gene g.
using GeneMask = std::uint32_t;

constexpr GeneMask all_genes = (1u << gene_count) - 1;

/// The mask for a set of cuts: the parent changes at every cut. Bit c of `cuts`, 1 … gene_count − 1, is a cut before
/// gene c.
GeneMask mask_of_cuts(GeneMask cuts);

class Crossover {
  public:
    explicit Crossover(const Parameters& parameters);

    /// Draws the mask of one pair. Returns nullopt, and the children are copies, unless an event of probability
    /// crossover_chance happens.
    ///
    /// uniform       each of the 64 masks is equally likely.
    /// single_point  each of the 5 interior cuts is equally likely.
    /// multi_point   each set of crossover_cuts different interior cuts is equally likely.
    /// none          always nullopt.
    std::optional<GeneMask> draw(base::RandomStream& random) const;

  private:
    CrossoverMethod method_;
    Chance chance_;
    std::array<GeneMask, 10> masks_{}; // the sets of cuts to choose from
    std::uint32_t mask_count_ = 0;
};

/// Gives `child` the genes of `second` where the mask has a 1, and the genes of `first` where it has a 0.
inline void cross(ConstGenes first, ConstGenes second, GeneMask mask, Genes child) {
    for (unsigned gene = 0; gene < gene_count; ++gene) {
        child[gene] = (mask >> gene & 1) != 0 ? second[gene] : first[gene];
    }
}

} // namespace evod::evolution
