#include "server/commands/interview.h"

#include <gmock/gmock.h>

#include <sstream>

namespace evod::commands {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string blank_answers(int count) {
    return std::string(static_cast<std::size_t>(count), '\n');
}

TEST(Interview, EmptyAnswersKeepTheProposal) {
    parameters::Parameters proposed;
    proposed.food_count = 77;
    std::istringstream in{blank_answers(60)};
    std::ostringstream out;
    const auto answers = interview(proposed, in, out);
    ASSERT_TRUE(answers) << to_text(answers.error());
    EXPECT_TRUE(*answers == proposed);
    EXPECT_THAT(out.str(), HasSubstr("food_count"));
    EXPECT_THAT(out.str(), HasSubstr("[77]: "));
}

TEST(Interview, RepeatsAQuestionAfterAnInvalidAnswer) {
    std::istringstream in{"9\nmany\n11\n" + blank_answers(60)};
    std::ostringstream out;
    const auto answers = interview({}, in, out);
    ASSERT_TRUE(answers);
    EXPECT_EQ(answers->population_size, 9u);
    EXPECT_EQ(answers->food_count, 11u);
    EXPECT_THAT(out.str(), HasSubstr("got \"many\""));
}

TEST(Interview, AsksOnlyWhatTheAnswersMakeRelevant) {
    parameters::Parameters proposed;
    proposed.selection = evolution::SelectionMethod::Roulette;
    proposed.island_count = 1;
    std::istringstream in{blank_answers(60)};
    std::ostringstream out;
    ASSERT_TRUE(interview(proposed, in, out));
    EXPECT_THAT(out.str(), Not(HasSubstr("tournament_size (")));
    EXPECT_THAT(out.str(), Not(HasSubstr("migration (")));
}

TEST(Interview, FailsAtTheEndOfTheInput) {
    std::istringstream in{"9\n"};
    std::ostringstream out;
    const auto answers = interview({}, in, out);
    ASSERT_FALSE(answers);
    EXPECT_THAT(to_text(answers.error()), HasSubstr("--ask: the input ended before the answer to food_count"));
}

} // namespace
} // namespace evod::commands
