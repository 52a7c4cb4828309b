#include "client/viewer/world/selected_organism.h"

#include "client/viewer/panels/organism_panel.h"
#include "tests/unit/viewer/world/population_pages.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

evod::v1::OrganismInfo info(std::uint64_t generation, bool alive) {
    evod::v1::OrganismInfo info;
    info.set_id(3);
    info.set_generation(generation);
    info.set_alive(alive);
    info.set_lived_s(12.34);
    info.set_health(alive ? 40 : 0);
    return info;
}

TEST(SelectedOrganism, EndsWithItsGeneration) {
    SelectedOrganism organism{3, 4};
    organism.add_generation(4);
    EXPECT_FALSE(organism.ended());
    organism.add_generation(5);
    EXPECT_TRUE(organism.ended());
    organism.add_generation(4);
    EXPECT_TRUE(organism.ended()) << "after a seek back, another selection begins";
}

TEST(SelectedOrganism, ReportsItsDeath) {
    SelectedOrganism organism{3, 4};
    EXPECT_EQ(shown_fate(organism), "");
    organism.add(info(5, false)); // another organism, of the next generation
    EXPECT_FALSE(organism.info());
    organism.add(info(4, true));
    EXPECT_FALSE(organism.dead());
    EXPECT_EQ(shown_fate(organism), "alive for 12.3 s, health 40.0");
    auto last = info(4, false);
    last.set_cause_of_death(evod::v1::CAUSE_OF_DEATH_POISONED);
    organism.add(last);
    EXPECT_TRUE(organism.dead());
    EXPECT_EQ(shown_fate(organism), "died of poison after 12.3 s");
    last.set_cause_of_death(evod::v1::CAUSE_OF_DEATH_REMOVED);
    organism.add(last);
    EXPECT_EQ(shown_fate(organism), "removed by a user after 12.3 s");
}

TEST(SelectedOrganism, TakesTheRangesOfItsOwnGeneration) {
    SelectedOrganism organism{3, 4};
    Population next{2}, same{2};
    ASSERT_EQ(next.add(page_of(0, 5, 5, 5)), std::nullopt);
    ASSERT_EQ(same.add(page_of(0, 5, 5, 4)), std::nullopt);
    organism.add(next);
    EXPECT_TRUE(organism.ranges().empty());
    organism.add(same);
    ASSERT_EQ(organism.ranges().size(), 2u);
    EXPECT_EQ(organism.ranges()[1].max, 104);
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
    it.set_flees_predator(true);
    EXPECT_EQ(shown_choice(it), "about to flee from the predator at (120, 40)");
    it.set_choice(evod::v1::CHOICE_STEER);
    EXPECT_EQ(shown_choice(it), "steered by its network");
}

} // namespace
} // namespace evod::viewer
