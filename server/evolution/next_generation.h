// The next generation of one island: chooses survivors and parents, and computes the genes of all organisms.
//
//   fitness → scaling → selection → pairing → crossover → order mutation → creep, reset, scale, bit flip → bounds
//
// Owner        World, once per generation and island.
// Threads      none of its own; the executor processes pairs and survivors in blocks.
// Determinism  every draw is keyed by (seed, stage, island, generation) and by the index of the draw, pair or place.
//              The result does not depend on threads, and any single child can be recomputed alone.
// Cost         O(n) time and memory, where n is the larger of the two population sizes. Only tournament selection can
//              take longer, because it also draws contestants (tournament.h).
#pragma once

#include "server/base/executor.h"
#include "server/base/random.h"
#include "server/evolution/chromosome.h"
#include "server/evolution/ga_parameters.h"
#include "server/evolution/pairing.h"
#include "server/evolution/price.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace evod::evolution {

/// The key of all draws of one breeding.
struct BreedingKey {
    base::Seed seed;
    std::uint32_t island = 0;     // index, from 0
    std::uint64_t generation = 1; // generation of the parents, from 1
};

struct NextGeneration {
    GeneMatrix genes;              // shape (gene_count, organisms): the elite, the other survivors, the children
    std::vector<Parents> parents;  // shape (organisms); first the parent that gave more
    std::uint32_t elite_count = 0; // organisms 0 … elite_count − 1: the best of the previous generation, best first
    std::uint32_t survivor_count = 0; // organisms 0 … survivor_count − 1, with the elite; the rest are children
    std::uint64_t clamped_count = 0;  // genes that were out of bounds and were clamped
    // The change from the previous generation, as it was before migration. Set by the caller; nullopt in the first
    // generation, or if the previous generation is not available.
    std::optional<SelectionAccount> account = std::nullopt;
    // The same for a second species, whose organisms come last. elite_count and survivor_count are then those of the
    // first species.
    std::uint32_t predator_count = 0;
    std::optional<SelectionAccount> predator_account = std::nullopt;
};

/// How the places of the next generation are divided.
struct Places {
    std::uint32_t elite, survivors, children; // the survivors include the elite
};

/// Divides the places of a next generation of `wanted` organisms that is bred from `present` organisms; both >= 1.
///
/// elite         elite_count, but at most `present` and at most `wanted`.
/// hybrid        survivors: round(survivors · wanted), half up, at least 1 and at least the elite.
/// generational  survivors: the elite alone.
/// steady_state  survivors: min(present, wanted) − replaced_count, at least 0 and at least the elite. A growing
///               population grows by children; a shrinking one loses its worst organisms.
Places share_places(std::uint32_t present, std::uint32_t wanted, const Parameters& parameters);

/// Breeds the next generation; does not change its arguments.
///
/// fitness     shape (present), any finite numbers, present >= 1; larger is better, ties go to the lower index.
/// genes       shape (gene_count, present).
/// parameters  the parameters of the algorithm, each in its range.
/// wanted      organisms in the next generation, >= 1; the population grows or shrinks to this number.
///
/// hybrid        Selection picks the survivors; an organism that is picked twice survives twice. The elite come first
///               among the survivors. Each elite organism replaces one of its own picks, or the last pick if it was not
///               picked. The survivors are also the parents.
/// generational  Selection picks the parents from the whole population: as many as there are children, but at least
///               two.
/// steady_state  The best organisms survive: first the elite, then the others in index order. Parents are selected as
///               in generational, so the worst organisms can breed too.
///
/// The elite are copied unchanged, and so are the other survivors unless mutate_survivors is on. The genes of every
/// organism are clamped to the present bounds.
NextGeneration next_generation(std::span<const double> fitness, const GeneMatrix& genes, const Parameters& parameters,
                               std::uint32_t wanted, const BreedingKey& key, base::Executor& executor);

} // namespace evod::evolution
