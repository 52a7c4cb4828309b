// The steps of breeding: they choose the organisms that survive and mate, and compute the genes of the next generation.
// next_generation() performs the steps for all organisms; record_breeding() repeats them for the organisms in its
// record.
//
// Threads      none of its own; several threads may use the same Descent object.
// Determinism  every draw is keyed, so the result of a step depends neither on the caller nor on the order of steps.
#pragma once

#include "server/base/assert.h"
#include "server/evolution/crossover.h"
#include "server/evolution/free_gene_operators.h"
#include "server/evolution/mutation.h"
#include "server/evolution/next_generation.h"
#include "server/evolution/order_mutation.h"
#include "server/evolution/ranking.h"
#include "server/evolution/selection.h"

#include <algorithm>
#include <span>

namespace evod::evolution {

/// The organisms that survive and the pairs that mate.
struct Choice {
    Places places;
    std::vector<std::uint32_t> picks; // the selection's picks, in the order in which they were made
    std::vector<Parents> pairs;       // two children each; the last pair may have room for only one

    /// Returns the surviving organism of each place: shape (places.survivors).
    std::span<const std::uint32_t> survivors() const { return picks_survive ? picks : others; }
    bool picks_survive = false;        // the survivors are the picks
    std::vector<std::uint32_t> others; // the survivors, unless they are the picks
};

/// Returns the number of organisms among which selection picks, of `present`: the best ones, or all.
std::uint32_t candidate_count(const Places& places, std::uint32_t present, const Parameters& parameters);

/// Returns the arguments of select(): the number of picks, and the pool to pick from. If Picks::wanted is 0, the caller
/// must not call select().
///
/// candidates  candidate_count().
Picks picks_for(const Places& places, std::uint32_t candidates, const Parameters& parameters);

/// Returns the key of the random draws, to be passed to select().
base::RandomKey selection_key(const BreedingKey& key);

Choice choose(Ranking& ranking, const Parameters& parameters, std::uint32_t wanted, const BreedingKey& key,
              base::Executor& executor);

/// Which parent each gene of a child comes from.
template <std::size_t extent>
struct Inheritance {
    Parents parents;              // first: the parent that gave more of the genes, or whose weight is larger
    GeneMask<extent> from_second; // the genes that parents.second gave; at most half of all genes
};

/// Orders the parents of one child by how many genes each gave it; on a tie the pair's first parent stays first.
///
/// mask  Mixture::from_second of the child.
template <std::size_t extent>
Inheritance<extent> inheritance_of(const Parents& pair, const GeneMask<extent>& mask) {
    Inheritance<extent> inheritance{pair, mask};
    if (2 * mask.count() > mask.gene_count()) {
        inheritance.parents = {pair.second, pair.first};
        inheritance.from_second.complement();
    }
    return inheritance;
}

/// Applies the mutations to a chromosome without recording them.
struct WithoutRecord {
    template <std::size_t extent>
    static void mutate_order(const OrderMutation& by, const FreeGeneOperators& listed, std::span<float, extent> genes,
                             base::RandomStream& random) {
        by.apply(genes, random);
        if constexpr (extent == std::dynamic_extent) {
            listed.rearrange(by, genes, random);
        }
    }
    template <std::size_t extent>
    static unsigned mutate(const ValueMutation<extent>& by, const FreeGeneOperators& listed,
                           std::span<float, extent> genes, base::RandomStream& random) {
        unsigned outside = by.apply(genes, random);
        if constexpr (extent == std::dynamic_extent) {
            outside += listed.mutate(genes, random, SetGene{genes});
        }
        return outside;
    }
    template <std::size_t extent>
    static unsigned clamp(std::span<float, extent> genes, const GeneBounds& bounds) {
        return evolution::clamp(genes, bounds);
    }
};

/// Computes the genes of survivors and of children.
template <std::size_t extent = std::dynamic_extent>
class Descent {
  public:
    /// present  the parents' generation; must outlive the Descent.
    Descent(const GeneMatrix& present, const Parameters& parameters, const BreedingKey& key)
        : present_{present}
        , survivor_key_{key.seed, base::Purpose::SurvivorMutation, key.island, key.generation}
        , crossover_key_{key.seed, base::Purpose::Crossover, key.island, key.generation}
        , order_mutation_key_{key.seed, base::Purpose::OrderMutation, key.island, key.generation}
        , mutation_key_{key.seed, base::Purpose::Mutation, key.island, key.generation}
        , crossover_{parameters, static_cast<unsigned>(present.rows())}
        , order_mutation_{parameters}
        , mutation_{parameters}
        , bounds_{gene_bounds(parameters)}
        , spread_index_{parameters.crossover_spread_index}
        , listed_{parameters} {
        EVOD_ASSERT(present.rows() == gene_count(parameters));
    }

    // The argument `by` of keep() and make_child() applies the mutations: WithoutRecord, or a class that records them.

    /// Writes the genes of a survivor to `genes`. `place` is its index in the next generation. Returns the number of
    /// clamped genes.
    template <class By>
    unsigned keep(std::uint32_t organism, std::uint32_t place, bool mutates, std::span<float, extent> genes,
                  By&& by) const {
        EVOD_ASSERT(organism < static_cast<std::size_t>(present_.cols()));
        std::ranges::copy(column<extent>(present_, organism), genes.begin());
        if (!mutates) {
            return by.clamp(genes, bounds_);
        }
        base::RandomStream order{survivor_key_, place, 0}, mutation{survivor_key_, place, 1};
        by.mutate_order(order_mutation_, listed_, genes, order);
        return by.mutate(mutation_, listed_, genes, mutation);
    }

    /// Draws the mixture of the children of a pair; `mixture` must be new. Returns false and does not change it if
    /// there is no crossover.
    bool draw_mixture(std::uint32_t pair_index, Mixture<extent>& mixture) const {
        base::RandomStream random{crossover_key_, pair_index};
        if (!crossover_.draw(mixture, random)) {
            return false;
        }
        if constexpr (extent == std::dynamic_extent) {
            listed_.draw_slices(mixture, random);
        }
        return true;
    }

    /// Writes the genes of a child to `child`. `mixture` is that of the pair, whose mask is not read; `place` is the
    /// child's index in the next generation. Returns the number of genes that were outside their bounds.
    template <class By>
    unsigned make_child(const Inheritance<extent>& of, const Mixture<extent>& mixture, std::uint32_t place,
                        std::span<float, extent> child, By&& by) const {
        cross(of, mixture, child);
        base::RandomStream order{order_mutation_key_, place}, mutation{mutation_key_, place};
        by.mutate_order(order_mutation_, listed_, child, order);
        return by.mutate(mutation_, listed_, child, mutation);
    }

    /// Writes the genes that a child has after the crossover, before all mutations.
    void cross(const Inheritance<extent>& of, const Mixture<extent>& mixture, std::span<float, extent> child) const {
        EVOD_ASSERT(of.parents.first < static_cast<std::size_t>(present_.cols()));
        EVOD_ASSERT(of.parents.second < static_cast<std::size_t>(present_.cols()));
        const auto first = column<extent>(present_, of.parents.first),
                   second = column<extent>(present_, of.parents.second);
        if (mixture.spreads) {
            spread(first, second, of.from_second, *mixture.spreads, bounds_, spread_index_, child);
        } else if (mixture.second_share > 0) {
            blend(first, second, mixture.second_share, child);
        } else {
            evolution::cross(first, second, of.from_second, child);
        }
        if constexpr (extent == std::dynamic_extent) {
            listed_.cross(first, second, of.from_second, mixture, child);
        }
    }

  private:
    const GeneMatrix& present_;
    base::RandomKey survivor_key_, crossover_key_, order_mutation_key_, mutation_key_;
    Crossover<extent> crossover_;
    OrderMutation order_mutation_;
    ValueMutation<extent> mutation_;
    GeneBounds bounds_;
    double spread_index_;
    FreeGeneOperators listed_;
};

} // namespace evod::evolution
