#include "client/viewer/panels/breeding/caption.h"

#include "tests/unit/viewer/panels/breeding/made_up.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

using made_up::record_of;

TEST(Caption, SaysWhereThePointerStopped) {
    evod::v1::Breeding breeding = made_up::wheel();
    EXPECT_EQ(caption(record_of(breeding), {BreedingStage::Picking, 1}),
              "Pick 2 of 4. The pointer stopped in the slot of organism 2 (rank 2, fitness 30), 30 % of the wheel.");
    breeding.mutable_contenders(2)->mutable_migrant()->set_island(3);
    EXPECT_EQ(
        caption(record_of(breeding), {BreedingStage::Picking, 1}),
        "Pick 2 of 4. The pointer stopped in the slot of organism 2 (rank 2, fitness 30, migrated from island 3), 30 % "
        "of the wheel.");
}

TEST(Caption, ShowsTheOwnFitnessBesideAShuffledOne) {
    evod::v1::Breeding breeding = made_up::wheel();
    EXPECT_EQ(breeding_summary(record_of(breeding)).find("shuffled"), std::string::npos);
    auto& shuffled = *breeding.add_parameters();
    shuffled.set_name("shuffle_fitness");
    shuffled.mutable_value()->set_flag(true);
    breeding.mutable_contenders(2)->set_own_fitness(12.5);
    EXPECT_TRUE(breeding_summary(record_of(breeding)).ends_with(" · fitness shuffled among organisms"));
    EXPECT_NE(caption(record_of(breeding), {BreedingStage::Picking, 1})
                  .find("organism 2 (rank 2, fitness 30 assigned by shuffling, own fitness 12.5)"),
              std::string::npos);
}

TEST(Caption, NamesTheWinnerOfATournament) {
    evod::v1::Breeding breeding = made_up::wheel();
    auto& pick = *breeding.mutable_picks(0);
    pick.clear_turns();
    pick.set_tournament(0);
    EXPECT_EQ(caption(record_of(breeding), {BreedingStage::Picking, 0}),
              "Pick 1 of 4. Tournament 1 is too large to show. Organism 0 (rank 1, fitness 40) won.");
    for (const std::uint32_t contestant : {3u, 0u, 3u}) {
        pick.add_contestants(contestant);
    }
    EXPECT_EQ(caption(record_of(breeding), {BreedingStage::Picking, 0}),
              "Pick 1 of 4. Tournament 1 of 3 contestants: organism 0 (rank 1, fitness 40) won.");
}

TEST(Caption, DescribesHowADescendantWasMade) {
    evod::v1::Breeding breeding = made_up::wheel();
    *breeding.mutable_descendants(3) = made_up::child(1);
    breeding.mutable_descendants(3)->set_id(3);
    const auto of_three = [&] { return caption(record_of(breeding), {BreedingStage::Breeding, 3}); };
    EXPECT_EQ(of_three(), "Organism 3 of the next generation: a child of organisms 4 and 9, no mutation.");
    made_up::mutate(*breeding.mutable_descendants(3), evod::v1::MUTATION_KIND_CREEP, 0, 1, 2);
    made_up::mutate(*breeding.mutable_descendants(3), evod::v1::MUTATION_KIND_CLAMP, 0, 2, 1.5f);
    breeding.mutable_descendants(3)->mutable_order_mutation()->set_method("swap");
    breeding.mutable_descendants(3)->set_crossed(false);
    EXPECT_EQ(of_three(),
              "Organism 3 of the next generation: a child of organisms 4 and 9, not crossed, swap reordered genes, "
              "1 mutation.");
    breeding.mutable_descendants(3)->set_second_share(0.25);
    EXPECT_EQ(of_three(),
              "Organism 3 of the next generation: a child of organisms 4 and 9, blended with weights 0.750 and 0.250, "
              "swap reordered genes, 1 mutation.");
    breeding.mutable_descendants(3)->Clear();
    breeding.mutable_descendants(3)->set_kind(evod::v1::DESCENDANT_KIND_ELITE);
    EXPECT_EQ(of_three(),
              "Organism 3 of the next generation: of the elite, organism 0 (rank 1, fitness 40), kept unchanged.");
}

TEST(Caption, SaysThatAMissingRowIsLoading) {
    EXPECT_EQ(caption(BreedingRecord{BreedingRecord::Key{}}, {}), "");
    evod::v1::Breeding breeding = made_up::wheel();
    breeding.set_pick_count(100);
    EXPECT_EQ(caption(record_of(breeding), {BreedingStage::Picking, 50}), "Pick 51 of 100. Loading …");
}

TEST(Caption, DescribesTheNextGenerationOnly) {
    evod::v1::Breeding breeding = made_up::wheel();
    breeding.set_survivor_count(1);
    EXPECT_EQ(caption(record_of(breeding), {BreedingStage::Done, 0}),
              "The next generation: 1 survivor and 3 children. A dot marks each organism that was picked.");
}

TEST(SelectionLaw, IsNamedInASentenceForEveryMethod) {
    evod::v1::Breeding breeding = made_up::wheel();
    const auto law = [&](const char* method, const char* scaling) {
        breeding.mutable_parameters(0)->mutable_value()->set_choice(method);
        breeding.mutable_parameters(1)->mutable_value()->set_choice(scaling);
        return selection_law_text(record_of(breeding));
    };
    EXPECT_EQ(law("roulette", "none"),
              "Roulette wheel: the wheel is spun for each pick. An organism with twice the weight is picked twice as "
              "often on average. The weight is the fitness.");
    EXPECT_TRUE(law("stochastic_universal", "windowing").ends_with("minus the lowest fitness."));
    EXPECT_TRUE(law("roulette", "linear_ranking").ends_with("The weight depends on the rank alone."));
    EXPECT_TRUE(law("random", "none").starts_with("Random: every organism has the same chance"));
    EXPECT_TRUE(law("truncation", "none").starts_with("Truncation: the best organisms"));
    made_up::set_count(breeding, "tournament_size", 5);
    EXPECT_TRUE(
        law("tournament", "none").starts_with("Tournament: 5 organisms are drawn at random, and the fittest of "));
    breeding.mutable_contenders(1)->set_fitness(-3);
    EXPECT_TRUE(law("roulette", "none").ends_with("minus the lowest fitness.")) << "a wheel has no negative slots";
}

TEST(BreedingSummary, NamesTheOperatorsAndTheNumbers) {
    evod::v1::Breeding breeding = made_up::wheel();
    EXPECT_EQ(breeding_summary(record_of(breeding)),
              "Roulette · generational · 4 organisms, 4 picks: 0 survivors and 4 children");
    breeding.set_survivor_count(3);
    breeding.set_elite_count(1);
    breeding.mutable_parameters(0)->mutable_value()->set_choice("stochastic_universal");
    breeding.mutable_parameters(1)->mutable_value()->set_choice("linear_ranking");
    EXPECT_EQ(breeding_summary(record_of(breeding)),
              "Stochastic universal with linear ranking · generational · 4 organisms, 4 picks: 3 survivors (1 of the "
              "elite) and 1 child");
    breeding.mutable_parameters(0)->mutable_value()->set_choice("tournament");
    made_up::set_count(breeding, "tournament_size", 5);
    EXPECT_EQ(breeding_summary(record_of(breeding)).substr(0, 15), "Tournament of 5");
}

} // namespace
} // namespace evod::viewer
