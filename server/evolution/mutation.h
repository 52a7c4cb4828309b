// Value-making mutation: creep, random reset and bit flip give genes new values; then the bounds hold.
//
// Determinism  the caller hands one stream per chromosome; how much of it is used depends on what mutates.
// Source       Eiben & Smith 2015, Introduction to Evolutionary Computing, 4.3.1 (bit flip), 4.4.1 (creep, random
// reset).
#pragma once

#include "server/base/random.h"
#include "server/evolution/chance.h"
#include "server/evolution/chromosome.h"
#include "server/evolution/parameters.h"
#include "server/evolution/rare_events.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace evod::evolution {

/// The fixed-point binary view of a gene: `bits` plain binary digits (no Gray code, so neighbours can differ in all of
/// them), all 0 at the lower bound and all 1 at the upper.
struct BinaryView {
    float min, max;
    unsigned bits; // 1 … 24

    /// The nearest code to a value within the bounds; 0 if the bounds are equal.
    std::uint32_t to_code(float value) const;
    float to_value(std::uint32_t code) const;
};

enum class ChangeKind { Creep, Reset, BitFlip, Clamp };

/// What happened to a gene.
struct GeneChange {
    unsigned gene = 0;
    ChangeKind kind = ChangeKind::Creep;
    float before = 0, after = 0;
    friend bool operator==(const GeneChange&, const GeneChange&) = default;
};

/// clamp(), and says which genes were put onto a bound.
unsigned clamp(Genes genes, const GeneBounds& bounds, std::vector<GeneChange>& changes);

class ValueMutation {
  public:
    explicit ValueMutation(const Parameters& parameters);

    /// Mutates one chromosome, in this order:
    ///
    /// creep     each gene with probability mutation_chance: + mutation_step · U, U uniform in (−1, 1) or standard
    ///           normal.
    /// reset     each gene with probability reset_chance: uniform within its bounds.
    /// bounds    a gene outside is put onto the nearer one, and counted.
    /// bit flip  each bit of each gene's BinaryView with probability bit_flip_chance. A gene none of whose bits flips
    /// is
    ///           not touched; one that is touched is also rounded to a value that has a code.
    ///
    /// returns  how many genes were clamped.
    unsigned apply(Genes genes, base::RandomStream& random) const;
    /// The same, and adds what happened, in order.
    unsigned apply(Genes genes, base::RandomStream& random, std::vector<GeneChange>& changes) const;

  private:
    /// change(gene, kind, value)  gives a gene a value.
    template <class Change, class Clamp>
    unsigned mutate(ConstGenes genes, base::RandomStream& random, const Change& change, const Clamp& clamp_all) const;
    template <class Change>
    void flip_bits(ConstGenes genes, base::RandomStream& random, const Change& change) const;

    GeneBounds bounds_;
    Creep creep_;
    Chance creep_chance_;
    double step_;
    Chance reset_chance_;
    Chance bit_flip_chance_;
    unsigned bits_;
    std::optional<RareEvents> rare_flips_; // of the bits of a chromosome, where flips are rare
};

} // namespace evod::evolution
