#include "client/viewer/watch/organism_story.h"

#include "client/viewer/panels/organism_panel.h"
#include "tests/unit/viewer/watch/population_pages.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

codec::DecodedSnapshot picture(std::uint64_t generation, double s, float health) {
    codec::DecodedSnapshot picture;
    picture.about.set_generation(generation);
    picture.about.set_simulated_s(s);
    picture.organisms.id = {1, 3, 7};
    picture.organisms.health = {50, health, 60};
    return picture;
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

TEST(OrganismStory, HealthComesFromPicturesOfItsGeneration) {
    OrganismStory story{3, 4};
    story.see(picture(4, 1, 80));
    story.see(picture(4, 1, 80)); // the same again
    story.see(picture(4, 2, 70));
    auto without = picture(4, 3, 0);
    without.organisms.id = {1, 2, 7};
    story.see(without);
    ASSERT_EQ(story.health().size(), 2u);
    EXPECT_EQ(story.health()[1].s, 2);
    EXPECT_EQ(story.health()[1].health, 70);
    EXPECT_FALSE(story.ended());
    story.see(picture(5, 4, 99));
    EXPECT_TRUE(story.ended());
    EXPECT_TRUE(story.waits_for_children());
    EXPECT_EQ(story.health().size(), 2u);
}

TEST(OrganismStory, ALongStoryIsThinnedAndKeepsItsBeginning) {
    OrganismStory story{3, 4};
    for (int i = 0; i <= 3000; ++i) {
        story.see(picture(4, i, 80));
    }
    EXPECT_LE(story.health().size(), OrganismStory::points_max);
    EXPECT_GE(story.health().size(), OrganismStory::points_max / 2);
    EXPECT_EQ(story.health().front().s, 0);
    EXPECT_EQ(story.health().back().s, 3000);
    for (std::size_t i = 1; i < story.health().size(); ++i) {
        EXPECT_LT(story.health()[i - 1].s, story.health()[i].s);
    }
}

TEST(OrganismStory, TellsOfItsEnd) {
    OrganismStory story{3, 4};
    EXPECT_EQ(shown_fate(story), "");
    story.take(info(5, false)); // another one, of the next generation
    EXPECT_FALSE(story.info());
    story.take(info(4, true));
    EXPECT_FALSE(story.dead());
    EXPECT_EQ(shown_fate(story), "alive for 12.3 s, health 40.0");
    auto last = info(4, false);
    last.set_cause_of_death(evod::v1::CAUSE_OF_DEATH_POISONED);
    story.take(last);
    EXPECT_TRUE(story.dead());
    EXPECT_EQ(shown_fate(story), "dead of poison after 12.3 s");
}

TEST(OrganismStory, ChildrenAreInTheNextGeneration) {
    OrganismStory story{3, 4};
    story.take(info(4, true));
    Population same{2}, next{2}, later{2};
    ASSERT_EQ(same.add(page_of(0, 5, 5, 4)), std::nullopt);
    auto page = page_of(0, 5, 5, 5);
    // 0 of 3 and 9, 1 of itself with its genes, 2 of itself with others, 3 and 4 of others.
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

    story.take(same);
    ASSERT_EQ(story.ranges().size(), 2u);
    EXPECT_EQ(story.ranges()[1].max, 104);
    EXPECT_FALSE(story.children());
    story.see(picture(5, 9, 1));
    story.take(later);
    EXPECT_FALSE(story.children());
    story.take(next);
    ASSERT_TRUE(story.children());
    EXPECT_EQ(shown_children(*story.children()), "0 (with 9), 1 (as it was), 2 (alone)");
    EXPECT_FALSE(story.waits_for_children());
    EXPECT_EQ(shown_children({}), "nobody");
}

TEST(ToldParents, AreTwoOrOneOrNone) {
    evod::v1::OrganismInfo info;
    info.set_generation(1);
    EXPECT_EQ(told_parents(info), "No parents: founder of generation 1, or loaded from a file");
    info.set_generation(36);
    info.add_parents(45);
    EXPECT_EQ(told_parents(info), "Parent: 45 (generation 35)") << "a survivor";
    info.add_parents(45);
    EXPECT_EQ(told_parents(info), "Parent: 45 (generation 35)");
    info.set_parents(1, 12);
    EXPECT_EQ(told_parents(info), "Parents: 45 and 12 (generation 35)");
}

TEST(OrganismStory, WhenTheNextGenerationWentByUnseenNoChildrenAreWaitedFor) {
    OrganismStory story{3, 4};
    story.see(picture(6, 9, 1));
    EXPECT_TRUE(story.ended());
    EXPECT_FALSE(story.waits_for_children());
}

TEST(OrganismPanel, SaysWhatItIsAboutToDo) {
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
}

} // namespace
} // namespace evod::viewer
