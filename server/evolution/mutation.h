// Value mutation: creep, random reset, scaling and bit flip give genes new values. Genes that leave their bounds are
// brought back.
//
// Determinism  the caller passes one stream per chromosome. The number of words drawn depends on which genes mutate.
// Source       Eiben & Smith 2015, Introduction to Evolutionary Computing, 4.3.1 (bit flip), 4.4.1 (creep, random
//              reset); Deb & Agrawal 1999, "A niched-penalty approach for constraint handling in genetic
//              algorithms" (polynomial creep).
#pragma once

#include "server/base/random.h"
#include "server/evolution/chance.h"
#include "server/evolution/chromosome.h"
#include "server/evolution/ga_parameters.h"
#include "server/evolution/gene_mask.h"
#include "server/evolution/rare_events.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace evod::evolution {

/// A gene as a fixed-point binary code of `bits` digits: all 0 at the lower bound, all 1 at the upper bound. It is not
/// a Gray code, so neighbouring values can differ in all digits.
struct BinaryView {
    float min, max;
    unsigned bits; // 1 … 24

    /// Returns the code nearest to a value within the bounds; 0 if the bounds are equal.
    std::uint32_t to_code(float value) const;
    float to_value(std::uint32_t code) const;
};

/// Draws the factor of a step: uniform in (−1, 1), or standard normal. `creep` is not Polynomial.
double creep_unit(Creep creep, base::RandomStream& random);
/// Returns a value that polynomial creep gives to a gene; ValueMutation::apply() has the law.
double polynomial_creep(double value, double min, double max, double index, base::RandomStream& random);
/// Returns the mirror image of a value at its bounds, mirrored repeatedly until it is within them.
double reflected(double value, double min, double max);

enum class ChangeKind { Creep, Reset, Scale, BitFlip, Clamp, Reflect, Redraw };

/// One change of a gene.
struct GeneChange {
    unsigned gene = 0;
    ChangeKind kind = ChangeKind::Creep;
    float before = 0, after = 0;
    friend bool operator==(const GeneChange&, const GeneChange&) = default;
};

/// Sets a gene without recording it.
struct SetGene {
    Genes genes;
    void operator()(unsigned gene, ChangeKind, float value) const { genes[gene] = value; }
};
/// Sets a gene and records the change.
struct RecordGene {
    Genes genes;
    std::vector<GeneChange>& changes;
    void operator()(unsigned gene, ChangeKind kind, float value) const {
        changes.push_back({gene, kind, genes[gene], value});
        genes[gene] = value;
    }
};

/// Works like clamp() in chromosome.h, and also appends the genes that it moved to `changes`.
unsigned clamp(Genes genes, const GeneBounds& bounds, std::vector<GeneChange>& changes);

template <std::size_t extent = std::dynamic_extent>
class ValueMutation {
  public:
    explicit ValueMutation(const Parameters& parameters);

    /// Mutates one chromosome, in this order. Only the genes of mutate_group change, except that all genes are brought
    /// back into their bounds.
    ///
    /// creep     adds step · U to each gene with probability mutation_chance; U is uniform in (−1, 1) or standard
    ///           normal, and the step is mutation_step, brain_mutation_step or free_mutation_step. Polynomial creep
    ///           instead adds d · (max − min), where |d| has the density ½ (n + 1) (1 − |d|)^n with n =
    ///           mutation_spread_index, on each side cut off at the bound.
    /// reset     replaces each gene with probability reset_chance by a value uniform within its bounds.
    /// scale     with probability scale_chance, multiplies one gene by 1 + scale_range · U; U is uniform in (−1, 1).
    ///           Each gene is equally likely. Draws the chance, the gene and one word.
    /// bounds    brings each gene that is outside its bounds back, and counts it: to the nearer bound, to its mirror
    ///           image at the bound (repeatedly if need be), or to a uniform value within the bounds, as out_of_bounds
    ///           states.
    /// bit flip  flips each bit of each gene's BinaryView with probability bit_flip_chance. A gene without a flipped
    ///           bit keeps its exact value. A gene with one gets the value of its new code.
    ///
    /// returns  the number of genes that were outside their bounds.
    unsigned apply(std::span<float, extent> genes, base::RandomStream& random) const;
    /// Mutates one chromosome, and also appends the changes to `changes`, in order.
    unsigned apply(std::span<float, extent> genes, base::RandomStream& random, std::vector<GeneChange>& changes) const
        requires(extent == std::dynamic_extent);

  private:
    /// Mutates a chromosome. change(gene, kind, value) must set a gene.
    template <class Change, class Clamp>
    unsigned mutate(std::span<const float, extent> genes, base::RandomStream& random, const Change& change,
                    const Clamp& clamp_all) const;
    /// Brings the genes back into their bounds by reflecting or redrawing them. Returns how many were outside.
    template <class Change>
    unsigned bring_back(std::span<const float, extent> genes, base::RandomStream& random, const Change& change) const;
    float crept(float value, unsigned gene, base::RandomStream& random) const;
    std::optional<GeneChange> draw_scale(std::span<const float, extent> genes, base::RandomStream& random) const;
    template <class Change>
    void flip_bits(std::span<const float, extent> genes, GeneRange block, base::RandomStream& random,
                   const Change& change) const;

    /// The genes that mutate.
    constexpr GeneRange range() const {
        if constexpr (extent == std::dynamic_extent) {
            return range_;
        } else {
            return {0, extent};
        }
    }

    GeneRange range_;
    GeneBounds bounds_;
    Creep creep_;
    Chance creep_chance_;
    PerGene<double, extent> steps_{};
    double spread_index_; // of polynomial creep
    Chance reset_chance_;
    Chance scale_chance_;
    double scale_range_;
    Chance bit_flip_chance_;
    unsigned bits_;
    OutOfBounds out_of_bounds_;
    std::optional<RareEvents> rare_flips_; // over the bits of a block of genes, if flips are rare
};

} // namespace evod::evolution
