// Migration: once per epoch, each island sends copies of some of its organisms to other islands.
//
// Owner        World; called after a generation's end and before the next is bred, so that migrants can breed.
// Threads      none of its own.
// Determinism  migrants are chosen and copied from every island before any arrives, islands in index order, so the
//              result does not depend on the order in which islands were computed.
// Source       Whitley, Rana & Heckendorn 1999, "The Island Model Genetic Algorithm".
#pragma once

#include "server/base/random.h"
#include "server/evolution/chromosome.h"
#include "server/evolution/ga_parameters.h"
#include "server/evolution/ranking.h"

#include <cstdint>
#include <span>
#include <vector>

namespace evod::evolution {

/// One migrant: a copy of an organism of one island, which replaces an organism of another island.
struct Migrant {
    std::uint32_t from, to; // islands, never equal
    std::uint32_t organism; // index in `from`
    std::uint32_t replaces; // index in `to`
    friend bool operator==(const Migrant&, const Migrant&) = default;
};

/// Returns whether islands exchange migrants after generation `generation` (from 1): every migration_epoch generations.
bool migration_due(std::uint64_t generation, const Parameters& parameters);

/// The migrants that one island sends to another in one epoch. Their number is known before it is known which organisms
/// they are, so the processes that share a world agree on it without exchanging their fitness.
struct MigrationRoute {
    std::uint32_t from, to;    // islands, never equal
    std::uint32_t count;       // number of migrants
    std::uint32_t first_place; // migrant i replaces the organism replaced_first(…)[first_place + i] of `to`
};

/// Plans how many migrants each island sends to each other island (choose_migrants() states the rules).
///
/// populations  the number of organisms on each island.
/// returns      ordered by (to, from).
std::vector<MigrationRoute> plan_migration(std::span<const std::uint32_t> populations, const Parameters& parameters,
                                           base::Seed seed, std::uint64_t generation);

/// Returns the organisms of route.from that migrate, in the order of their places.
///
/// ranking  of the organisms of route.from.
std::vector<std::uint32_t> emigrants(const MigrationRoute& route, Ranking& ranking, const Parameters& parameters,
                                     base::Seed seed, std::uint64_t generation);

/// Returns the organisms of an island in the order in which migrants replace them.
///
/// ranking  of the organisms of `island`.
std::vector<std::uint32_t> replaced_first(std::uint32_t island, Ranking& ranking, const Parameters& parameters,
                                          base::Seed seed, std::uint64_t generation);

/// Chooses the migrants of one epoch; changes nothing.
///
/// ring             island i sends to i + 1, the last to the first.
/// fully_connected  every island sends to every other island.
/// random           every island sends to one other island, which is drawn in each epoch; all are equally likely.
///
/// Each edge carries min(migrant_count, population) different organisms. They are either the best, best first (ties:
/// lower index first), or drawn uniformly for that edge. At the destination they replace either the worst organisms,
/// worst first (ties: higher index first), or different organisms drawn uniformly. If more migrants would arrive than
/// the island has organisms, its places are shared evenly among the edges: an edge gets at most one place more than
/// another edge, unless the other edge has no more migrants. The edges that get the remaining places are drawn, each
/// equally likely.
///
/// fitness     the fitness of each island's organisms, finite. Populations may differ; an island with an empty
///             population sends and receives none.
/// generation  the generation that has just ended; keys the draws.
/// returns     ordered by (to, from); no organism is replaced twice; empty for a single island or Topology::None.
std::vector<Migrant> choose_migrants(std::span<const std::span<const double>> fitness, const Parameters& parameters,
                                     base::Seed seed, std::uint64_t generation);

/// One island's chromosomes with their fitness.
struct IslandPopulation {
    GeneMatrix* genes;
    std::span<double> fitness; // shape (population)
};

/// Copies the chromosome and fitness of every migrant, then writes the copies to their places.
void migrate(std::span<const Migrant> migrants, std::span<const IslandPopulation> islands);

} // namespace evod::evolution
