#include "server/parameters/warnings.h"

#include <gmock/gmock.h>

namespace evod::parameters {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Warnings, TheDefaultsHaveNone) {
    EXPECT_THAT(warnings_of({}), IsEmpty());
}

TEST(Warnings, AGenerationNeedsPlacesForChildren) {
    Parameters elite;
    elite.elite_count = elite.population_size;
    EXPECT_THAT(warnings_of(elite), ElementsAre(AllOf(HasSubstr("elite_count 50"), HasSubstr("population_size 50"))));
    elite.elite_count = 49;
    EXPECT_THAT(warnings_of(elite), IsEmpty());
    Parameters survivors;
    survivors.survivors = 1;
    EXPECT_THAT(warnings_of(survivors), ElementsAre(HasSubstr("survivors 1")));
    survivors.population_model = evolution::PopulationModel::Generational;
    EXPECT_THAT(warnings_of(survivors), IsEmpty());
    Parameters steady;
    steady.population_model = evolution::PopulationModel::SteadyState;
    steady.replaced_count = 51;
    EXPECT_THAT(warnings_of(steady), ElementsAre(HasSubstr("replaced_count 51")));
    steady.replaced_count = 50;
    EXPECT_THAT(warnings_of(steady), IsEmpty());
}

TEST(Warnings, VariationNeedsMutationOrCrossover) {
    Parameters none;
    none.mutation_chance = 0;
    EXPECT_THAT(warnings_of(none), IsEmpty());
    none.crossover_chance = 0;
    EXPECT_THAT(warnings_of(none), ElementsAre(HasSubstr("mutation and crossover are off")));
    none.reset_chance = 0.1;
    EXPECT_THAT(warnings_of(none), IsEmpty());
    Parameters no_step;
    no_step.crossover = evolution::CrossoverMethod::None;
    no_step.mutation_step = 0;
    EXPECT_THAT(warnings_of(no_step), ElementsAre(HasSubstr("mutation and crossover are off")));
}

TEST(Warnings, SelectionNeedsFitness) {
    Parameters random;
    random.selection = evolution::SelectionMethod::Random;
    EXPECT_THAT(warnings_of(random), ElementsAre(HasSubstr("selection random")));
    random.elite_count = 1;
    EXPECT_THAT(warnings_of(random), IsEmpty());
    Parameters tournament;
    tournament.selection = evolution::SelectionMethod::Tournament;
    EXPECT_THAT(warnings_of(tournament), IsEmpty());
    tournament.tournament_size = 1;
    EXPECT_THAT(warnings_of(tournament), ElementsAre(HasSubstr("tournament_size 1")));
    Parameters ranking;
    ranking.fitness_scaling = evolution::FitnessScaling::LinearRanking;
    ranking.ranking_pressure = 1;
    EXPECT_THAT(warnings_of(ranking), ElementsAre(HasSubstr("ranking_pressure 1")));
}

TEST(Warnings, FoundersAtABoundAreEqual) {
    Parameters large;
    large.body_size_min = 150;
    EXPECT_THAT(warnings_of(large), ElementsAre(AllOf(HasSubstr("the same body_size"), HasSubstr("body_size_min 150"),
                                                      HasSubstr("initial_gene_max 120"))));
    Parameters small;
    small.impulse_max = 60;
    EXPECT_THAT(warnings_of(small), ElementsAre(HasSubstr("impulse_max 60")));
    small.impulse_min = 60; // fixed on purpose
    EXPECT_THAT(warnings_of(small), IsEmpty());
}

Parameters colony() {
    Parameters p;
    p.reproduction = Reproduction::Births;
    p.food_count = 250;
    p.respawn_s = 5;
    return p;
}

TEST(Warnings, AColonyNeedsFoodForBirths) {
    EXPECT_THAT(warnings_of(colony()), IsEmpty());
    Parameters p = colony();
    p.food_count = 25;
    p.respawn_s = 0;
    EXPECT_THAT(warnings_of(p), ElementsAre(AllOf(HasSubstr("food_count 25"), HasSubstr("population_size 50"))));
    p = colony();
    p.respawn_s = 60;
    EXPECT_THAT(warnings_of(p), ElementsAre(HasSubstr("at most 17 organisms")));
    p.respawn = false;
    EXPECT_THAT(warnings_of(p), ElementsAre(HasSubstr("the colony starves")));
}

TEST(Warnings, AColonyNeedsBirths) {
    Parameters p = colony();
    p.health_cap_per_size = 0.5;
    EXPECT_THAT(warnings_of(p), ElementsAre(HasSubstr("birth_health 120")));
    p = colony();
    p.population_max = 50;
    EXPECT_THAT(warnings_of(p), ElementsAre(HasSubstr("population_max 50")));
    p = colony();
    p.births = Births::Asexual;
    p.mutation_chance = 0;
    EXPECT_THAT(warnings_of(p), ElementsAre(HasSubstr("no new chromosome")));
    p = {};
    p.shuffle_births = true;
    EXPECT_THAT(warnings_of(p), ElementsAre(HasSubstr("shuffle_births has no effect")));
}

TEST(Warnings, PredatorsNeedPreyOfTheRightHealth) {
    Parameters p = colony();
    p.predator_count = 20;
    EXPECT_THAT(warnings_of(p), IsEmpty());
    p.handling_s = 2.5;
    EXPECT_THAT(warnings_of(p), ElementsAre(AllOf(HasSubstr("eat up all prey"), HasSubstr(" is 4,"))));
    p.handling_s = 0;
    EXPECT_THAT(warnings_of(p), ElementsAre(HasSubstr("eat up all prey")));
    p.handling_s = 10;
    EXPECT_THAT(warnings_of(p), ElementsAre(AllOf(HasSubstr("starve"), HasSubstr(" is 1,"))));
    p.reproduction = Reproduction::Generations;
    EXPECT_THAT(warnings_of(p), IsEmpty());
}

TEST(Warnings, PredatorsHaveWarningsOfTheirOwn) {
    Parameters p;
    p.predator_count = 20;
    p.predator_elite_count = 20;
    EXPECT_THAT(warnings_of(p), ElementsAre(AllOf(HasSubstr("predators,"), HasSubstr("elite_count 20"))));
    p.elite_count = 50;
    EXPECT_EQ(warnings_of(p).size(), 2u);
}

} // namespace
} // namespace evod::parameters
