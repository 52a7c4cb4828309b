#include "client/viewer/world/organism_history.h"

#include "client/viewer/panels/organism_panel.h"
#include "tests/unit/codec/px_column.h"
#include "tests/unit/viewer/world/population_pages.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

codec::ReceivedSnapshot snapshot(std::uint64_t generation, double s, float health) {
    codec::ReceivedSnapshot snapshot;
    snapshot.about.set_generation(generation);
    snapshot.about.set_simulated_s(s);
    snapshot.entities = codec::snapshot_with(
        {.id = {1, 3, 7}, .x = {}, .y = {}, .width = {}, .height = codec::px_column({50, health, 60})});
    return snapshot;
}

evod::v1::OrganismInfo info(std::uint64_t generation, bool alive) {
    evod::v1::OrganismInfo info;
    info.set_id(3);
    info.set_generation(generation);
    info.set_alive(alive);
    info.set_lived_s(12.34);
    info.set_health(alive ? 40 : 0);
    info.add_genes(0);
    info.add_genes(100);
    return info;
}

TEST(OrganismHistory, TakesHealthFromSnapshotsOfItsGeneration) {
    OrganismHistory story{3, 4};
    story.add(snapshot(4, 1, 80));
    story.add(snapshot(4, 1, 80)); // the same tick again
    story.add(snapshot(4, 2, 70));
    auto without = snapshot(4, 3, 0);
    without.entities = codec::snapshot_with({.id = {1, 2, 7}, .x = {}, .y = {}, .width = {}, .height = {}});
    story.add(without);
    ASSERT_EQ(story.health().size(), 2u);
    EXPECT_EQ(story.health()[1].s, 2);
    EXPECT_EQ(story.health()[1].health, 70);
    EXPECT_FALSE(story.ended());
    story.add(snapshot(5, 4, 99));
    EXPECT_TRUE(story.ended());
    EXPECT_TRUE(story.waits_for_children());
    EXPECT_EQ(story.health().size(), 2u);
}

TEST(OrganismHistory, DropsEverySecondPointWhenFull) {
    OrganismHistory story{3, 4};
    for (int i = 0; i <= 3000; ++i) {
        story.add(snapshot(4, i, 80));
    }
    EXPECT_LE(story.health().size(), OrganismHistory::points_max);
    EXPECT_GE(story.health().size(), OrganismHistory::points_max / 2);
    EXPECT_EQ(story.health().front().s, 0);
    EXPECT_EQ(story.health().back().s, 3000);
    for (std::size_t i = 1; i < story.health().size(); ++i) {
        EXPECT_LT(story.health()[i - 1].s, story.health()[i].s);
    }
}

TEST(OrganismHistory, ReportsItsDeath) {
    OrganismHistory story{3, 4};
    EXPECT_EQ(shown_fate(story), "");
    story.add(info(5, false)); // another organism, of the next generation
    EXPECT_FALSE(story.info());
    story.add(info(4, true));
    EXPECT_FALSE(story.dead());
    EXPECT_EQ(shown_fate(story), "alive for 12.3 s, health 40.0");
    auto last = info(4, false);
    last.set_cause_of_death(evod::v1::CAUSE_OF_DEATH_POISONED);
    story.add(last);
    EXPECT_TRUE(story.dead());
    EXPECT_EQ(shown_fate(story), "died of poison after 12.3 s");
    last.set_cause_of_death(evod::v1::CAUSE_OF_DEATH_REMOVED);
    story.add(last);
    EXPECT_EQ(shown_fate(story), "removed by a user after 12.3 s");
}

TEST(OrganismHistory, ChildrenAreInTheNextGeneration) {
    OrganismHistory story{3, 4};
    story.add(info(4, true));
    Population same{2}, next{2}, later{2};
    ASSERT_EQ(same.add(page_of(0, 5, 5, 4)), std::nullopt);
    auto page = page_of(0, 5, 5, 5);
    // Parents: of 0, 3 and 9; of 1, only 3 with the same genes; of 2, only 3 with other genes; of 3 and 4, others.
    page.clear_parents();
    for (const std::uint32_t parent : {3, 3, 3, 8, 9, 9, 3, 3, 7, 7}) {
        put(*page.mutable_parents(), parent);
    }
    page.clear_genes();
    for (const float gene : {1.f, 0.f, 1.f, 1.f, 1.f, 100.f, 100.f, 100.f, 100.f, 100.f}) {
        put(*page.mutable_genes(), gene);
    }
    ASSERT_EQ(next.add(page), std::nullopt);
    ASSERT_EQ(later.add(page_of(0, 5, 5, 6)), std::nullopt);

    story.add(same);
    ASSERT_EQ(story.ranges().size(), 2u);
    EXPECT_EQ(story.ranges()[1].max, 104);
    EXPECT_FALSE(story.children());
    story.add(snapshot(5, 9, 1));
    story.add(later);
    EXPECT_FALSE(story.children());
    story.add(next);
    ASSERT_TRUE(story.children());
    EXPECT_EQ(shown_children(*story.children()), "0 (with 9), 1 (unchanged), 2 (single parent)");
    EXPECT_FALSE(story.waits_for_children());
    EXPECT_EQ(shown_children({}), "none");
}

TEST(Parents, NameTwoOrOneOrNone) {
    evod::v1::OrganismInfo info;
    info.set_generation(1);
    using enum OrganismHistory::Origin;
    EXPECT_EQ(shown_parents(info, Unknown), "No parents: founder of generation 1, or loaded from a file");
    info.set_placed_tick(1234);
    EXPECT_EQ(shown_parents(info, Unknown), "No parents: placed by a user after tick 1,234 of the generation");
    info.clear_placed_tick();
    info.set_generation(36);
    info.add_parents(45);
    EXPECT_EQ(shown_parents(info, Unknown), "One parent: 45 (generation 35)");
    EXPECT_EQ(shown_parents(info, Survivor), "One parent: 45 (generation 35): this organism is a survivor");
    EXPECT_EQ(shown_parents(info, Elite), "One parent: 45 (generation 35): this organism belongs to the elite");
    info.add_parents(45);
    EXPECT_EQ(shown_parents(info, Child), "One parent: 45 (generation 35), which was both parents");
    info.set_parents(1, 12);
    EXPECT_EQ(shown_parents(info, Child), "Parents: 45 and 12 (generation 35)");
}

/// The answer to a request of a history: the breeding, from the parent that the request names.
evod::v1::Breeding bred(const evod::v1::GetBreeding& request) {
    evod::v1::Breeding breeding;
    breeding.set_generation(request.generation());
    breeding.set_elite_count(1);
    breeding.set_survivor_count(25);
    breeding.add_contenders();
    return breeding;
}

OrganismHistory child_of(std::uint32_t first, std::uint32_t second) {
    OrganismHistory history{3, 4};
    auto described = info(4, true);
    described.add_parents(first);
    described.add_parents(second);
    history.add(described);
    return history;
}

TEST(OrganismHistory, RequestsEachParent) {
    EXPECT_FALSE((OrganismHistory{3, 4}.wanted_parent())) << "the parents are not known yet";
    OrganismHistory history = child_of(45, 12);
    for (const std::uint32_t parent : {45u, 12u}) {
        const auto wanted = history.wanted_parent();
        ASSERT_TRUE(wanted);
        EXPECT_EQ(wanted->generation(), 3u);
        EXPECT_EQ(wanted->first_contender(), parent);
        EXPECT_EQ(history.parent(parent), nullptr);
        auto answer = bred(*wanted);
        if (parent == 12) {
            answer.mutable_contenders(0)->mutable_migrant()->set_island(1);
            answer.mutable_contenders(0)->mutable_migrant()->set_organism(9);
        }
        history.add(*wanted, answer);
    }
    EXPECT_FALSE(history.wanted_parent());
    EXPECT_EQ(history.origin(), OrganismHistory::Origin::Survivor);
    EXPECT_FALSE(history.parent(45)->migrant);
    EXPECT_EQ(history.parent(12)->migrant->organism(), 9u);
}

TEST(OrganismHistory, IgnoresAnAnswerAboutAnotherBreeding) {
    OrganismHistory history = child_of(45, 12);
    const auto wanted = history.wanted_parent();
    ASSERT_TRUE(wanted);
    auto answer = bred(*wanted);
    answer.set_generation(9);
    history.add(*wanted, answer);
    answer.set_generation(3);
    answer.clear_contenders();
    history.add(*wanted, answer);
    EXPECT_EQ(history.parent(45), nullptr);
}

TEST(HealthAxis, EndsAtTheNextRoundNumber) {
    EXPECT_EQ(axis_end(226), 250);
    EXPECT_EQ(axis_end(250), 250);
    EXPECT_EQ(axis_end(251), 300);
    EXPECT_EQ(axis_end(1), 1);
}

TEST(OrganismHistory, StopsWaitingForChildrenAfterTwoGenerations) {
    OrganismHistory story{3, 4};
    story.add(snapshot(6, 9, 1));
    EXPECT_TRUE(story.ended());
    EXPECT_FALSE(story.waits_for_children());
}

TEST(OrganismPanel, DescribesTheNextAction) {
    auto it = info(4, true);
    it.set_target_x_px(120.4);
    it.set_target_y_px(39.6);
    EXPECT_EQ(shown_choice(it), "");
    it.set_choice(evod::v1::CHOICE_WANDER);
    EXPECT_EQ(shown_choice(it), "about to wander");
    it.set_choice(evod::v1::CHOICE_SEEK);
    EXPECT_EQ(shown_choice(it), "about to seek food at (120, 40)");
    it.set_choice(evod::v1::CHOICE_FLEE);
    EXPECT_EQ(shown_choice(it), "about to flee from poison at (120, 40)");
    it.set_choice(evod::v1::CHOICE_STEER);
    EXPECT_EQ(shown_choice(it), "steered by its network");
}

} // namespace
} // namespace evod::viewer
