#include "server/evolution/tournament.h"

#include "server/base/assert.h"
#include "server/base/elementary.h"
#include "server/evolution/wheel.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace evod::evolution {
namespace {

// Contestants are drawn in groups of about this size. The fitness of a whole group is prefetched before the first
// comparison, because it is scattered over memory.
constexpr std::size_t contestants_at_once = 128;
constexpr std::size_t contestants_per_piece = 4096;

struct Fitter {
    std::span<const double> fitness;
    bool operator()(std::uint32_t a, std::uint32_t b) const {
        return fitness[a] > fitness[b] || (fitness[a] == fitness[b] && a < b);
    }
};

/// The set of numbers already drawn; cleared in O(1).
class DrawnSet {
  public:
    explicit DrawnSet(std::uint32_t capacity) : slots_(std::bit_ceil(std::size_t{capacity} * 2)) {}

    void clear() { ++round_; }

    /// Adds `number`. Returns whether it was new.
    bool insert(std::uint32_t number) {
        std::size_t slot = number * 0x9e3779b9u & (slots_.size() - 1);
        for (; slots_[slot].round == round_; slot = (slot + 1) & (slots_.size() - 1)) {
            if (slots_[slot].number == number) {
                return false;
            }
        }
        slots_[slot] = {number, round_};
        return true;
    }

  private:
    struct Slot {
        std::uint32_t number = 0, round = 0;
    };
    std::vector<Slot> slots_;
    std::uint32_t round_ = 1;
};

void draw_contestants(std::uint32_t population, std::span<std::uint32_t> contestants, base::RandomStream& random) {
    for (std::uint32_t& contestant : contestants) {
        contestant = random.below(population);
    }
}

/// Draws different contestants; every set is equally likely.
/// Source  Floyd, in Bentley & Floyd 1987, "A sample of brilliance".
void draw_different_contestants(std::uint32_t population, std::span<std::uint32_t> contestants, DrawnSet& drawn,
                                base::RandomStream& random) {
    drawn.clear();
    std::uint32_t last = population - static_cast<std::uint32_t>(contestants.size());
    for (std::uint32_t& contestant : contestants) {
        const std::uint32_t number = random.below(last + 1);
        contestant = drawn.insert(number) ? number : last;
        if (contestant == last) {
            drawn.insert(last);
        }
        ++last;
    }
}

/// Draws the ranks of the winners among `size` uniform draws, best first. The least of m numbers that are uniform in
/// (x, 1) is distributed like 1 − (1 − x) · U^(1/m).
/// Source  Devroye 1986, Non-Uniform Random Variate Generation, V.3.1.
void draw_winning_ranks(std::uint32_t population, std::uint32_t size, std::span<std::uint32_t> ranks,
                        base::RandomStream& random) {
    double above = 1;
    for (std::uint32_t& rank : ranks) {
        above *= base::pow(1 - random.uniform(), 1.0 / size--);
        rank = std::min(static_cast<std::uint32_t>((1 - above) * population), population - 1);
    }
}

/// Draws the ranks of the winners among `size` different contestants. From the best rank down, each rank is a
/// contestant with probability (places left) / (ranks left).
/// Source  selection sampling, Knuth, The Art of Computer Programming 2, 3.4.2 S.
void draw_different_winning_ranks(std::uint32_t population, std::uint32_t size, std::span<std::uint32_t> ranks,
                                  base::RandomStream& random) {
    std::uint32_t rank = 0;
    for (std::uint32_t& winner : ranks) {
        while (random.below(population - rank) >= size) {
            ++rank;
        }
        winner = rank++;
        --size;
    }
}

/// Draws how many of `population` ranks are better than the best of `size` different contestants.
/// Source  Vitter 1987, "An efficient algorithm for sequential random sampling", algorithm D.
std::uint32_t draw_skip(std::uint32_t population, std::uint32_t size, base::RandomStream& random) {
    if (size == 1) {
        return random.below(population);
    }
    const double ranks = population, draws = size, ends = ranks - draws + 1; // a skip is less than `ends`
    while (true) {
        // First, a proposal is drawn from an approximate distribution.
        const double x = ranks * (1 - base::pow(1 - random.uniform(), 1 / draws));
        if (x >= ends) {
            continue;
        }
        const double skip = std::floor(x);
        // The proposal is accepted if a cheap bound permits it.
        const double needed = base::pow(random.uniform() * ranks / ends, 1 / (draws - 1));
        if (needed * (1 - x / ranks) * (ends / (ends - skip)) <= 1) {
            return static_cast<std::uint32_t>(skip);
        }
        // Otherwise the exact distribution decides whether the proposal is accepted.
        double product = 1, above = ranks - 1;
        double below = draws - 1 > skip ? ranks - draws : ranks - skip - 1;
        const double last = draws - 1 > skip ? ranks - skip : ends;
        for (double factor = ranks - 1; factor >= last; --factor) {
            product *= above-- / below--;
        }
        if (ranks / (ranks - x) >= needed * base::pow(product, 1 / (draws - 1))) {
            return static_cast<std::uint32_t>(skip);
        }
    }
}

/// Draws from the same distribution as draw_different_winning_ranks(). The time does not depend on how many ranks are
/// skipped.
void skip_to_different_winning_ranks(std::uint32_t population, std::uint32_t size, std::span<std::uint32_t> ranks,
                                     base::RandomStream& random) {
    std::uint32_t rank = 0;
    for (std::uint32_t& winner : ranks) {
        winner = rank + draw_skip(population - rank, size--, random);
        rank = winner + 1;
    }
}

/// Returns, for each rank, the probability that it is the best of `size` different contestants, which means that no
/// better rank is drawn. Negligible probabilities at the end are left out.
std::vector<double> chances_of_ranks(std::uint32_t population, std::uint32_t size) {
    std::vector<double> chances;
    double all_missed = 1;
    for (std::uint32_t left = population; left >= size && all_missed > 0x1p-100; --left) {
        const double hit = static_cast<double>(size) / left;
        chances.push_back(all_missed * hit);
        all_missed *= 1 - hit;
    }
    return chances;
}

/// How the winners are found. Each method is the fastest in its case.
enum class Method {
    CompareContestants, // contestants are drawn and compared
    OrderStatistics,    // ranks are drawn; for tournaments with replacement
    WheelOfRanks,       // a rank is drawn; without replacement, one winner
    WalkDownRanks,      // ranks are drawn; without replacement, several winners, a large part of the population
    SkipRanks,          // ranks are drawn; without replacement, several winners, a small part of the population
};

// Visiting this many ranks per winner one by one costs as much as drawing one skip.
constexpr std::uint64_t walked_ranks_max = 13;

Method choose_method(std::uint32_t population, const Tournament& tournament) {
    const std::uint64_t size = tournament.size, winners = tournament.winners;
    if (tournament.replacement) {
        return size <= held_contestants_max || size < 4 * winners ? Method::CompareContestants
                                                                  : Method::OrderStatistics;
    }
    if (winners == 1) {
        return size <= held_contestants_max ? Method::CompareContestants : Method::WheelOfRanks;
    }
    if (size <= held_contestants_max) {
        return Method::CompareContestants;
    }
    if (population <= walked_ranks_max * size) {
        return Method::WalkDownRanks;
    }
    return size < 4 * winners ? Method::CompareContestants : Method::SkipRanks;
}

/// The rules of the tournaments of one selection.
struct Rules {
    std::uint32_t population, size, winners;
    bool replacement;
    Method method;
};

Rules rules_of(std::uint32_t population, const Tournament& tournament, std::uint32_t wanted) {
    EVOD_ASSERT(population >= 1);
    EVOD_ASSERT(tournament.size >= 1);
    EVOD_ASSERT(tournament.winners >= 1);
    const std::uint32_t size = tournament.replacement ? tournament.size : std::min(tournament.size, population);
    const std::uint32_t winners = std::min({tournament.winners, size, wanted});
    return {population, size, winners, tournament.replacement,
            choose_method(population, {size, winners, tournament.replacement})};
}

/// Draws the contestants of Method::CompareContestants.
void draw_compared_contestants(const Rules& rules, std::span<std::uint32_t> contestants, DrawnSet& drawn,
                               base::RandomStream& random) {
    if (rules.replacement) {
        draw_contestants(rules.population, contestants, random);
    } else {
        draw_different_contestants(rules.population, contestants, drawn, random);
    }
}

DrawnSet drawn_set_for(const Rules& rules) {
    return DrawnSet{rules.method == Method::CompareContestants && !rules.replacement ? rules.size : 0};
}

} // namespace

Tournament tournament_of(const Parameters& parameters) {
    return {.size = parameters.tournament_size,
            .winners = parameters.tournament_winners,
            .replacement = parameters.tournament_replacement};
}

std::uint32_t winners_of_each(std::uint32_t population, const Tournament& tournament, std::uint32_t wanted) {
    return rules_of(population, tournament, wanted).winners;
}

std::vector<std::uint32_t> contestants_of(std::uint32_t index, std::uint32_t population, const Tournament& tournament,
                                          std::uint32_t wanted, const base::RandomKey& key) {
    const Rules rules = rules_of(population, tournament, wanted);
    if (rules.method != Method::CompareContestants) {
        return {};
    }
    std::vector<std::uint32_t> contestants(rules.size);
    DrawnSet drawn = drawn_set_for(rules);
    base::RandomStream random{key, index};
    draw_compared_contestants(rules, contestants, drawn, random);
    return contestants;
}

std::vector<std::uint32_t> hold_tournaments(Ranking& ranking, const Tournament& tournament, std::uint32_t wanted,
                                            const base::RandomKey& key, base::Executor& executor) {
    const auto population = static_cast<std::uint32_t>(ranking.fitness().size());
    if (wanted == 0) {
        return {};
    }
    const Rules rules = rules_of(population, tournament, wanted);
    const std::uint32_t size = rules.size, winners = rules.winners;
    const Method method = rules.method;
    const bool held = method == Method::CompareContestants;
    const Wheel wheel{method == Method::WheelOfRanks ? chances_of_ranks(population, size) : std::vector<double>{1}};
    const std::span<const std::uint32_t> best_first = held ? std::span<const std::uint32_t>{} : ranking.best_first();
    const Fitter fitter{ranking.fitness()};

    std::vector<std::uint32_t> picked(wanted);
    const std::size_t tournament_count = (std::size_t{wanted} + winners - 1) / winners;
    const std::size_t contestants_each = held ? size : winners;
    const std::size_t at_once = std::max<std::size_t>(contestants_at_once / contestants_each, 1);
    const std::size_t grain = std::max<std::size_t>(contestants_per_piece / contestants_each, 1);
    executor.parallel_for(tournament_count, grain, [&](base::Range piece) {
        std::vector<std::uint32_t> drawn_contestants(contestants_each * std::min(at_once, piece.end - piece.begin));
        DrawnSet drawn = drawn_set_for(rules);
        const auto contestants_of = [&](std::size_t place) {
            return std::span{drawn_contestants}.subspan(place * contestants_each, contestants_each);
        };
        for (std::size_t first = piece.begin; first < piece.end; first += at_once) {
            const std::size_t count = std::min(at_once, piece.end - first);
            for (std::size_t i = 0; i < count; ++i) {
                base::RandomStream random{key, static_cast<std::uint32_t>(first + i)};
                const std::span<std::uint32_t> contestants = contestants_of(i);
                switch (method) {
                case Method::CompareContestants:
                    draw_compared_contestants(rules, contestants, drawn, random);
                    break;
                case Method::OrderStatistics:
                    draw_winning_ranks(population, size, contestants, random);
                    break;
                case Method::WheelOfRanks:
                    contestants[0] = wheel.at(random.uniform());
                    break;
                case Method::WalkDownRanks:
                    draw_different_winning_ranks(population, size, contestants, random);
                    break;
                case Method::SkipRanks:
                    skip_to_different_winning_ranks(population, size, contestants, random);
                    break;
                }
                for (const std::uint32_t contestant : contestants) {
                    __builtin_prefetch(held ? static_cast<const void*>(&ranking.fitness()[contestant])
                                            : static_cast<const void*>(&best_first[contestant]));
                }
            }
            for (std::size_t i = 0; i < count; ++i) {
                const std::span<std::uint32_t> contestants = contestants_of(i);
                if (!held) {
                    for (std::uint32_t& rank : contestants) {
                        rank = best_first[rank];
                    }
                } else if (winners == 1) {
                    contestants[0] = *std::min_element(contestants.begin(), contestants.end(), fitter);
                } else {
                    std::partial_sort(contestants.begin(), contestants.begin() + winners, contestants.end(), fitter);
                }
                const std::size_t begin = (first + i) * winners;
                std::copy_n(contestants.begin(), std::min<std::size_t>(winners, wanted - begin),
                            picked.begin() + static_cast<std::ptrdiff_t>(begin));
            }
        }
    });
    return picked;
}

} // namespace evod::evolution
