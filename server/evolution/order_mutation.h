// Order mutation: exchanges the values of genes inside a chromosome. It creates no new values, and it is off by
// default.
//
// Source  Eiben & Smith 2015, Introduction to Evolutionary Computing, 4.5.1 (swap, scramble, inversion).
#pragma once

#include "server/base/random.h"
#include "server/evolution/chance.h"
#include "server/evolution/chromosome.h"
#include "server/evolution/ga_parameters.h"

#include <cstdint>
#include <span>

namespace evod::evolution {

/// Two different genes and those between them.
struct Slice {
    unsigned first, last; // first < last, both included
};
/// Draws two of `gene_count` >= 2 genes; every pair is equally likely.
Slice draw_slice(unsigned gene_count, base::RandomStream& random);

class OrderMutation {
  public:
    explicit OrderMutation(const Parameters& parameters);

    /// Mutates with probability rearrange_chance. Only the genes of mutate_group take part; if there is only one,
    /// nothing happens. A pair or slice is given by two different indices; every choice of them is equally likely.
    ///
    /// swap       the two genes of a pair exchange values; with probability 1/2 so do those of a second pair, which may
    ///            be the same pair.
    /// scramble   the genes of a slice, both ends included, are shuffled; every order is equally likely, the present
    ///            one too. If there are six genes and all differ, nothing changes with probability 2383/10800.
    /// inversion  the genes of a slice, both ends included, are reversed.
    ///
    /// Genes may be out of their bounds afterwards, because each gene has its own bounds.
    ///
    /// items    one element per gene of the chromosome: the values of the genes, or anything that moves with them.
    /// returns  whether the operation was applied (probability rearrange_chance).
    template <class T, std::size_t extent>
    bool apply(std::span<T, extent> items, base::RandomStream& random) const;

    /// Mutates all of these items, with probability rearrange_chance.
    template <class T, std::size_t extent>
    bool apply_to(std::span<T, extent> items, base::RandomStream& random) const;

    bool is_off() const { return method_ == OrderMutationMethod::None || chance_.is_never(); }

  private:
    OrderMutationMethod method_;
    Chance chance_;
    GeneRange range_;
};

} // namespace evod::evolution
