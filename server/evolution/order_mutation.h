// Order mutation: genes change places inside a chromosome. It makes no new values, and it is optional.
//
// Source  Eiben & Smith 2015, Introduction to Evolutionary Computing, 4.5.1 (swap, scramble, inversion).
#pragma once

#include "server/base/random.h"
#include "server/evolution/chance.h"
#include "server/evolution/chromosome.h"
#include "server/evolution/parameters.h"

#include <cstdint>
#include <span>

namespace evod::evolution {

/// Which gene's value each gene received.
using GeneOrder = std::span<std::uint32_t, gene_count>;

class OrderMutation {
  public:
    explicit OrderMutation(const Parameters& parameters);

    /// Mutates with probability rearrange_chance. Every slice or pair below has two different indices, each pair of
    /// indices equally likely.
    ///
    /// swap       two genes trade places; with probability 1/2 a second pair does too, which can be the same.
    /// scramble   the genes of a slice, both ends included, are put in an order drawn uniformly. It can be the present
    ///            order: with different genes that happens with probability 2383/10800.
    /// inversion  the genes of a slice, both ends included, are reversed.
    ///
    /// Genes may be out of their bounds afterwards, because each gene has bounds of its own.
    ///
    /// returns  whether the event happened.
    bool apply(Genes genes, base::RandomStream& random) const;
    /// Applies the same operation to gene numbers instead of genes.
    bool apply(GeneOrder order, base::RandomStream& random) const;

    bool is_off() const { return method_ == OrderMutationMethod::None || chance_.is_never(); }

  private:
    template <class T>
    bool mutate_order(std::span<T, gene_count> items, base::RandomStream& random) const;

    OrderMutationMethod method_;
    Chance chance_;
};

} // namespace evod::evolution
