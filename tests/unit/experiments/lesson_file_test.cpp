#include "server/experiments/lesson_file.h"

#include <gmock/gmock.h>

namespace evod::experiments {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A valid lesson, in which each test changes something.
std::string lesson_text() {
    return R"({"title": "A", "minutes": 20, "goals": ["B"], "needs": "C", "experiment": {"population_size": 30},
"seed": 7, "steps": [
{"title": "D", "text": "E",
 "predict": {"id": "guess", "kind": "number", "ask": "F?", "min": 0, "max": 10, "expected": 3},
 "do": {"set": {"mutation_chance": 0.5}, "reset": true, "run": 4},
 "observe": {"before": "fitness_mean[1]", "course": {"each": "fitness_mean[{x}]", "at": [1, 2]}},
 "check": {"near": "before", "within": 2},
 "law": {"text": "G", "of": "before", "value": "parameter.population_size", "error": "1"}},
{"title": "H", "text": "I",
 "predict": {"id": "pick", "kind": "choice", "ask": "J?", "options": ["K", "L"], "expected": 1},
 "observe": {"after": "fitness_mean[-1] / {before}"},
 "check": {"argmax": ["before", "after"]}}
]})";
}

std::string with_change(const std::string& from, const std::string& to) {
    std::string text = lesson_text();
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}
std::string lesson_refusal(const std::string& text) {
    const auto lesson = parse_lesson(text);
    return lesson ? "none" : to_text(lesson.error());
}

TEST(LessonFile, IsReadCompletely) {
    const auto lesson = parse_lesson(lesson_text());
    ASSERT_TRUE(lesson) << to_text(lesson.error());
    EXPECT_EQ(lesson->title, "A");
    EXPECT_EQ(lesson->minutes, 20u);
    EXPECT_EQ(lesson->parameters.population_size, 30u);
    EXPECT_EQ(lesson->seed.value, 7u);
    ASSERT_EQ(lesson->steps.size(), 2u);
    const LessonStep& step = lesson->steps[0];
    EXPECT_EQ(step.predict->expected, Answer{3});
    EXPECT_EQ(step.set.size(), 1u);
    EXPECT_TRUE(step.reset);
    EXPECT_EQ(step.run, 4u);
    EXPECT_EQ(step.observe[1].at, (std::vector<double>{1, 2}));
    EXPECT_EQ(step.check->of, "guess");
    EXPECT_EQ(step.check->within, 2);
    EXPECT_EQ(step.law->of, "before");
    EXPECT_EQ(lesson->steps[1].check->kind, Check::Kind::ArgMax);
    EXPECT_EQ(lesson->prediction("pick")->options, (std::vector<std::string>{"K", "L"}));
    EXPECT_EQ(lesson->prediction("other"), nullptr);
}

TEST(LessonFile, IsRefusedWithPathLineAndWhatIsAllowed) {
    const auto expect = [](const std::string& from, const std::string& to, const std::string& path,
                           const std::string& allowed) {
        EXPECT_THAT(lesson_refusal(with_change(from, to)), AllOf(HasSubstr(path), HasSubstr(allowed))) << to;
    };
    expect(R"("minutes": 20)", R"("minutes": 2)", "minutes (line 1): got 2", "5 to 90");
    expect(R"("needs": "C", )", "", "needs (line 1): got nothing", "required");
    expect(R"("seed": 7)", R"("seeds": 7)", "seeds (line 2): unknown name", "did you mean needs, seed or steps?");
    expect(R"("population_size": 30)", R"("population_size": {"1": 3, "9": 4})", "experiment", "no schedule");
    expect(R"("population_size": 30)", R"("population_size": 0)", "experiment.population_size (line 1)", "1 to");
    expect(R"("population_size": 30)", R"("fitness": "external")", "experiment.fitness", "life");
    expect(R"("min": 0)", R"("min": "a")", R"(steps[0].predict.min (line 4): got "a")", "a number");
    expect(R"("expected": 3)", R"("expected": 11)", "steps[0].predict.expected (line 4)", "0 to 10");
    expect(R"("kind": "number")", R"("kind": "guess")", "steps[0].predict.kind", "number, choice, order");
    expect(R"("run": 4)", R"("run": 0)", "steps[0].do.run (line 5)", "1 to 1000");
    expect(R"("mutation_chance": 0.5)", R"("mutation_chance": 2)", "steps[0].do.set.mutation_chance (line 5)",
           "0 to 1");
    expect("fitness_mean[1]", "fitnes[1]", "steps[0].observe.before (line 6)", "at character 1");
    expect("{before}", "{later}", "steps[1].observe.after (line 11)", "earlier steps");
    expect("{before}", "{after}", "steps[1].observe.after (line 11)", "earlier steps");
    expect(R"("after")", R"("before")", "steps[1].observe.before (line 11)", "a new name");
    expect(R"("near": "before")", R"("near": "course")", "steps[0].check.near (line 7)", "names of numbers");
    expect(R"("near": "before", "within": 2)", R"("argmax": ["before"])", "steps[0].check", "near");
    expect(R"(["before", "after"])", R"(["before"])", "steps[1].check.argmax (line 12)", "a list of 2 to 2");
    expect(R"("expected": 1)", R"("expected": 2)", "steps[1].predict.expected (line 10)", "0 to 1");
    expect(R"("id": "pick")", R"("id": "guess")", "steps[1].predict.id", "an id that no earlier prediction has");
    expect(R"("of": "before")", R"("of": "nothing")", "steps[0].law.of (line 8)", "the name of a number");
    EXPECT_THAT(lesson_refusal("[]"), HasSubstr("expected a JSON object"));
    EXPECT_THAT(lesson_refusal("{"), HasSubstr("not JSON: line 1"));
    EXPECT_THAT(lesson_refusal(std::string(70'000, ' ')), HasSubstr("too long"));
}

TEST(LessonFile, PutsEarlierNumbersIntoExpressions) {
    const auto value_of = [](std::string_view name) -> std::optional<double> {
        return name == "a" ? std::optional{-1.5} : std::nullopt;
    };
    EXPECT_EQ(with_values("1 + {a} * {a}", value_of), "1 + (-1.5) * (-1.5)");
    EXPECT_EQ(with_values("fitness_mean[3]", value_of), "fitness_mean[3]");
    EXPECT_EQ(with_values("{b}", value_of), std::nullopt);
}

TEST(LessonFile, IsNamedWithItsPathIfItCannotBeRead) {
    EXPECT_THAT(to_text(load_lesson("/nonexistent/x.json").error()), HasSubstr("/nonexistent/x.json"));
}

} // namespace
} // namespace evod::experiments
