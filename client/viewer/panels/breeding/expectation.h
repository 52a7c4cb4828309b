// Expectation: how often a selection is expected to pick each organism, by rank.
//
// Ranks are counted from the fittest, 0, as the server counts them; of equals the lower id is the fitter.
//
// Threads      none.
// Sources      Blickle & Thiele 1996, "A comparison of selection schemes used in evolutionary algorithms", Evol.
//              Comput. 4(4); Baker 1987, "Reducing bias and inefficiency in the selection algorithm".
#pragma once

#include "evod/v1/world.pb.h"

#include <cstdint>
#include <span>
#include <vector>

namespace evod::viewer {

/// One choice of parents: the parameters that it follows, and how many choose how many.
struct Selection {
    enum class Method { Roulette, StochasticUniversal, Tournament, Random, Truncation };
    enum class Scaling { None, Windowing, LinearRanking, ExponentialRanking };

    Method method = Method::Roulette;
    Scaling scaling = Scaling::None; // of the wheel; tournaments and truncation ask only who is fitter
    double ranking_pressure = 1.5;
    double ranking_decay = 0.95;
    std::uint32_t tournament_size = 3, tournament_winners = 1;
    bool tournament_replacement = true;
    bool overlapping = false;     // steady_state: most of the old generation stays
    std::uint32_t population = 1; // organisms that can be picked, >= 1
    std::uint32_t picks = 1;
    std::uint32_t pool = 1; // truncation picks nobody below the best `pool`, 1 to population

    bool turns_a_wheel() const { return method == Method::Roulette || method == Method::StochasticUniversal; }
};

/// What the parameters of a world make of it.
///
/// parameters  by name, of the genetic algorithm; others are passed over, those that are missing have their defaults.
/// present     organisms of the generation that is chosen from.
/// wanted      organisms of the generation that is bred.
Selection selection_of(const google::protobuf::RepeatedPtrField<evod::v1::ParameterAssignment>& parameters,
                       std::uint32_t present, std::uint32_t wanted);

/// What is expected of it, rank by rank; each shape (population).
struct Expectation {
    std::vector<double> copies;         // of all the picks
    std::vector<double> standard_error; // of those copies: their standard deviation from one breeding to the next
    std::vector<double> missed;         // chance of no copy at all
};

/// fitness  best first, shape (population), finite. A wheel without ranking is all that reads it.
/// Cost     O(population), but for tournaments of several winners, where it is O(population · winners) at most.
Expectation expect(const Selection& selection, std::span<const double> fitness);

} // namespace evod::viewer
