// The next generation of one island: who stays, who breeds, and what becomes of their genes.
//
//   fitness → scaling → selection → pairing → crossover → rearranging → creep, reset, bit flip → bounds
//
// Owner        World, once per generation and island.
// Threads      none of its own; pairs and survivors are worked on in blocks given to the executor.
// Determinism  every draw is keyed by (seed, stage, island, generation) and by the draw, pair or place it belongs to,
// so
//              the result does not depend on threads, and any single child can be worked out again alone.
// Cost         O(n) time and memory in the larger of the two population sizes, for every choice of every stage but
//              tournament selection, which adds its contestants (tournament.h).
#pragma once

#include "server/base/executor.h"
#include "server/base/random.h"
#include "server/evolution/chromosome.h"
#include "server/evolution/pairing.h"
#include "server/evolution/parameters.h"
#include "server/evolution/price.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace evod::evolution {

/// What the draws of one breeding are keyed by.
struct BreedingKey {
    base::Seed seed;
    std::uint32_t island = 0;     // index, from 0
    std::uint64_t generation = 1; // of the parents, from 1
};

struct NextGeneration {
    GeneMatrix genes;              // shape (gene_count, organisms): the elite, the other survivors, the children
    std::vector<Parents> parents;  // shape (organisms); first the parent that gave more of the genes
    std::uint32_t elite_count = 0; // organisms 0 … elite_count − 1: the best of the last generation, best first
    std::uint32_t survivor_count = 0; // organisms 0 … survivor_count − 1 were kept, the elite among them; then children
    std::uint64_t clamped_count = 0; // genes that were out of bounds and were put onto them
    // From the generation before; set by who knows it as it was before migrants came. None: it is the first, or nobody
    // knows.
    std::optional<SelectionAccount> account = std::nullopt;
};

/// How the places of the next generation are shared out.
struct Places {
    std::uint32_t elite, survivors, children; // the survivors include the elite
};

/// The places of a next generation of `wanted` organisms bred from `present`; both >= 1.
///
/// elite         elite_count, at most all of the present and at most all the places.
/// hybrid        survivors: round(survivors · wanted), half up, at least 1 and at least the elite.
/// generational  survivors: the elite alone.
/// steady_state  survivors: min(present, wanted) − replaced_count, at least 0 and at least the elite, so all that a
///               population grows by are children, and one that shrinks loses its worst.
Places share_places(std::uint32_t present, std::uint32_t wanted, const Parameters& parameters);

/// Breeds the next generation; changes nothing it is given.
///
/// fitness     shape (present), any finite numbers, present >= 1; larger is better, ties go to the lower index.
/// genes       shape (gene_count, present).
/// parameters  each in its range.
/// wanted      organisms in the next generation, >= 1; more or fewer than there are makes the population grow or
/// shrink.
///
/// hybrid        The selection picks as many as survive; one that is picked twice survives twice. The elite come first,
///               each using up one of its picks if it has any, else the place of the last pick. The survivors are the
///               parents.
/// generational  As many parents as children, but at least two, are selected from everyone.
/// steady_state  The best stay, in index order after the elite; parents as in generational, so the worst breed too.
///
/// The elite are copied unchanged; so are the other survivors unless mutate_survivors. Bounds that were narrowed since
/// hold for everyone.
NextGeneration next_generation(std::span<const double> fitness, const GeneMatrix& genes, const Parameters& parameters,
                               std::uint32_t wanted, const BreedingKey& key, base::Executor& executor);

} // namespace evod::evolution
