#include "server/evolution/selection.h"

#include "server/base/assert.h"
#include "server/evolution/scaling.h"
#include "server/evolution/shuffle.h"
#include "server/evolution/tournament.h"

#include <algorithm>
#include <numeric>

namespace evod::evolution {
namespace {

constexpr std::size_t spins_per_stream = 4096;
constexpr std::size_t pointers_per_piece = 16384;

/// Calls stop(i, turns) for each spin i of a roulette, in parallel. `turns` is the position where the spin stops.
template <class Stop>
void spin(std::uint32_t spins, const base::RandomKey& key, base::Executor& executor, const Stop& stop) {
    executor.parallel_for(spins, spins_per_stream, [&](base::Range piece) {
        base::RandomStream random{key, static_cast<std::uint32_t>(piece.begin / spins_per_stream)};
        for (std::size_t i = piece.begin; i < piece.end; ++i) {
            stop(i, random.uniform());
        }
    });
}

/// Returns the position of one of `wanted` equally spaced pointers, in turns. The first pointer is at `offset` times
/// the spacing.
double pointer_turns(std::size_t pointer, double offset, std::uint32_t wanted) {
    return (static_cast<double>(pointer) + offset) / wanted;
}

} // namespace

std::vector<std::uint32_t> spin_roulette(const Wheel& wheel, std::uint32_t wanted, const base::RandomKey& key,
                                         base::Executor& executor) {
    std::vector<std::uint32_t> picked(wanted);
    spin(wanted, key, executor, [&](std::size_t i, double turns) { picked[i] = wheel.at(turns); });
    return picked;
}

std::vector<double> roulette_turns(std::uint32_t wanted, const base::RandomKey& key, base::Executor& executor) {
    std::vector<double> stops(wanted);
    spin(wanted, key, executor, [&](std::size_t i, double turns) { stops[i] = turns; });
    return stops;
}

std::vector<std::uint32_t> spin_universal(const Wheel& wheel, std::uint32_t wanted, base::RandomStream& random,
                                          base::Executor& executor) {
    const std::span<const double> ends = wheel.slot_ends();
    const double offset = random.uniform();
    std::vector<std::uint32_t> picked(wanted);
    executor.parallel_for(wanted, pointers_per_piece, [&](base::Range piece) {
        const auto place = [&](std::size_t pointer) { return pointer_turns(pointer, offset, wanted) * ends.back(); };
        auto slot = std::upper_bound(ends.begin(), ends.end(), place(piece.begin));
        for (std::size_t pointer = piece.begin; pointer < piece.end; ++pointer) {
            while (slot < ends.end() && *slot <= place(pointer)) {
                ++slot;
            }
            // Rounding can put the last pointer at the end of the wheel.
            picked[pointer] = static_cast<std::uint32_t>(std::min(slot, ends.end() - 1) - ends.begin());
        }
    });
    shuffle(picked, random, executor);
    return picked;
}

std::vector<double> universal_turns(std::uint32_t wanted, base::RandomStream& random, base::Executor& executor) {
    const double offset = random.uniform();
    std::vector<std::uint32_t> pointers(wanted);
    std::iota(pointers.begin(), pointers.end(), 0u);
    shuffle(pointers, random, executor);
    std::vector<double> turns;
    turns.reserve(wanted);
    for (const std::uint32_t pointer : pointers) {
        turns.push_back(pointer_turns(pointer, offset, wanted));
    }
    return turns;
}

std::vector<std::uint32_t> draw_unique(std::uint32_t population, std::uint32_t wanted, base::RandomStream& random,
                                       base::Executor& executor) {
    std::vector<std::uint32_t> picked;
    if (population == 0) {
        return picked;
    }
    picked.reserve(wanted);
    std::vector<std::uint32_t> organisms(population);
    std::iota(organisms.begin(), organisms.end(), 0u);
    while (picked.size() < wanted) {
        const auto round = static_cast<std::uint32_t>(std::min<std::size_t>(population, wanted - picked.size()));
        if (round > shuffled_whole_max) {
            shuffle(organisms, random, executor);
            picked.insert(picked.end(), organisms.begin(), organisms.begin() + round);
            continue;
        }
        for (std::uint32_t i = 0; i < round; ++i) {
            std::swap(organisms[i], organisms[i + random.below(population - i)]);
            picked.push_back(organisms[i]);
        }
    }
    return picked;
}

std::vector<std::uint32_t> take_best(Ranking& ranking, std::uint32_t pool, std::uint32_t wanted) {
    const auto best_first = ranking.best_first();
    EVOD_ASSERT(pool >= 1);
    EVOD_ASSERT(pool <= best_first.size());
    std::vector<std::uint32_t> picked(wanted);
    for (std::uint32_t i = 0; i < wanted; ++i) {
        picked[i] = best_first[i % pool];
    }
    return picked;
}

base::RandomStream selection_stream(const base::RandomKey& key) {
    return {key, 0};
}

std::vector<std::uint32_t> select(Ranking& ranking, const Picks& picks, const Parameters& parameters,
                                  const base::RandomKey& key, base::Executor& executor) {
    const auto population = static_cast<std::uint32_t>(ranking.fitness().size());
    base::RandomStream random = selection_stream(key);
    EVOD_ASSERT(parameters.selection <= SelectionMethod::Truncation);
    switch (parameters.selection) {
    case SelectionMethod::Roulette:
        return spin_roulette(Wheel{scaled_fitness(ranking, parameters)}, picks.wanted, key, executor);
    case SelectionMethod::StochasticUniversal:
        return spin_universal(Wheel{scaled_fitness(ranking, parameters)}, picks.wanted, random, executor);
    case SelectionMethod::Tournament:
        return hold_tournaments(ranking, tournament_of(parameters), picks.wanted, key, executor);
    case SelectionMethod::Random:
        return draw_unique(population, picks.wanted, random, executor);
    case SelectionMethod::Truncation:
        return take_best(ranking, picks.pool, picks.wanted);
    }
    return {};
}

} // namespace evod::evolution
