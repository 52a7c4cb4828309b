#include "proto/text/suggestion.h"

#include <gmock/gmock.h>

namespace evod::text {
namespace {

using testing::ElementsAre;

const std::vector<std::string> names{"mutation_chance", "mutate_survivors", "selection",
                                     "survivors",       "respawn",          "respawn_s"};

TEST(EditDistance, CountsSingleEdits) {
    EXPECT_EQ(edit_distance("", ""), 0U);
    EXPECT_EQ(edit_distance("", "abc"), 3U);
    EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
    EXPECT_EQ(edit_distance("selcetion", "selection"), 1U) << "neighbours swapped are one mistake";
}

TEST(Nearest, FindsTheIntendedName) {
    EXPECT_THAT(nearest("mutation_chanse", names), ElementsAre("mutation_chance"));
    EXPECT_THAT(nearest("survivor", names), ElementsAre("survivors", "mutate_survivors"));
    EXPECT_THAT(nearest("respwan", names), ElementsAre("respawn"));
    EXPECT_THAT(nearest("zebra", names), ElementsAre());
    EXPECT_THAT(nearest(std::string(100'000, 'x'), names), ElementsAre());
    EXPECT_EQ(did_you_mean("zebra", names), "");
    EXPECT_EQ(did_you_mean("survivor", names), "; did you mean survivors or mutate_survivors?");
}

TEST(ValueHint, NamesTheProbableMistake) {
    EXPECT_EQ(value_hint("0,1", true), "; write a decimal point: 0.1");
    EXPECT_EQ(value_hint("True", false), "; write it in lower case");
    for (const char* other : {"", "x", "0,1,2", "1,x"}) {
        EXPECT_EQ(value_hint(other, true), "") << other;
    }
    EXPECT_EQ(value_hint("ring", false), "");
}

} // namespace
} // namespace evod::text
