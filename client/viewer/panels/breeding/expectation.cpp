#include "client/viewer/panels/breeding/expectation.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numeric>
#include <string>
#include <string_view>
#include <type_traits>

namespace evod::viewer {

namespace {

using Method = Selection::Method;
using Scaling = Selection::Scaling;

/// `share` of `count`, to the nearest, half up; at least 1.
std::uint32_t share_of(std::uint32_t count, double share) {
    return std::max(1u, std::min(count, static_cast<std::uint32_t>(share * count + 0.5)));
}

// ---- distributions ---------------------------------------------------------------------------------------------

double log_choose(double of, double choose) {
    return std::lgamma(of + 1) - std::lgamma(choose + 1) - std::lgamma(of - choose + 1);
}

/// Calls visit(number, chance) for the numbers below `end` that have a chance worth speaking of, rising.
///
/// chance_of  the chance of a number, from nothing but it.
/// ratio      the chance of the next number divided by the chance of this one.
template <class ChanceOf, class Ratio, class Visit>
void visit_near(double mean, double deviation, double least, double greatest, double end, ChanceOf chance_of,
                Ratio ratio, Visit visit) {
    const double reach = 10 * deviation + 30; // beyond it lies less than 10^-20
    double number = std::max(least, std::floor(mean - reach));
    const double last = std::min({greatest, std::ceil(mean + reach), end - 1});
    if (number > last) {
        return;
    }
    for (double chance = chance_of(number);; chance *= ratio(number), ++number) {
        visit(number, chance);
        if (number >= last) {
            return;
        }
    }
}

/// How often something of this chance happens in so many trials; visits as above.
template <class Visit>
void visit_binomial(double trials, double chance, double end, Visit visit) {
    if (chance <= 0 || chance >= 1) {
        const double number = chance <= 0 ? 0 : trials;
        if (number < end) {
            visit(number, 1.0);
        }
        return;
    }
    const auto chance_of = [=](double number) {
        return std::exp(log_choose(trials, number) + number * std::log(chance) +
                        (trials - number) * std::log1p(-chance));
    };
    visit_near(
        trials * chance, std::sqrt(trials * chance * (1 - chance)), 0, trials, end, chance_of,
        [=](double number) { return (trials - number) / (number + 1) * chance / (1 - chance); }, visit);
}

/// How many marked ones are among so many drawn without putting any back; visits as above.
template <class Visit>
void visit_hypergeometric(double all, double marked, double drawn, double end, Visit visit) {
    if (all <= 0) {
        visit(0.0, 1.0);
        return;
    }
    const double share = marked / all, whole = log_choose(all, drawn);
    visit_near(
        drawn * share, std::sqrt(drawn * share * (1 - share)), std::max(0.0, drawn + marked - all),
        std::min(marked, drawn), end,
        [=](double number) {
            return std::exp(log_choose(marked, number) + log_choose(all - marked, drawn - number) - whole);
        },
        [=](double number) {
            return (marked - number) / (number + 1) * ((drawn - number) / (all - marked - drawn + number + 1));
        },
        visit);
}

// ---- what each rank wins of one tournament ---------------------------------------------------------------------

struct Wins {
    double mean = 0;
    double square = 0; // mean of the square
    double none = 1;   // chance of no win
};

/// The rank wins once if it is drawn and fewer than `winners` of those drawn are better.
Wins wins_of_different(double population, double rank, double size, double winners) {
    double place_left = 0;
    visit_hypergeometric(population - 1, rank, size - 1, winners, [&](double, double chance) { place_left += chance; });
    const double wins = size / population * std::min(place_left, 1.0);
    return {wins, wins, 1 - wins};
}

/// It may be drawn several times, and win as often as there is a place left by the better ones.
Wins wins_of_repeated(double population, double rank, double size, double winners) {
    if (winners == 1) { // ((n−r)^k − (n−r−1)^k) / n^k
        const double wins =
            std::pow((population - rank) / population, size) - std::pow((population - rank - 1) / population, size);
        return {wins, wins, 1 - wins};
    }
    Wins wins{0, 0, 0};
    double some = 0;
    visit_binomial(size, 1 / population, size + 1, [&](double drawn, double chance_drawn) {
        if (drawn == 0) {
            return;
        }
        const double better_chance = population > 1 ? rank / (population - 1) : 0;
        visit_binomial(size - drawn, better_chance, winners, [&](double better, double chance) {
            const double won = std::min(drawn, winners - better);
            wins.mean += chance_drawn * chance * won;
            wins.square += chance_drawn * chance * won * won;
            some += chance_drawn * chance;
        });
    });
    wins.none = std::max(1 - some, 0.0);
    return wins;
}

Expectation expect_of_tournaments(const Selection& selection) {
    const double population = selection.population;
    const bool replacement = selection.tournament_replacement;
    const std::uint32_t size = std::max(
        replacement ? selection.tournament_size : std::min(selection.tournament_size, selection.population), 1u);
    const std::uint32_t winners =
        std::max(std::min({selection.tournament_winners, size, std::max(selection.picks, 1u)}), 1u);
    const std::uint32_t whole = selection.picks / winners, rest = selection.picks % winners; // the last drops a surplus
    const auto wins_at = [&](double rank, double places) {
        return replacement ? wins_of_repeated(population, rank, size, places)
                           : wins_of_different(population, rank, size, places);
    };
    Expectation expectation;
    for (std::uint32_t rank = 0; rank < selection.population; ++rank) {
        const Wins each = wins_at(rank, winners);
        const Wins last = rest > 0 ? wins_at(rank, rest) : Wins{};
        const auto variance = [](const Wins& wins) { return std::max(wins.square - wins.mean * wins.mean, 0.0); };
        expectation.copies.push_back(whole * each.mean + last.mean);
        expectation.standard_error.push_back(std::sqrt(whole * variance(each) + variance(last)));
        expectation.missed.push_back(std::pow(each.none, whole) * last.none);
    }
    return expectation;
}

// ---- wheels ----------------------------------------------------------------------------------------------------

/// The width of each slot, best first; the sum is 1.
std::vector<double> slots_of(const Selection& selection, std::span<const double> fitness) {
    const std::uint32_t population = selection.population;
    std::vector<double> slots(population, 1.0);
    const bool by_fitness = selection.scaling == Scaling::None || selection.scaling == Scaling::Windowing;
    if (selection.scaling == Scaling::LinearRanking && population > 1) {
        const double pressure = selection.ranking_pressure;
        for (std::uint32_t rank = 0; rank < population; ++rank) {
            slots[rank] = pressure - 2 * (pressure - 1) * rank / (population - 1.0);
        }
    } else if (selection.scaling == Scaling::ExponentialRanking) {
        for (std::uint32_t rank = 1; rank < population; ++rank) {
            slots[rank] = slots[rank - 1] * selection.ranking_decay;
        }
    } else if (by_fitness && !fitness.empty()) {
        // Quarters, as a difference of two doubles may be more than a double holds.
        const double least = fitness.back() / 4;
        const double floor = selection.scaling == Scaling::Windowing ? least : std::min(least, 0.0);
        const double greatest = fitness.front() / 4 - floor;
        for (std::uint32_t rank = 0; greatest > 0 && rank < population; ++rank) {
            slots[rank] = (fitness[rank] / 4 - floor) / greatest;
        }
    }
    const double all = std::accumulate(slots.begin(), slots.end(), 0.0);
    for (double& slot : slots) {
        slot /= all;
    }
    return slots;
}

/// Exactly ⌊copies⌋ or ⌈copies⌉, which is what universal sampling, truncation and the drawing of everyone in turn do.
void add_rounded(Expectation& expectation, double copies) {
    const double nearest = std::round(copies);
    // To within the rounding of a sum of doubles a whole number is one.
    const double part = std::abs(copies - nearest) < 1e-9 * std::max(copies, 1.0) ? 0 : copies - std::floor(copies);
    expectation.copies.push_back(copies);
    expectation.standard_error.push_back(std::sqrt(part * (1 - part)));
    expectation.missed.push_back(std::max(0.0, 1 - copies));
}

} // namespace

Selection selection_of(const google::protobuf::RepeatedPtrField<evod::v1::ParameterAssignment>& parameters,
                       std::uint32_t present, std::uint32_t wanted) {
    Selection selection;
    double survivors = 0.5;
    std::uint32_t elite = 0, replaced = 2;
    std::string_view model = "hybrid";
    for (const evod::v1::ParameterAssignment& parameter : parameters) {
        const std::string& name = parameter.name();
        const evod::v1::ParameterValue& value = parameter.value();
        const auto choose = [&](auto& choice, std::initializer_list<std::string_view> names) {
            const auto found = std::find(names.begin(), names.end(), value.choice());
            if (found != names.end()) {
                choice = static_cast<std::remove_reference_t<decltype(choice)>>(found - names.begin());
            }
        };
        if (name == "selection") {
            choose(selection.method, {"roulette", "stochastic_universal", "tournament", "random", "truncation"});
        } else if (name == "fitness_scaling") {
            choose(selection.scaling, {"none", "windowing", "linear_ranking", "exponential_ranking"});
        } else if (name == "population_model") {
            model = value.choice();
        } else if (name == "ranking_pressure") {
            selection.ranking_pressure = value.real();
        } else if (name == "ranking_decay") {
            selection.ranking_decay = value.real();
        } else if (name == "tournament_size") {
            selection.tournament_size = value.count();
        } else if (name == "tournament_winners") {
            selection.tournament_winners = value.count();
        } else if (name == "tournament_replacement") {
            selection.tournament_replacement = value.flag();
        } else if (name == "survivors") {
            survivors = value.real();
        } else if (name == "elite_count") {
            elite = value.count();
        } else if (name == "replaced_count") {
            replaced = value.count();
        }
    }
    selection.population = std::max(present, 1u);
    const std::uint32_t common = std::min(present, wanted);
    elite = std::min(elite, common);
    if (model == "hybrid") { // the picked survive, and breed
        selection.picks = std::max(share_of(wanted, survivors), elite);
        selection.pool = selection.population;
    } else {
        selection.overlapping = model == "steady_state";
        const std::uint32_t stay = selection.overlapping ? common - std::min(replaced, common) : 0;
        const std::uint32_t children = wanted - std::min(std::max(stay, elite), wanted);
        selection.picks = children > 0 ? std::max(2u, children) : 0;
        selection.pool = share_of(selection.population, survivors);
    }
    return selection;
}

Expectation expect(const Selection& selection, std::span<const double> fitness) {
    if (selection.method == Method::Tournament) {
        return expect_of_tournaments(selection);
    }
    Expectation expectation;
    const double picks = selection.picks;
    if (selection.turns_a_wheel()) {
        for (const double slot : slots_of(selection, fitness)) {
            if (selection.method == Method::StochasticUniversal) {
                add_rounded(expectation, picks * slot);
                continue;
            }
            expectation.copies.push_back(picks * slot);
            expectation.standard_error.push_back(std::sqrt(picks * slot * (1 - slot)));
            expectation.missed.push_back(std::pow(1 - slot, picks));
        }
        return expectation;
    }
    for (std::uint32_t rank = 0; rank < selection.population; ++rank) {
        if (selection.method == Method::Random) {
            add_rounded(expectation, picks / selection.population);
        } else {
            const bool in_pool = rank < selection.pool;
            const std::uint32_t surplus = selection.picks % selection.pool;
            add_rounded(expectation, in_pool ? selection.picks / selection.pool + (rank < surplus ? 1 : 0) : 0);
        }
    }
    return expectation;
}

} // namespace evod::viewer
