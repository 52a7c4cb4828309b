// Tournaments: contestants are drawn uniformly from the population, and the fittest of them win.
//
// Determinism  each tournament has a stream of its own.
// Cost         a tournament of k contestants costs O(k), but the outcome of a large one is drawn directly, by the same
//              law, in O(winners).
// Source       Goldberg & Deb 1991, "A comparative analysis of selection schemes used in genetic algorithms".
#pragma once

#include "server/base/executor.h"
#include "server/base/random.h"
#include "server/evolution/parameters.h"
#include "server/evolution/ranking.h"

#include <cstdint>
#include <vector>

namespace evod::evolution {

struct Tournament {
    std::uint32_t size = 3;    // contestants, >= 1; without replacement at most the whole population takes part
    std::uint32_t winners = 1; // of each, >= 1; at most all of its contestants win
    bool replacement = true;   // whether an organism can be drawn, and win, more than once in a tournament
};

Tournament tournament_of(const Parameters& parameters);

/// Holds tournaments until `wanted` organisms are picked; the last one's surplus winners are dropped, worst first.
///
/// With replacement the best of k from n has rank r (0 = fittest) with probability ((n−r)^k − (n−r−1)^k) / n^k, without
/// with C(n−r−1, k−1) / C(n, k).
///
/// ranking  of at least one organism; ties go to the lower index.
/// key      tournament i draws from the stream of entity i.
/// returns  shape (wanted): each tournament's winners together, best first.
std::vector<std::uint32_t> hold_tournaments(Ranking& ranking, const Tournament& tournament, std::uint32_t wanted,
                                            const base::RandomKey& key, base::Executor& executor);

/// How many picks each of those tournaments gives; the last perhaps fewer.
std::uint32_t winners_of_each(std::uint32_t population, const Tournament& tournament, std::uint32_t wanted);

/// The contestants of one of those tournaments, as drawn; empty if its outcome is drawn directly.
std::vector<std::uint32_t> contestants_of(std::uint32_t index, std::uint32_t population, const Tournament& tournament,
                                          std::uint32_t wanted, const base::RandomKey& key);

/// Tournaments of more contestants than this have their outcome drawn directly, unless most of them win.
constexpr std::uint32_t held_contestants_max = 64;

} // namespace evod::evolution
