#include "client/core/change_text.h"

#include <gtest/gtest.h>

namespace evod::core {
namespace {

TEST(ChangeText, ValuesAreShort) {
    v1::ParameterValue value;
    EXPECT_EQ(to_text(value), "-");
    value.set_real(0.1);
    EXPECT_EQ(to_text(value), "0.1");
    value.set_count(4'000'000);
    EXPECT_EQ(to_text(value), "4000000");
    value.set_flag(false);
    EXPECT_EQ(to_text(value), "false");
    value.set_choice("tournament");
    EXPECT_EQ(to_text(value), "tournament");
}

TEST(ChangeText, AChangeNamesValuesAndActor) {
    v1::AppliedChange change;
    change.set_generation(20);
    change.mutable_by()->set_kind(v1::ACTOR_KIND_CLIENT);
    change.mutable_by()->set_user("alice");
    v1::ChangedValue& chance = *change.add_values();
    chance.set_name("mutation_chance");
    chance.mutable_before()->set_real(0.01);
    chance.mutable_after()->set_real(0.2);
    EXPECT_EQ(to_text(change), "generation 20: mutation_chance 0.01 → 0.2 by alice");

    change.mutable_by()->set_kind(v1::ACTOR_KIND_SCHEDULE);
    v1::ChangedValue& food = *change.add_values();
    food.set_name("food_count");
    food.mutable_before()->set_count(25);
    food.mutable_after()->set_count(7);
    EXPECT_EQ(to_text(change), "generation 20: mutation_chance 0.01 → 0.2, food_count 25 → 7 by the schedule");
}

} // namespace
} // namespace evod::core
