// Crossover: mixes the genes of two parents into two children.
//
// Every method except blend draws one mask per pair: the genes that the first child inherits from the second parent.
// The second child has the complementary mask, so no gene of either parent is lost. Blend draws one weight per pair:
// every gene of the first child is a weighted mean of the parents' genes, and the second child has the complementary
// weights. Simulated binary crossover draws one word per gene.
// Source  De Jong 1975 and Eshelman, Caruana & Schaffer 1989 (cut points); Syswerda 1989, "Uniform crossover in genetic
//         algorithms"; Michalewicz 1996, "Genetic Algorithms + Data Structures = Evolution Programs" (arithmetic
//         crossover); Deb & Agrawal 1995, "Simulated binary crossover for continuous search space".
#pragma once

#include "server/base/random.h"
#include "server/evolution/chance.h"
#include "server/evolution/chromosome.h"
#include "server/evolution/ga_parameters.h"
#include "server/evolution/gene_mask.h"
#include "server/evolution/order_mutation.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

namespace evod::evolution {

/// How the genes of a pair are mixed into its first child. A new object describes a copy of the first parent. The
/// second child has the complement of the mask and the same share.
template <std::size_t extent = std::dynamic_extent>
struct Mixture {
    explicit Mixture(unsigned gene_count) : from_second{gene_count} {}

    GeneMask<extent> from_second; // the genes of which the second parent gives all or, with blend, the larger share
    double second_share = 0;      // blend: the smaller of the two parents' weights, in (0, ½); other methods: 0
    // simulated_binary: the word of each gene, of which spread() makes the values of both children
    std::optional<PerGene<std::uint32_t, extent>> spreads;
    // order crossover: the slice of each permutation in the list of free genes; empty without crossover
    std::conditional_t<extent == std::dynamic_extent, std::vector<Slice>, std::array<Slice, 0>> slices;
};

template <std::size_t extent = std::dynamic_extent>
class Crossover {
  public:
    /// gene_count  the number of genes of a chromosome, at least 2.
    Crossover(const Parameters& parameters, unsigned gene_count);

    /// Draws the mixture of one pair and returns true, with probability crossover_chance. Otherwise returns false and
    /// does not change `mixture`, which must be new: the children are copies of their parents.
    ///
    /// uniform       each of the 2^gene_count masks is equally likely.
    /// single_point  each of the gene_count − 1 interior cuts is equally likely.
    /// multi_point   each set of crossover_cuts different interior cuts is equally likely.
    /// blend         the weight of the second parent is (k + ½)/2^32, where each of the 2^32 values of k is equally
    ///               likely; draws one word. The weight is never ½, and 1 − weight is exact. The mask contains all
    ///               genes if the weight is above ½, otherwise none.
    /// simulated_binary  draws one word per gene. With probability ½ the gene is spread; a gene that is spread comes
    ///               from the second parent with probability ½. Other genes stay with their parents.
    /// none          always false.
    bool draw(Mixture<extent>& mixture, base::RandomStream& random) const;

    /// Returns the mask of one of the sets of cuts; `index` is below the number of sets. At every cut, inheritance
    /// changes to the other parent.
    GeneMask<extent> mask_of_cuts(std::uint64_t index) const;

  private:
    CrossoverMethod method_;
    Chance chance_;
    GeneCount<extent> gene_count_;
    unsigned cut_count_;
    std::uint64_t cut_set_count_ = 0;
    std::vector<GeneMask<extent>> masks_; // of all sets of cuts, if they are few
};

/// Gives `child` the genes of `second` that are in the mask, and the other genes of `first`.
template <std::size_t extent>
void cross(std::span<const float, extent> first, std::span<const float, extent> second, const GeneMask<extent>& mask,
           std::span<float, extent> child) {
    for (unsigned gene = 0; gene < child.size(); ++gene) {
        child[gene] = mask.contains(gene) ? second[gene] : first[gene];
    }
}

/// Gives every gene of `child` the value first + second_share · (second − first), computed in double and rounded to
/// float. The result is between the parents' genes, ends included. If the parents of the other child are given in the
/// opposite order and with the same share, the sum of the children's genes differs from that of the parents by rounding
/// alone: by at most 2^-23 of the larger absolute value of the two genes.
///
/// second_share  in (0, ½].
template <std::size_t extent>
void blend(std::span<const float, extent> first, std::span<const float, extent> second, double second_share,
           std::span<float, extent> child);

/// Returns the position of a child's gene under simulated binary crossover, as spread() computes it. `near` is the gene
/// of the parent that the child takes after, within the bounds min and max.
double spread_position(double near, double far, std::uint32_t word, double min, double max, double index);

/// Order crossover of two permutations of 0 … n − 1: `child` gets the slice of `near`, and then, from behind the slice
/// and around the end, the other elements in the order in which `far` has them from there on.
void cross_order(ConstGenes near, ConstGenes far, Slice slice, Genes child);

/// Gives every gene of `child` the value that simulated binary crossover makes of the parents' genes. The child takes
/// gene g after the second parent if `from_second` contains it, otherwise after the first one. A gene that is not
/// spread, or is equal in both parents, is copied. Otherwise the value is m ± β (b − a) / 2 with the mean m of the
/// parents' genes a < b, on the side of the parent that it is taken after. Without bounds, β ≤ 1 has the density
/// ½ (index + 1) β^index, and β > 1 the density ½ (index + 1) β^−(index + 2). The distribution is cut off at the bound,
/// so the value never leaves the bounds; parents outside the bounds count as if they were at the bound.
/// Source  Deb & Agrawal 1995, and for the bounds Deb & Agrawal 1999, "A niched-penalty approach for constraint
///         handling in genetic algorithms".
///
/// words  Mixture::spreads, the same for both children.
/// index  crossover_spread_index.
template <std::size_t extent>
void spread(std::span<const float, extent> first, std::span<const float, extent> second,
            const GeneMask<extent>& from_second, const PerGene<std::uint32_t, extent>& words, const GeneBounds& bounds,
            double index, std::span<float, extent> child);

} // namespace evod::evolution
