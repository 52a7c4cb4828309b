// Compares colonies with theory: growth, encounters, size and drift of populations whose law has a closed form.
//
// Theory assumes that every organism meets every other one equally often. A MixedIsland fulfils this: before every
// tick, it puts all organisms at new random places. Worlds whose organisms move on their own are used where theory
// allows it.
//
// Seeds are literals, so a test always gives the same numbers. Statistical tests allow 4 standard errors: a correct
// program would fail with 6e-5 of all seeds (two-sided). Other tolerances are stated with their reasons. docs/MODEL.md,
// "Laws of colonies", contains the measured figures.
#include "server/base/inline_executor.h"
#include "server/simulation/island.h"
#include "server/simulation/world.h"
#include "tests/support/everyday.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace evod::simulation {
namespace {

using parameters::Births;
using parameters::Parameters;

const std::uint64_t repeats = everyday_size("REPEATS", 1); // --long: more worlds

double square(double x) {
    return x * x;
}

/// Asexual births in every tick; no mutation, no poison, no death of age; organisms do not move on their own.
Parameters mixed(double width_px, double height_px) {
    Parameters p;
    p.reproduction = parameters::Reproduction::Births;
    p.births = p.predator_births = Births::Asexual;
    p.island_width_px = width_px;
    p.island_height_px = height_px;
    p.spawn_margin_px = 50; // no organism that touches an item touches a wall
    p.food_count = p.poison_count = 0;
    p.mutation_chance = p.predator_mutation_chance = 0;
    p.force_per_unit = 0;
    p.birth_every_s = p.tick_s;
    return p;
}

/// All genes are 100 except the health at birth.
evolution::GeneMatrix equal_genes(std::uint32_t organisms, float base_health) {
    evolution::GeneMatrix genes = evolution::GeneMatrix::Constant(evolution::body_gene_count, organisms, 100);
    genes.row(evolution::BaseHealth) = base_health;
    return genes;
}

/// An island whose organisms are at rest at new places before every tick, each independent and uniform within the
/// walls. Every tick is an interval of its own, which begins with these places.
class MixedIsland {
  public:
    MixedIsland(const Parameters& parameters, std::uint64_t seed, evolution::GeneMatrix genes, std::uint32_t predators)
        : parameters_{parameters}, island_{base::Seed{seed}, 0}, seed_{seed} {
        evolution::NextGeneration born;
        born.genes = std::move(genes);
        born.predator_count = parameters_.predator_count = predators;
        island_.begin_generation(parameters_, interval_, std::move(born), executor_);
    }
    /// Begins the next interval. `change` may change what the island hands over to it, except places.
    void begin(const std::function<void(Island::Continuation&)>& change = {}) {
        Island::Continuation next = island_.continuation(parameters_, tick_, executor_);
        if (change) {
            change(next);
        }
        const base::RandomKey key{base::Seed{seed_}, base::Purpose::OrganismPlacement, 0, ++interval_};
        const physics::Area& area = island_.area();
        for (std::uint32_t id = 0; id < next.opening.state.organisms.size(); ++id) {
            IslandState::Organism& organism = next.opening.state.organisms[id];
            const float radius_px = body_shape(next.bred.genes(evolution::BodySize, id), parameters_).radius_px;
            const auto margin = static_cast<double>(physics::to_units(radius_px));
            base::RandomStream random{key, id};
            organism.x = static_cast<physics::Coordinate>(random.uniform(margin, area.width - margin));
            organism.y = static_cast<physics::Coordinate>(random.uniform(margin, area.height - margin));
            organism.velocity_x = organism.velocity_y = 0;
        }
        island_.begin_generation(parameters_, interval_, std::move(next.bred), executor_, std::move(next.opening));
        tick_ = 0;
    }
    void tick() {
        island_.advance_tick(parameters_, 1, executor_);
        tick_ = 1;
    }
    void remove(std::uint32_t id) { island_.remove_organism(id, tick_); }
    const Island& island() const { return island_; }
    std::uint32_t living(Species species) const {
        return island_.colony_counts()[static_cast<std::size_t>(species)].living;
    }

  private:
    Parameters parameters_;
    Island island_;
    base::InlineExecutor executor_;
    std::uint64_t seed_, interval_ = 1;
    std::uint32_t tick_ = 0;
};

/// The chance that an organism of equal_genes() touches a certain item in a tick of a MixedIsland.
double contact_chance(const Parameters& p) {
    const double radius_px = 100 * p.radius_per_unit_px;
    return std::numbers::pi * square(radius_px + p.item_radius_px) /
           ((p.island_width_px - 2 * radius_px) * (p.island_height_px - 2 * radius_px));
}

/// The slope of the line through these points, by least squares.
double slope_of(std::span<const double> x, std::span<const double> y) {
    const auto n = static_cast<double>(x.size());
    double sum_x = 0, sum_y = 0, xx = 0, xy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        sum_x += x[i];
        sum_y += y[i];
        xx += x[i] * x[i];
        xy += x[i] * y[i];
    }
    return (n * xy - sum_x * sum_y) / (n * xx - sum_x * sum_x);
}

struct Moments {
    double mean, variance;
    explicit Moments(std::span<const double> values) {
        const auto n = static_cast<double>(values.size());
        mean = variance = 0;
        for (const double value : values) {
            mean += value / n;
        }
        for (const double value : values) {
            variance += square(value - mean) / (n - 1);
        }
    }
};

// Predators find prey in proportion to the product of their numbers. The slope may be 0.1 less or more: of two prey
// near one predator, only one is eaten, which concerns at most 4 % of the meals here.
TEST(MassAction, MealsGrowWithPreyAndWithPredators) {
    Parameters p = mixed(2000, 2000);
    p.health_loss_per_s = p.predator_health_loss_per_s = 0;
    p.birth_health = p.predator_birth_health = 10'000;
    p.handling_s = 0;
    constexpr int ticks = 4'000;
    std::vector<double> log_prey, log_predators, log_meals;
    double meals_of_all = 0, pairs_of_all = 0;
    for (const std::uint32_t prey : {50u, 100u, 200u}) {
        for (const std::uint32_t predators : {10u, 20u, 40u}) {
            MixedIsland mixed{p, 1000 * prey + predators, equal_genes(prey + predators, 100), predators};
            std::optional<Island::Continuation> first; // with all prey, from which every tick begins
            double meals = 0;
            for (int i = 0; i < ticks; ++i) {
                mixed.begin([&](Island::Continuation& next) { next = first ? *first : first.emplace(next); });
                mixed.tick();
                meals += mixed.island().colony_counts()[0].eaten;
            }
            log_prey.push_back(std::log(prey));
            log_predators.push_back(std::log(predators));
            log_meals.push_back(std::log(meals / ticks));
            meals_of_all += meals;
            pairs_of_all += double{ticks} * prey * predators;
        }
    }
    const double of_prey = slope_of(log_prey, log_meals), of_predators = slope_of(log_predators, log_meals);
    std::printf("meals per tick: prey^%.3f, predators^%.3f, %.3e per pair\n", of_prey, of_predators,
                meals_of_all / pairs_of_all);
    EXPECT_NEAR(of_prey, 1, 0.1);
    EXPECT_NEAR(of_predators, 1, 0.1);
}

// Each organism has a child with the chance λ and dies with the chance μ in a tick, independently of all others: it has
// a child after each food item, and dies of each poison item. The size of the population is then a branching process
// with the growth m = (1 − μ)(1 + λ) and the variance σ² = (1 − μ)(1 + 3λ) − m² per organism and tick, whose mean and
// variance after t ticks are N m^t and N σ² m^(t−1) (m^t − 1)/(m − 1) (Harris 1963, "The theory of branching
// processes", I.5). In short ticks, this is Kendall's birth–death process.
struct BirthsAndDeaths {
    std::uint32_t food, poison;
};
class BranchingTest : public testing::TestWithParam<BirthsAndDeaths> {};

TEST_P(BranchingTest, SizeHasTheMeanAndTheVarianceOfTheory) {
    Parameters p = mixed(2000, 2000);
    p.food_count = GetParam().food;
    p.poison_count = GetParam().poison;
    p.health_loss_per_s = 0;
    p.food_health = 25; // of an organism of 20 health; the child gets 20, and the birth costs 5
    p.birth_health = 45;
    p.birth_cost = 5;
    p.poison_harm = 10'000;
    const std::uint64_t worlds = 200 * repeats;
    constexpr std::uint32_t organisms = 50;
    constexpr int ticks = 30;
    std::vector<double> sizes;
    for (std::uint64_t world = 1; world <= worlds; ++world) {
        MixedIsland mixed{p, world, equal_genes(organisms, 20), 0};
        for (int i = 0; i < ticks && mixed.living(Species::Prey) > 0; ++i) {
            mixed.begin();
            mixed.tick();
        }
        sizes.push_back(mixed.living(Species::Prey));
    }
    const double contact = contact_chance(p);
    const double birth = GetParam().food * contact, death = 1 - std::pow(1 - contact, GetParam().poison);
    const double growth = (1 - death) * (1 + birth), squared = (1 - death) * (1 + 3 * birth) - square(growth);
    const double grown = std::pow(growth, ticks);
    const double sum = std::abs(growth - 1) < 1e-9 ? ticks : (grown - 1) / (growth - 1); // 1 + m + … + m^(t−1)
    const double mean = organisms * grown, variance = organisms * squared * grown / growth * sum;
    const Moments measured{sizes};
    std::printf("food %u, poison %u: size %.2f (theory %.2f), variance %.1f (theory %.1f)\n", p.food_count,
                p.poison_count, measured.mean, mean, measured.variance, variance);
    EXPECT_NEAR(measured.mean, mean, 4 * std::sqrt(variance / static_cast<double>(worlds)));
    // Sizes are almost normal, so the standard error of their variance is √(2/(n − 1)) of it.
    EXPECT_NEAR(measured.variance, variance, 4 * variance * std::sqrt(2 / static_cast<double>(worlds - 1)));
}

INSTANTIATE_TEST_SUITE_P(Rates, BranchingTest,
                         testing::Values(BirthsAndDeaths{200, 100}, BirthsAndDeaths{200, 200},
                                         BirthsAndDeaths{100, 200}),
                         [](const auto& rates) {
                             return "food" + std::to_string(rates.param.food) + "poison" +
                                    std::to_string(rates.param.poison);
                         });

// One organism of N has a child, and one dies, both drawn at random (Moran 1958). The chance H that two draws, with
// replacement, find different alleles falls by the factor 1 − 2/N² per birth.
TEST(MoranDrift, HeterozygosityFallsByTheLaw) {
    Parameters p = mixed(1000, 1000);
    p.health_loss_per_s = p.birth_cost = 0;
    p.birth_health = 100;
    const std::uint64_t worlds = 400 * repeats;
    constexpr std::uint32_t organisms = 10;
    constexpr int births = 35;
    std::vector<double> heterozygosities;
    for (std::uint64_t world = 1; world <= worlds; ++world) {
        evolution::GeneMatrix genes = equal_genes(organisms, 20);
        genes.row(evolution::PoisonRadius).head(organisms / 2) = 50; // neutral: the world has no poison
        MixedIsland mixed{p, world, genes, 0};
        base::RandomStream random{base::RandomKey{base::Seed{world}, base::Purpose::BirthParents, 0, 0}, 0};
        for (int i = 0; i < births; ++i) {
            const std::uint32_t parent = random.below(organisms), dies = random.below(organisms);
            mixed.begin([&](Island::Continuation& next) {
                for (std::uint32_t id = 0; id < organisms; ++id) {
                    next.opening.state.organisms[id].health = id == parent ? 100 : 60;
                }
            });
            mixed.tick();
            ASSERT_EQ(mixed.living(Species::Prey), organisms + 1);
            mixed.remove(dies);
        }
        mixed.begin();
        const auto first =
            static_cast<double>((mixed.island().born().genes.row(evolution::PoisonRadius) == 50).count());
        heterozygosities.push_back(2 * first * (organisms - first) / square(organisms));
    }
    const Moments measured{heterozygosities};
    const double expected = 0.5 * std::pow(1 - 2 / square(organisms), births);
    const double error = std::sqrt(measured.variance / static_cast<double>(worlds));
    std::printf("H %.4f, standard error %.4f (theory %.4f)\n", measured.mean, error, expected);
    EXPECT_NEAR(measured.mean, expected, 3 * error) << "0.3 % of all seeds would fail";
}

std::size_t rounded(double x) {
    return static_cast<std::size_t>(std::lround(x));
}

/// The mean number of organisms of each health: element i of those with i times the health that a tick of life costs.
using ByHealth = std::vector<double>;

double sum_of(const ByHealth& organisms) {
    return std::accumulate(organisms.begin(), organisms.end(), 0.0);
}

/// What a tick costs organisms that are equal but for their health.
struct LifeCosts {
    std::size_t birth, child, price; // birth_health, the health of a child, and what the parent pays

    LifeCosts(const Parameters& p, double base_health)
        : birth{rounded(p.birth_health / (p.health_loss_per_s * p.tick_s))}
        , child{rounded(base_health / (p.health_loss_per_s * p.tick_s))}
        , price{rounded((base_health + p.birth_cost) / (p.health_loss_per_s * p.tick_s))} {}
    /// Takes the cost of a tick from all organisms. Those with health 0 have died, unless they eat in this tick.
    static void live(ByHealth& organisms) {
        std::shift_left(organisms.begin(), organisms.end(), 1);
        organisms.back() = 0;
    }
    /// Lets the parents in `organisms` pay, and adds their children to `to`.
    void bear(ByHealth& organisms, ByHealth& to) const {
        for (std::size_t health = birth; health < organisms.size(); ++health) {
            const double parents = std::exchange(organisms[health], 0);
            organisms[health - price] += parents;
            to[child] += parents;
        }
    }
};

/// The equations of prey that meet their food by mass action, tick by tick in the order of docs/MODEL.md.
class PreyEquations {
  public:
    PreyEquations(const Parameters& p, double organisms, double base_health)
        : costs_{p, base_health}
        , meal_{rounded(p.food_health / (p.health_loss_per_s * p.tick_s))}
        , contact_{contact_chance(p)}
        , organisms_(costs_.birth + 8 * meal_)
        , eaten_(rounded(p.respawn_s / p.tick_s))
        , food_(p.food_count) {
        organisms_[costs_.child] = organisms;
    }
    double size() const { return sum_of(organisms_); }
    /// hunt  hunt(living prey) returns the number that predators eat.
    template <class Hunt>
    void tick(Hunt&& hunt) {
        food_ += eaten_[now_];
        const double meals = food_ * (1 - std::pow(1 - contact_, size())), per_organism = meals / size();
        food_ -= meals;
        eaten_[now_] = meals; // they reappear when now_ has come round
        now_ = (now_ + 1) % eaten_.size();
        LifeCosts::live(organisms_);
        ByHealth fed(organisms_.size());
        for (std::size_t health = 0; health < organisms_.size(); ++health) {
            double chance = std::exp(-per_organism); // of k meals: Poisson
            for (std::size_t k = 0; k < 8 && health + k * meal_ < fed.size(); ++k) {
                fed[health + k * meal_] += organisms_[health] * chance;
                chance *= per_organism / static_cast<double>(k + 1);
            }
        }
        fed[0] = 0;
        organisms_ = std::move(fed);
        const double living = size(), kept = 1 - hunt(living) / living;
        for (double& of_health : organisms_) {
            of_health *= kept;
        }
        costs_.bear(organisms_, organisms_);
    }

  private:
    LifeCosts costs_;
    std::size_t meal_;
    double contact_;
    ByHealth organisms_;
    std::vector<double> eaten_; // by tick, from which on they are due
    double food_;
    std::size_t now_ = 0;
};

// Prey that only starvation kills grow until they find no more food than they need. The mean of 20 worlds may differ
// by 5 % from the equations of food and health, which neglect chance (everyday: of 4 worlds).
TEST(LogisticGrowth, FollowsTheEquationsOfFoodAndHealth) {
    Parameters p = mixed(1280, 720);
    p.tick_s = p.birth_every_s = 1.0 / 12; // a tick of life costs 0.5 health
    p.radius_per_unit_px = 0.02;
    p.item_radius_px = 2;
    p.food_count = 5'000;
    p.food_health = 5;
    p.respawn_s = 10;
    const std::uint64_t worlds = 4 * repeats;
    constexpr std::uint32_t organisms = 40;
    constexpr int ticks = 1'200, between = 120;
    std::vector<MixedIsland> islands;
    for (std::uint64_t world = 1; world <= worlds; ++world) {
        islands.emplace_back(p, world, equal_genes(organisms, 50), 0);
    }
    PreyEquations theory{p, organisms, 50};
    for (int tick = 1; tick <= ticks; ++tick) {
        theory.tick([](double) { return 0; });
        double size = 0;
        for (MixedIsland& mixed : islands) {
            mixed.begin();
            mixed.tick();
            size += mixed.living(Species::Prey) / static_cast<double>(worlds);
        }
        if (tick % between == 0) {
            std::printf("%3.0f s: %.1f prey (theory %.1f)\n", tick * p.tick_s, size, theory.size());
            EXPECT_NEAR(size / theory.size(), 1, 0.05) << tick;
        }
    }
}

// At rest, what prey eat pays for life and births: N = (food_health · food eaten − birth_cost · births) / loss per s.
// Here organisms move on their own. The size may differ by 2 %, because their stock of health changes a little.
TEST(LogisticGrowth, SizeAtRestIsWhatFoodPaysFor) {
    Parameters p;
    p.reproduction = parameters::Reproduction::Births;
    p.births = Births::Asexual;
    p.food_count = 250;
    p.poison_count = 0;
    p.respawn_s = 5;
    p.mutation_chance = 0;
    base::InlineExecutor executor;
    World world{p, base::Seed{1}};
    constexpr std::uint64_t begun = 5, intervals = 20;
    double size = 0, income = 0;
    while (world.history().size() < begun + intervals) {
        world.advance_tick(executor);
        if (world.generation_over() && world.history().size() > begun) {
            const GenerationStatistics& s = world.history().back().front();
            size += s.colony->count_mean / intervals;
            income += (p.food_health * static_cast<double>(s.food_eaten) - p.birth_cost * s.colony->born_count) /
                      (intervals * p.generation_s);
        }
    }
    std::printf("at rest: %.1f prey (account %.1f)\n", size, income / p.health_loss_per_s);
    EXPECT_NEAR(size / (income / p.health_loss_per_s), 1, 0.02);
}

/// The equations of predators that meet prey by mass action and handle each meal, tick by tick.
class PredatorEquations {
  public:
    /// p       of the predators.
    /// chance  that a predator reaches a certain prey in a tick.
    PredatorEquations(const Parameters& p, double organisms, double base_health, double chance)
        : costs_{p, base_health}
        , meal_{rounded(p.prey_health / (p.health_loss_per_s * p.tick_s))}
        , chance_{chance}
        , hunting_(costs_.birth + 2 * meal_)
        , handling_(rounded(p.handling_s / p.tick_s) + 1, hunting_) {
        hunting_[costs_.child] = organisms;
    }
    double size() const {
        return std::accumulate(handling_.begin(), handling_.end(), sum_of(hunting_),
                               [](double sum, const ByHealth& predators) { return sum + sum_of(predators); });
    }
    /// Performs a tick among so many prey. Returns how many of them are eaten.
    double tick(double prey) {
        const auto live = [](ByHealth& predators) {
            LifeCosts::live(predators);
            predators[0] = 0;
        };
        live(hunting_);
        std::ranges::for_each(handling_, live);
        ByHealth& done = handling_[now_]; // they have handled their meal
        std::ranges::transform(hunting_, done, hunting_.begin(), std::plus{});
        const double claims = sum_of(hunting_) * (1 - std::exp(-chance_ * prey)); // each of one prey
        const double eaten = prey * (1 - std::exp(-claims / prey)), share = eaten / sum_of(hunting_);
        std::ranges::fill(done, 0);
        for (std::size_t health = 0; health + meal_ < done.size(); ++health) {
            done[health + meal_] = share * hunting_[health];
            hunting_[health] *= 1 - share;
        }
        now_ = (now_ + 1) % handling_.size();
        costs_.bear(hunting_, hunting_);
        std::ranges::for_each(handling_, [&](ByHealth& predators) { costs_.bear(predators, hunting_); });
        return eaten;
    }

  private:
    LifeCosts costs_;
    std::size_t meal_;
    double chance_;
    ByHealth hunting_;
    std::vector<ByHealth> handling_; // by the tick in which they ate
    std::size_t now_ = 0;
};

/// The correlation of a[t] and b[t + lag].
double correlation(std::span<const double> a, std::span<const double> b, std::size_t lag) {
    a = a.first(a.size() - lag);
    b = b.subspan(lag);
    const Moments of_a{a}, of_b{b};
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        sum += (a[i] - of_a.mean) * (b[i] - of_b.mean);
    }
    return sum / (static_cast<double>(a.size()) - 1) / std::sqrt(of_a.variance * of_b.variance);
}

// Prey that food limits, and predators that handle their prey (Rosenzweig & MacArthur 1963): their mean numbers may
// differ by 10 % from the equations, which neglect chance. The peaks of predators follow those of prey by 1/8 to 3/8 of
// a period.
TEST(PreyAndPredators, FollowTheEquationsOfRosenzweigAndMacArthur) {
    Parameters p = mixed(2560, 1440);
    p.tick_s = p.birth_every_s = 1.0 / 12;
    p.radius_per_unit_px = 0.04;
    p.item_radius_px = 5;
    p.food_count = 1'500;
    p.respawn_s = 4.5;
    p.predator_birth_health = 160;
    const std::uint64_t worlds = repeats;
    constexpr std::uint32_t prey = 300, predators = 250;
    constexpr int ticks = 12'000, begun = 3'600, every = 12;
    const double reach_px = 200 * p.radius_per_unit_px + 1;
    const double chance = contact_chance(p) * square(reach_px / (100 * p.radius_per_unit_px + p.item_radius_px));
    std::vector<MixedIsland> islands;
    for (std::uint64_t world = 1; world <= worlds; ++world) {
        islands.emplace_back(p, world, equal_genes(prey + predators, 50), predators);
    }
    PreyEquations prey_theory{p, prey, 50};
    PredatorEquations predator_theory{parameters::of_predators(p), predators, 50, chance};
    std::vector<std::vector<double>> prey_of(worlds), predators_of(worlds);
    double prey_mean = 0, predators_mean = 0, prey_expected = 0, predators_expected = 0;
    for (int tick = 1; tick <= ticks; ++tick) {
        prey_theory.tick([&](double living) { return predator_theory.tick(living); });
        const bool is_counted = tick > begun && tick % every == 0;
        constexpr double moments = double{ticks - begun} / every;
        if (is_counted) {
            prey_expected += prey_theory.size() / moments;
            predators_expected += predator_theory.size() / moments;
        }
        for (std::size_t world = 0; world < worlds; ++world) {
            islands[world].begin();
            islands[world].tick();
            if (is_counted) {
                prey_of[world].push_back(islands[world].living(Species::Prey));
                predators_of[world].push_back(islands[world].living(Species::Predator));
                prey_mean += prey_of[world].back() / moments / static_cast<double>(worlds);
                predators_mean += predators_of[world].back() / moments / static_cast<double>(worlds);
            }
        }
    }
    const auto mean_correlation = [&](const auto& a, const auto& b, std::size_t lag) {
        double sum = 0;
        for (std::size_t world = 0; world < worlds; ++world) {
            sum += correlation(a[world], b[world], lag) / static_cast<double>(worlds);
        }
        return sum;
    };
    std::size_t period = 1, lag = 0; // in samples, which are 1 s apart
    while (mean_correlation(prey_of, prey_of, period) > 0) {
        ++period; // to the first lag at which prey are not correlated with themselves: a quarter of the period
    }
    period *= 4;
    for (std::size_t k = 0; k < period; ++k) {
        lag = mean_correlation(prey_of, predators_of, k) > mean_correlation(prey_of, predators_of, lag) ? k : lag;
    }
    std::printf("prey %.1f (theory %.1f), predators %.1f (theory %.1f), period %zu s, lag %zu s, correlation %.2f\n",
                prey_mean, prey_expected, predators_mean, predators_expected, period, lag,
                mean_correlation(prey_of, predators_of, lag));
    EXPECT_NEAR(prey_mean / prey_expected, 1, 0.1);
    EXPECT_NEAR(predators_mean / predators_expected, 1, 0.1);
    EXPECT_GE(8 * lag, period);
    EXPECT_LE(8 * lag, 3 * period);
}

// A neutral gene of a colony of constant size: the chance H that two organisms have different alleles falls by V/(B L²)
// per s, with B births per s, parents of the mean age L, and the variance V of the copies of a gene that an organism
// leaves: that of its children, or with two parents (their variance + their mean)/4, as half of them inherit it (Hill
// 1972, Genet. Res. 19, 9). B, L and V are measured. Drift may differ by 15 %; its standard error is 4 to 8 %.
class ColonyDrift : public testing::Test {
  protected:
    static constexpr std::uint64_t begun_s = 400, settled_s = 600, ended_s = 1'800;

    ColonyDrift() {
        parameters = mixed(1280, 720);
        parameters.tick_s = parameters.birth_every_s = 1.0 / 10;
        parameters.food_count = 250;
        parameters.respawn_s = 5;
        parameters.lifespan_s = 120;
        parameters.free_genes = 10; // neutral
    }
    evolution::GeneMatrix first_genes() const {
        evolution::GeneMatrix genes = evolution::GeneMatrix::Zero(evolution::gene_count(parameters), 100);
        genes.topRows(evolution::body_gene_count) = equal_genes(100, 60);
        return genes;
    }
    /// Gives every organism an allele of its own.
    void mark(Island::Continuation& next) const {
        for (Eigen::Index id = 0; id < next.bred.genes.cols(); ++id) {
            next.bred.genes.col(id).tail(parameters.free_genes) = 0x1p-10f * static_cast<float>(id);
        }
    }
    /// Adds the births and deaths of the interval that ends.
    void count(const Island& island) {
        const auto born = [&](std::uint32_t id) {
            return id < island.bred_count() ? -static_cast<double>(island.opening()->age_ticks[id])
                                            : static_cast<double>(island.placed_tick(id));
        };
        for (std::uint32_t id = 0; id < island.life_records().cause.size(); ++id) {
            if (id >= island.bred_count()) {
                const evolution::Parents parents = island.parents_of_child(id);
                births += 1;
                ages_s += (born(id) - (born(parents.first) + born(parents.second)) / 2) * parameters.tick_s;
            }
            if (island.life_records().cause[id] != CauseOfDeath::Alive) {
                children.push_back(island.life_records().children[id]);
            }
        }
    }
    /// ln H, with the mean of H over the free genes.
    double log_heterozygosity(const Island& island) const {
        const std::vector<std::uint32_t> living = island.breeders(Species::Prey);
        double same = 0;
        for (std::uint32_t gene = 0; gene < parameters.free_genes; ++gene) {
            std::map<float, double> copies;
            for (const std::uint32_t id : living) {
                ++copies[island.born().genes(evolution::body_gene_count + gene, id)];
            }
            for (const auto& [allele, count] : copies) {
                same += square(count / static_cast<double>(living.size())) / parameters.free_genes;
            }
        }
        return std::log(1 - same);
    }
    /// Compares the fall of ln H from settled_s to ended_s in each world with the law.
    void compare() const {
        const Moments of_children{children}, fall{falls};
        constexpr auto counted_s = static_cast<double>(ended_s - begun_s), measured_s = double{ended_s - settled_s};
        const auto worlds = static_cast<double>(falls.size());
        const double copies =
            parameters.births == Births::Sexual ? (of_children.variance + of_children.mean) / 4 : of_children.variance;
        const double births_per_s = births / (worlds * counted_s), age_s = ages_s / births;
        const double expected = copies / (births_per_s * square(age_s));
        std::printf("H falls by %.3e per s, standard error %.1e (theory %.3e: %.2f births per s by parents of %.1f s, "
                    "children %.2f, variance %.2f)\n",
                    fall.mean / measured_s, std::sqrt(fall.variance / worlds) / measured_s, expected, births_per_s,
                    age_s, of_children.mean, of_children.variance);
        EXPECT_NEAR(fall.mean / measured_s / expected, 1, 0.15);
    }

    Parameters parameters;
    double births = 0, ages_s = 0;       // ages of parents at births
    std::vector<double> children, falls; // of each organism that died; of ln H in each world
};

TEST_F(ColonyDrift, OfAColonyFollowsHillsLaw) {
    parameters.births = Births::Sexual;
    parameters.force_per_unit = 1;
    base::InlineExecutor executor;
    const auto ticks = static_cast<std::uint32_t>(std::lround(parameters.generation_s / parameters.tick_s));
    for (std::uint64_t seed = 1; seed <= 20 * repeats; ++seed) {
        Island island{base::Seed{seed}, 0};
        evolution::NextGeneration next;
        next.genes = first_genes();
        std::optional<IslandOpening> opening;
        double settled = 0;
        for (std::uint64_t interval = 1, time_s = 0; time_s < ended_s; ++interval) {
            island.begin_generation(parameters, interval, std::move(next), executor, std::move(opening));
            settled = time_s == settled_s ? log_heterozygosity(island) : settled;
            for (std::uint32_t tick = 1; tick <= ticks; ++tick) {
                island.advance_tick(parameters, tick, executor);
            }
            if (time_s >= begun_s) {
                count(island);
            }
            time_s += static_cast<std::uint64_t>(parameters.generation_s);
            Island::Continuation continuation = island.continuation(parameters, ticks, executor);
            if (time_s == begun_s) {
                mark(continuation);
            }
            next = std::move(continuation.bred);
            opening = std::move(continuation.opening);
        }
        falls.push_back(settled - log_heterozygosity(island));
    }
    compare();
}

// The law assumes that parents and children live independently. Where organisms move on their own, a child is born next
// to its only parent, and drift is a quarter slower (docs/MODEL.md).
TEST_F(ColonyDrift, OfOneParentFollowsHillsLawIfMixed) {
    if (repeats == 1) {
        GTEST_SKIP() << "scripts/test --long: few worlds would say little";
    }
    const auto ticks_per_s = static_cast<std::uint64_t>(std::lround(1 / parameters.tick_s));
    for (std::uint64_t seed = 1; seed <= 4 * repeats; ++seed) {
        MixedIsland mixed{parameters, seed, first_genes(), 0};
        double settled = 0;
        for (std::uint64_t tick = 0; tick < ended_s * ticks_per_s; ++tick) {
            mixed.begin([&](Island::Continuation& next) {
                if (tick == begun_s * ticks_per_s) {
                    mark(next);
                }
            });
            mixed.tick();
            settled = tick == settled_s * ticks_per_s ? log_heterozygosity(mixed.island()) : settled;
            if (tick >= begun_s * ticks_per_s) {
                count(mixed.island());
            }
        }
        falls.push_back(settled - log_heterozygosity(mixed.island()));
    }
    compare();
}

} // namespace
} // namespace evod::simulation
