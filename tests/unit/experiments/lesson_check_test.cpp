#include "server/experiments/lesson_check.h"

#include <gmock/gmock.h>

namespace evod::experiments {
namespace {

const LessonValues values{{"a", {2.0}}, {"b", {5.0}}, {"c", {5.0}}, {"none", {std::nullopt}}, {"list", {1.0, 3.0}}};

Check check_of(Check::Kind kind, std::vector<std::string> names, double within = 0, bool in_percent = false) {
    return {.kind = kind, .of = "", .names = std::move(names), .within = within, .in_percent = in_percent};
}

TEST(LessonCheck, MeasuresHowFarAPredictionIsFromTheObservation) {
    const auto near = compare_answer(check_of(Check::Kind::Near, {"b"}, 1), {4.5}, values, {});
    EXPECT_EQ(near->observed, Answer{5});
    EXPECT_EQ(near->apart, -0.5);
    EXPECT_TRUE(near->passed);
    EXPECT_FALSE(compare_answer(check_of(Check::Kind::Near, {"b"}, 1), {6.5}, values, {})->passed);
    EXPECT_TRUE(compare_answer(check_of(Check::Kind::Near, {"b"}, 20, true), {6}, values, {})->passed);
    EXPECT_FALSE(compare_answer(check_of(Check::Kind::Near, {"b"}, 19, true), {6}, values, {})->passed);
    EXPECT_FALSE(compare_answer(check_of(Check::Kind::Near, {"none"}, 1), {1}, values, {}));
}

TEST(LessonCheck, TakesTheFirstOfEqualOptions) {
    const auto largest = compare_answer(check_of(Check::Kind::ArgMax, {"a", "b", "c"}), {1}, values, {});
    EXPECT_EQ(largest->observed, Answer{1});
    EXPECT_TRUE(largest->passed);
    EXPECT_EQ(largest->apart, std::nullopt);
    EXPECT_EQ(compare_answer(check_of(Check::Kind::ArgMin, {"b", "a"}), {0}, values, {})->observed, Answer{1});
    EXPECT_EQ(compare_answer(check_of(Check::Kind::Order, {"a", "b", "c"}), {1, 2, 0}, values, {})->observed,
              (Answer{1, 2, 0}));
}

TEST(LessonCheck, CountsThePairsInTheWrongOrder) {
    const Check order = check_of(Check::Kind::Order, {"a", "b", "c"}); // observed: 1, 2, 0
    EXPECT_EQ(compare_answer(order, {1, 2, 0}, values, {})->apart, 0);
    EXPECT_EQ(compare_answer(order, {2, 1, 0}, values, {})->apart, 1);
    EXPECT_EQ(compare_answer(order, {0, 2, 1}, values, {})->apart, 3);
    EXPECT_FALSE(compare_answer(order, {0, 2, 1}, values, {})->passed);
}

TEST(LessonCheck, MeasuresTheDistanceOfACurve) {
    const Check curve = check_of(Check::Kind::Curve, {"list"}, 1.5); // 1 at x = 10, 3 at x = 20
    const std::vector<double> at{10, 20};
    EXPECT_EQ(compare_answer(curve, {10, 1, 20, 3}, values, at)->apart, 0);
    EXPECT_EQ(compare_answer(curve, {0, 0, 40, 4}, values, at)->apart, std::sqrt(0.5)) << "1 and 2, instead of 1 and 3";
    EXPECT_EQ(compare_answer(curve, {12, 3, 18, 5}, values, at)->apart, 2) << "constant beyond its ends";
    EXPECT_FALSE(compare_answer(curve, {12, 3, 18, 5}, values, at)->passed);
}

TEST(LessonCheck, RefusesByTheSharesOfThePasses) {
    EXPECT_FALSE(is_refused(true, 18, 20, 20));
    EXPECT_TRUE(is_refused(true, 17, 20, 20));
    EXPECT_FALSE(is_refused(false, 12, 20, 20));
    EXPECT_TRUE(is_refused(false, 13, 20, 20));
    EXPECT_FALSE(is_refused(true, 1, 2, 2)) << "one failure in two has a chance of 19 % in a good lesson";
    EXPECT_TRUE(is_refused(true, 0, 2, 2)) << "two have a chance of 1 %";
    EXPECT_FALSE(is_refused(false, 2, 2, 2));
}

/// A world without chance in what is asked: generation 3 ends at tick 3.
Lesson counting_lesson(const std::string& right_option) {
    const auto lesson = parse_lesson(R"({"title": "A", "minutes": 20, "goals": ["B"], "needs": "C", "seed": 7,
"experiment": {"fitness": "gene_sum", "population_size": 10},
"steps": [
{"title": "D", "text": "E", "do": {"run": 3},
 "predict": {"id": "ticks", "kind": "number", "ask": "F?", "min": 0, "max": 10, "expected": 3},
 "observe": {"ticks": "end_tick[-1]"}, "check": {"near": "ticks", "within": 0.5},
 "law": {"text": "G", "of": "ticks", "value": "sum(generation) / 2", "error": "0.1"}},
{"title": "H", "text": "I", "do": {"set": {"population_size": 20}, "reset": true, "run": 1},
 "predict": {"id": "pick", "kind": "choice", "ask": "J?", "options": ["K", "L"], "expected": )" +
                                     right_option + R"(},
 "observe": {"twenty": "organism_count[1]", "reset": "end_tick[-1] - {ticks}"},
 "check": {"argmin": ["twenty", "reset"]}}
]})");
    return lesson ? *lesson : Lesson{};
}

TEST(LessonCheck, PlaysSetsResetsAndRuns) {
    const auto report = check_lesson(counting_lesson("1"), 3, 2);
    ASSERT_TRUE(report);
    std::vector<std::string> lines;
    for (const CountedGuess& guess : report->guesses) {
        lines.push_back(guess.of + ", " + guess.guess + ": " + std::to_string(guess.passed) + " of " +
                        std::to_string(guess.tried));
    }
    EXPECT_THAT(lines, testing::ElementsAre("ticks, expected: 3 of 3", "ticks, the middle of the range: 0 of 3",
                                            "ticks, the law: 3 of 3", "pick, expected: 3 of 3",
                                            ", always option 1: 0 of 3", ", always option 2: 3 of 3"));
    EXPECT_THAT(report->observed,
                testing::ElementsAre("reset: -2 (-2 to -2)", "ticks: 3 (3 to 3)", "twenty: 20 (20 to 20)"));
}

TEST(LessonCheck, RefusesALessonWhoseOnlyChoiceIsAlwaysTheSame) {
    const auto report = check_lesson(counting_lesson("1"), 20, 2);
    ASSERT_TRUE(report->is_refused());
    EXPECT_TRUE(report->guesses.back().is_refused);
    EXPECT_TRUE(check_lesson(counting_lesson("0"), 20, 2)->guesses[3].is_refused) << "a wrong expected answer";
    EXPECT_FALSE(check_lesson(counting_lesson("1"), 20, 2, [] { return true; })) << "stopped";
}

} // namespace
} // namespace evod::experiments
