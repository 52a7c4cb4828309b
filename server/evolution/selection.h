// Selection: who breeds. Every method picks `wanted` organisms from a population; repeats are allowed but for random
// selection and truncation, which repeat only when they have been through everybody.
//
// Determinism  picks are keyed one by one (tournaments) or in blocks of fixed size (roulette), or drawn from one
// stream. Source       Blickle & Thiele 1996, Evol. Comput. 4(4), doi:10.1162/evco.1996.4.4.361, for the laws of all of
//              them.
#pragma once

#include "server/base/executor.h"
#include "server/base/random.h"
#include "server/evolution/parameters.h"
#include "server/evolution/ranking.h"
#include "server/evolution/wheel.h"

#include <cstdint>
#include <vector>

namespace evod::evolution {

/// Roulette: each pick is a spin of its own, so pick after pick falls on an organism with the chance of its share.
/// returns  shape (wanted), in order of the spins.
std::vector<std::uint32_t> spin_roulette(const Wheel& wheel, std::uint32_t wanted, const base::RandomKey& key,
                                         base::Executor& executor);

/// Where each of those spins stops, in turns from the first slot, in [0, 1).
std::vector<double> roulette_turns(std::uint32_t wanted, const base::RandomKey& key, base::Executor& executor);

/// Stochastic universal sampling: one spin, `wanted` equally spaced pointers. An organism with share p is picked
/// ⌊wanted · p⌋ or ⌈wanted · p⌉ times (to within the rounding of a sum of doubles), wanted · p on average.
/// returns  shape (wanted), in random order.
/// Source   Baker 1987, "Reducing bias and inefficiency in the selection algorithm".
std::vector<std::uint32_t> spin_universal(const Wheel& wheel, std::uint32_t wanted, base::RandomStream& random,
                                          base::Executor& executor);

/// Where the pointer of each of those picks stands, in turns from the first slot, to within rounding in [0, 1).
std::vector<double> universal_turns(std::uint32_t wanted, base::RandomStream& random, base::Executor& executor);

/// Different organisms, each set and order of them equally likely. When more are wanted than there are, full rounds of
/// everybody come first, each in a fresh order.
/// returns  shape (wanted); empty for a population of 0.
std::vector<std::uint32_t> draw_unique(std::uint32_t population, std::uint32_t wanted, base::RandomStream& random,
                                       base::Executor& executor);

/// The best `pool` organisms in order of rank, over and over.
/// pool     1 … population.
/// returns  shape (wanted).
std::vector<std::uint32_t> take_best(Ranking& ranking, std::uint32_t pool, std::uint32_t wanted);

/// What universal sampling and random selection draw from.
base::RandomStream selection_stream(const base::RandomKey& key);

struct Picks {
    std::uint32_t wanted; // how many to pick
    std::uint32_t pool; // truncation takes nobody below the best `pool`, 1 … population; the other methods ignore it
};

/// Picks with the method, scaling and tournament of `parameters`. Roulette and universal sampling turn a wheel of the
/// scaled fitness (wheel.h says what becomes of negative and of all-zero weights).
///
/// ranking  of at least one organism.
/// key      made for Purpose::Selection.
std::vector<std::uint32_t> select(Ranking& ranking, const Picks& picks, const Parameters& parameters,
                                  const base::RandomKey& key, base::Executor& executor);

} // namespace evod::evolution
