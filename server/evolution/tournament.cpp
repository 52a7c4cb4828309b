#include "server/evolution/tournament.h"

#include "server/base/assert.h"
#include "server/base/elementary.h"
#include "server/evolution/wheel.h"

#include <algorithm>
#include <bit>

namespace evod::evolution {
namespace {

constexpr std::size_t tournaments_per_piece = 1024;

struct Fitter {
    std::span<const double> fitness;
    bool operator()(std::uint32_t a, std::uint32_t b) const {
        return fitness[a] > fitness[b] || (fitness[a] == fitness[b] && a < b);
    }
};

/// Numbers that were drawn already; emptied in O(1).
class DrawnSet {
  public:
    explicit DrawnSet(std::uint32_t capacity) : slots_(std::bit_ceil(std::size_t{capacity} * 2)) {}

    void clear() { ++round_; }

    /// Whether `number` was new.
    bool insert(std::uint32_t number) {
        std::size_t slot = number * 0x9e3779b9u & (slots_.size() - 1);
        for (; slots_[slot].round == round_; slot = (slot + 1) & (slots_.size() - 1))
            if (slots_[slot].number == number)
                return false;
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
    for (std::uint32_t& contestant : contestants)
        contestant = random.below(population);
}

/// Every set of different contestants equally likely. Source: Floyd, in Bentley & Floyd 1987, "A sample of brilliance".
void draw_different_contestants(std::uint32_t population, std::span<std::uint32_t> contestants, DrawnSet& drawn,
                                base::RandomStream& random) {
    drawn.clear();
    std::uint32_t last = population - static_cast<std::uint32_t>(contestants.size());
    for (std::uint32_t& contestant : contestants) {
        const std::uint32_t number = random.below(last + 1);
        contestant = drawn.insert(number) ? number : last;
        if (contestant == last)
            drawn.insert(last);
        ++last;
    }
}

/// The ranks of the best of `size` uniform draws, best first: the least of m uniform numbers above x is
/// 1 − (1 − x) · U^(1/m). Source: Devroye 1986, Non-Uniform Random Variate Generation, V.3.1.
void draw_winning_ranks(std::uint32_t population, std::uint32_t size, std::span<std::uint32_t> ranks,
                        base::RandomStream& random) {
    double above = 1;
    for (std::uint32_t& rank : ranks) {
        above *= base::pow(1 - random.uniform(), 1.0 / size--);
        rank = std::min(static_cast<std::uint32_t>((1 - above) * population), population - 1);
    }
}

/// The best ranks of `size` different draws: from the best rank down, each takes part with probability
/// (places left) / (ranks left). Source: selection sampling, Knuth, The Art of Computer Programming 2, 3.4.2 S.
void draw_different_winning_ranks(std::uint32_t population, std::uint32_t size, std::span<std::uint32_t> ranks,
                                  base::RandomStream& random) {
    std::uint32_t rank = 0;
    for (std::uint32_t& winner : ranks) {
        while (random.below(population - rank) >= size)
            ++rank;
        winner = rank++;
        --size;
    }
}

/// The chance of each rank to be the best of `size` different draws, as long as it can be told from 0: the ranks above
/// it are missed one after another.
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

/// How the winners are found; each is the cheapest for what it is chosen for.
enum class Way {
    Held,            // contestants are drawn and compared
    OrderStatistics, // with replacement
    WheelOfRanks,    // without, one winner
    WalkDownRanks,   // without, several winners
};

Way choose_way(std::uint32_t population, const Tournament& tournament) {
    const std::uint64_t size = tournament.size, winners = tournament.winners;
    if (tournament.replacement)
        return size <= held_contestants_max || size < 4 * winners ? Way::Held : Way::OrderStatistics;
    if (winners == 1)
        return size <= held_contestants_max ? Way::Held : Way::WheelOfRanks;
    return size * size <= winners * population ? Way::Held : Way::WalkDownRanks;
}

} // namespace

std::vector<std::uint32_t> hold_tournaments(Ranking& ranking, const Tournament& tournament, std::uint32_t wanted,
                                            const base::RandomKey& key, base::Executor& executor) {
    const auto population = static_cast<std::uint32_t>(ranking.fitness().size());
    EVOD_ASSERT(population >= 1 && tournament.size >= 1 && tournament.winners >= 1);
    const std::uint32_t size = tournament.replacement ? tournament.size : std::min(tournament.size, population);
    if (wanted == 0)
        return {};
    const std::uint32_t winners = std::min({tournament.winners, size, wanted});
    const Way way = choose_way(population, {size, winners, tournament.replacement});
    const bool held = way == Way::Held;
    const Wheel wheel{way == Way::WheelOfRanks ? chances_of_ranks(population, size) : std::vector<double>{1}};
    const std::span<const std::uint32_t> best_first = held ? std::span<const std::uint32_t>{} : ranking.best_first();
    const Fitter fitter{ranking.fitness()};

    std::vector<std::uint32_t> picked(wanted);
    const std::size_t tournament_count = (std::size_t{wanted} + winners - 1) / winners;
    executor.parallel_for(tournament_count, tournaments_per_piece, [&](base::Range piece) {
        std::vector<std::uint32_t> contestants(held ? size : winners);
        DrawnSet drawn{held && !tournament.replacement ? size : 0};
        for (std::size_t i = piece.begin; i < piece.end; ++i) {
            base::RandomStream random{key, static_cast<std::uint32_t>(i)};
            if (held) {
                if (tournament.replacement)
                    draw_contestants(population, contestants, random);
                else
                    draw_different_contestants(population, contestants, drawn, random);
                if (winners == 1)
                    contestants[0] = *std::min_element(contestants.begin(), contestants.end(), fitter);
                else
                    std::partial_sort(contestants.begin(), contestants.begin() + winners, contestants.end(), fitter);
            } else {
                if (way == Way::WheelOfRanks)
                    contestants[0] = wheel.at(random.uniform());
                else if (tournament.replacement)
                    draw_winning_ranks(population, size, contestants, random);
                else
                    draw_different_winning_ranks(population, size, contestants, random);
                for (std::uint32_t& rank : contestants)
                    rank = best_first[rank];
            }
            const std::size_t first = i * winners;
            std::copy_n(contestants.begin(), std::min<std::size_t>(winners, wanted - first), picked.begin() + first);
        }
    });
    return picked;
}

} // namespace evod::evolution
