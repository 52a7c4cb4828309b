// Worlds of a class in a laboratory.
#include "server/simulation/laboratory.h"

#include "server/base/inline_executor.h"
#include "server/simulation/world_name.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace evod::simulation {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const Ownership ann{.user = "bio/ann", .class_name = "bio", .teacher = "kant"};
const Ownership ben{.user = "bio/ben", .class_name = "bio", .teacher = "kant"};

class AClass : public testing::Test {
  protected:
    AClass() {
        parameters.population_size = 10;
        laboratory.set_class("bio", rules);
        create("bio_ann", ann);
        create("bio_ben", ben);
        create("alone", {});
    }
    void create(const std::string& name, const Ownership& ownership) {
        CreateWorld command{name, parameters, base::Seed{1}, RunId{1, ++runs}};
        command.ownership = ownership;
        EXPECT_TRUE(laboratory.apply(command)) << name;
    }
    base::Result<Applied> fork(const std::string& world, const std::string& name, const Ownership& ownership) {
        return laboratory.apply(ForkWorld{world, name, std::nullopt, RunId{2, ++runs}, ownership});
    }
    base::Result<Applied> set(const std::string& world, std::uint32_t food_count,
                              std::optional<parameters::PlannedMoment> at = {}) {
        return laboratory.apply(SetParameters{.world = world,
                                              .assignments = {{"food_count", food_count}},
                                              .dry_run = false,
                                              .expected_revision = {},
                                              .at = at});
    }
    Entry& entry(const std::string& name) { return **laboratory.find(name); }

    ClassRules rules{.frozen = false, .ranges = {{"food_count", 2, 500}}, .worlds_per_member = 2};
    parameters::Parameters parameters;
    Laboratory laboratory;
    std::uint64_t runs = 0;
};

TEST_F(AClass, ItsRangesHoldForItsWorldsOnly) {
    EXPECT_TRUE(set("bio_ann", 500));
    const auto refused = set("bio_ann", 501);
    ASSERT_FALSE(refused);
    ASSERT_EQ(refused.error().violations.size(), 1u);
    EXPECT_EQ(refused.error().violations[0].field, "set_parameters.food_count");
    EXPECT_EQ(refused.error().violations[0].allowed, "2 to 500 (class bio)");
    EXPECT_EQ(refused.error().violations[0].got, "501");
    EXPECT_TRUE(set("alone", 501));
}

TEST_F(AClass, ItsRangesHoldForPlannedChanges) {
    EXPECT_FALSE(set("bio_ann", 501, parameters::PlannedMoment{.generation = 5, .tick = {}}));
}

TEST_F(AClass, OtherParametersKeepTheirRange) {
    EXPECT_TRUE(laboratory.apply(SetParameters{
        .world = "bio_ann", .assignments = {{"mutation_chance", 0.5}}, .dry_run = false, .expected_revision = {}}));
}

TEST_F(AClass, FreezesAllItsWorldsAndNoOther) {
    for (const char* name : {"bio_ann", "alone"}) {
        ASSERT_TRUE(laboratory.apply(simulation::Run{name, std::nullopt}));
    }
    rules.frozen = true;
    EXPECT_THAT(laboratory.set_class("bio", rules), ElementsAre("bio_ann", "bio_ben"));
    EXPECT_FALSE(entry("bio_ann").wants_tick());
    EXPECT_EQ(entry("bio_ann").state(), RunState::Running) << "its goal stays";
    EXPECT_TRUE(entry("alone").wants_tick());
    EXPECT_THAT(laboratory.set_class("bio", rules), IsEmpty()) << "nothing has changed";
    rules.frozen = false;
    laboratory.set_class("bio", rules);
    EXPECT_TRUE(entry("bio_ann").wants_tick());
    EXPECT_FALSE(entry("bio_ben").wants_tick()) << "it had no goal";
}

TEST_F(AClass, WorldsThatComeWhileItIsFrozenAreFrozen) {
    rules.frozen = true;
    laboratory.set_class("bio", rules);
    create("bio_cem", {.user = "bio/cem", .class_name = "bio", .teacher = "kant"});
    EXPECT_TRUE(entry("bio_cem").frozen);
    ASSERT_TRUE(laboratory.apply(ResetWorld{"bio_ann", std::nullopt, RunId{3, 1}}));
    EXPECT_TRUE(entry("bio_ann").frozen) << "a reset does not end the freeze";
    EXPECT_EQ(entry("bio_ann").ownership, ann);
}

TEST_F(AClass, AForkHasANameThatCannotBeTheWorldOfAnotherMember) {
    const auto refused = fork("bio_ann", "bio_ben-2", ann);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().violations.at(0).allowed, "a name that begins with bio_ann_");
    EXPECT_TRUE(fork("bio_ann", "bio_ann_2", ann));
    EXPECT_EQ(entry("bio_ann_2").ownership, ann);
    const auto of_fork = fork("bio_ann_2", "bio_ann_2_3", ann);
    ASSERT_FALSE(of_fork) << "the number of worlds";
    EXPECT_EQ(of_fork.error().reason, base::Reason::OwnerWorldsMax);
    EXPECT_THAT(of_fork.error().message, HasSubstr("2 worlds already, of 2"));
    EXPECT_TRUE(fork("bio_ben", "bio_ben_2", ben)) << "every member has a number of its own";
}

TEST_F(AClass, TheTeacherForksAsOftenAsThereIsRoom) {
    const Ownership kant{.user = "kant", .class_name = "bio", .teacher = "kant"};
    for (const char* name : {"bio_ann_a", "bio_ann_b", "bio_ann_c"}) {
        EXPECT_TRUE(fork("bio_ann", name, kant)) << name;
    }
}

TEST_F(AClass, ADeletedClassLeavesItsWorldsWithoutRules) {
    rules.frozen = true;
    laboratory.set_class("bio", rules);
    EXPECT_THAT(laboratory.set_class("bio", std::nullopt), ElementsAre("bio_ann", "bio_ben"));
    EXPECT_FALSE(entry("bio_ann").frozen);
    EXPECT_TRUE(set("bio_ann", 501));
}

TEST_F(AClass, ANoteChangesNothing) {
    const auto hash = entry("bio_ann").world.hash();
    EXPECT_TRUE(laboratory.apply(AddNote{"bio_ann", "prediction", "it grows"}));
    EXPECT_EQ(entry("bio_ann").world.hash(), hash);
    EXPECT_FALSE(laboratory.apply(AddNote{"bio_cem", "prediction", "it grows"})) << "there is no such world";
}

TEST(FirstWorldOf, IsTheNameWithoutWhatForksAdd) {
    EXPECT_EQ(first_world_of("bio-2_red-fox", "bio-2"), "bio-2_red-fox");
    EXPECT_EQ(first_world_of("bio-2_red-fox_a_b", "bio-2"), "bio-2_red-fox");
    EXPECT_EQ(first_world_of("x", "bio-2"), "x");
}

} // namespace
} // namespace evod::simulation
