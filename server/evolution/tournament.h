// Tournaments: contestants are drawn uniformly from the population, and the fittest of them win.
//
// Determinism  each tournament has its own stream.
// Cost         a tournament of k contestants costs O(k). The winners of a large tournament are drawn directly, from the
//              same distribution, in O(winners).
// Source       Goldberg & Deb 1991, "A comparative analysis of selection schemes used in genetic algorithms".
#pragma once

#include "server/base/executor.h"
#include "server/base/random.h"
#include "server/evolution/ga_parameters.h"
#include "server/evolution/ranking.h"

#include <cstdint>
#include <vector>

namespace evod::evolution {

struct Tournament {
    std::uint32_t size = 3;    // contestants, >= 1; without replacement at most the population
    std::uint32_t winners = 1; // per tournament, >= 1; at most the number of contestants
    bool replacement = true;   // whether an organism can be drawn, and win, more than once in a tournament
};

Tournament tournament_of(const Parameters& parameters);

/// Holds tournaments until `wanted` organisms are picked; surplus winners of the last one are dropped, worst first.
///
/// The best of k contestants from n organisms has rank r (0 = fittest) with probability ((n−r)^k − (n−r−1)^k) / n^k
/// with replacement, and C(n−r−1, k−1) / C(n, k) without.
///
/// ranking  the organisms, at least one. Ties go to the lower index.
/// key      the key of the draws. Tournament i draws from the stream of entity i.
/// returns  shape (wanted): each tournament's winners together, best first.
std::vector<std::uint32_t> hold_tournaments(Ranking& ranking, const Tournament& tournament, std::uint32_t wanted,
                                            const base::RandomKey& key, base::Executor& executor);

/// Returns the number of winners of each tournament of hold_tournaments(); the last tournament may have fewer.
std::uint32_t winners_of_each(std::uint32_t population, const Tournament& tournament, std::uint32_t wanted);

/// Returns the contestants of one tournament of hold_tournaments(), in the order drawn; empty if its winners are drawn
/// directly.
std::vector<std::uint32_t> contestants_of(std::uint32_t index, std::uint32_t population, const Tournament& tournament,
                                          std::uint32_t wanted, const base::RandomKey& key);

/// The winners of tournaments with more contestants than this are drawn directly, unless most contestants win.
constexpr std::uint32_t held_contestants_max = 64;

} // namespace evod::evolution
