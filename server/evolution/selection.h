// Selection: chooses the organisms that breed. Every method picks `wanted` organisms from a population. Repeats are
// allowed. Random selection repeats an organism only after it has picked every organism; truncation, only after it has
// picked every organism of its pool.
//
// Determinism  each tournament and each fixed-size block of roulette spins has its own key; the other methods draw from
//              one stream.
// Source       Blickle & Thiele 1996, Evol. Comput. 4(4), doi:10.1162/evco.1996.4.4.361, for the laws of all methods.
#pragma once

#include "server/base/executor.h"
#include "server/base/random.h"
#include "server/evolution/ga_parameters.h"
#include "server/evolution/ranking.h"
#include "server/evolution/wheel.h"

#include <cstdint>
#include <vector>

namespace evod::evolution {

/// Roulette: each pick is an independent spin. The chance of an organism is its share of the wheel.
/// returns  shape (wanted), in order of the spins.
std::vector<std::uint32_t> spin_roulette(const Wheel& wheel, std::uint32_t wanted, const base::RandomKey& key,
                                         base::Executor& executor);

/// Returns where each spin of spin_roulette() stops, in turns from the beginning of the first slot, in [0, 1).
std::vector<double> roulette_turns(std::uint32_t wanted, const base::RandomKey& key, base::Executor& executor);

/// Stochastic universal sampling: one spin, with `wanted` equally spaced pointers. An organism with the share p of the
/// wheel is picked wanted · p times on average, and always ⌊wanted · p⌋ or ⌈wanted · p⌉ times, except for rounding in
/// the sum of doubles.
/// returns  shape (wanted), in random order.
/// Source   Baker 1987, "Reducing bias and inefficiency in the selection algorithm".
std::vector<std::uint32_t> spin_universal(const Wheel& wheel, std::uint32_t wanted, base::RandomStream& random,
                                          base::Executor& executor);

/// Returns the pointer position of each pick of spin_universal(), in turns from the beginning of the first slot, in [0,
/// 1) except for rounding.
std::vector<double> universal_turns(std::uint32_t wanted, base::RandomStream& random, base::Executor& executor);

/// Picks different organisms; each set and order of them is equally likely. If `wanted` exceeds `population`, complete
/// rounds of all organisms come first, each in a new order.
/// returns  shape (wanted); empty for a population of 0.
std::vector<std::uint32_t> draw_unique(std::uint32_t population, std::uint32_t wanted, base::RandomStream& random,
                                       base::Executor& executor);

/// Picks the best `pool` organisms in order of rank, and repeats the list until there are `wanted` picks.
/// pool     the number of different organisms to pick, 1 … population.
/// returns  shape (wanted).
std::vector<std::uint32_t> take_best(Ranking& ranking, std::uint32_t pool, std::uint32_t wanted);

/// Returns the random stream from which universal sampling and random selection draw.
base::RandomStream selection_stream(const base::RandomKey& key);

struct Picks {
    std::uint32_t wanted; // the number of picks
    std::uint32_t pool;   // truncation picks only from the best `pool`, 1 … population; the other methods ignore it
};

/// Picks organisms with the method, scaling and tournament rules of `parameters`. Roulette and universal sampling use a
/// wheel of the scaled fitness (wheel.h describes how it treats negative weights and weights that are all 0).
///
/// ranking  the organisms to pick from, at least one.
/// key      the key of the draws; its purpose must be Purpose::Selection.
std::vector<std::uint32_t> select(Ranking& ranking, const Picks& picks, const Parameters& parameters,
                                  const base::RandomKey& key, base::Executor& executor);

} // namespace evod::evolution
