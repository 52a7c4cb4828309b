// Migration: once an epoch, each island sends copies of some of its organisms to others.
//
// Owner        World; called between a generation's end and the breeding of the next, so that arrivals can breed.
// Threads      none of its own.
// Determinism  emigrants are chosen, and then copied out, from every island before anyone arrives, islands in index
//              order, so the result does not depend on the order in which the islands were computed.
// Source       Whitley, Rana & Heckendorn 1999, "The Island Model Genetic Algorithm".
#pragma once

#include "server/base/random.h"
#include "server/evolution/chromosome.h"
#include "server/evolution/parameters.h"

#include <cstdint>
#include <span>
#include <vector>

namespace evod::evolution {

/// Who goes from where to where in one migration.
struct Migrant {
    std::uint32_t from, to; // islands, never the same
    std::uint32_t organism; // index in `from`
    std::uint32_t replaces; // index in `to`
    friend bool operator==(const Migrant&, const Migrant&) = default;
};

/// Whether islands exchange migrants after generation `generation` (from 1): every migration_epoch generations.
bool migration_due(std::uint64_t generation, const Parameters& parameters);

/// Chooses the migrants of one epoch; changes nothing.
///
/// ring             island i sends to i + 1, the last to the first.
/// fully_connected  every island sends to every other.
/// random           every island sends to one other, drawn afresh each time, each equally likely.
///
/// Along each edge go min(migrant_count, population) different organisms: the best, best first (ties: lower index), or
/// different ones drawn uniformly for that edge. Those that arrive at an island replace its worst, worst first (of
/// equals the higher index is the worse), or different ones drawn uniformly. If more would arrive than the island
/// holds, its places are shared evenly among the edges: none gets more than one place more than another, unless the other
/// has no more migrants. The edges that get the places left over are drawn, each equally likely.
///
/// fitness     one span per island, shape (population), finite; not all islands need the same population, and one may
///             be empty: it sends and receives nobody.
/// generation  that has just ended; keys the draws.
/// returns     ordered by (to, from); no organism is replaced twice; empty with a single island or Topology::None.
std::vector<Migrant> choose_migrants(std::span<const std::span<const double>> fitness, const Parameters& parameters,
                                     base::Seed seed, std::uint64_t generation);

/// One island's chromosomes with their fitness.
struct IslandPopulation {
    GeneMatrix* genes;
    std::span<double> fitness; // shape (population)
};

/// Copies every migrant's chromosome and fitness out, then puts them where they go.
void migrate(std::span<const Migrant> migrants, std::span<const IslandPopulation> islands);

} // namespace evod::evolution
