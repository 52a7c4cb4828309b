#include "server/simulation/observation.h"

#include "server/base/random.h"
#include "server/parameters/model_parameters.h"

#include <gmock/gmock.h>

#include <cmath>

namespace evod::simulation {
namespace {

/// Twelve generations of two islands: fitness_mean is g² on island 0 and g² + 2 on island 1.
History squares() {
    History history;
    for (std::uint64_t generation = 1; generation <= 12; ++generation) {
        std::vector<GenerationStatistics> rows(2);
        for (std::uint32_t island = 0; island < 2; ++island) {
            rows[island].generation = generation;
            rows[island].island = island;
            rows[island].fitness_mean = static_cast<double>(generation * generation) + 2 * island;
            rows[island].food_eaten = 10 * generation;
            rows[island].genes[evolution::BodySize].max = 7;
            if (generation > 1) {
                rows[island].account = evolution::SelectionAccount(evolution::body_gene_count);
                (*rows[island].account)[evolution::PoisonRadius].change = 0.5;
                rows[island].colony = ColonyStatistics{.count_mean = 100, .age_mean_s = 30};
                rows[island].predators.resize(1);
                rows[island].predators[0].fitness_best = static_cast<double>(generation);
                rows[island].predators[0].genes[evolution::PoisonRadius].max = 9;
                rows[island].predators[0].colony = ColonyStatistics{.first_count = 20, .age_mean_s = 40};
            }
        }
        history.emplace_back(std::move(rows));
    }
    return history;
}

const History history = squares();
const parameters::Parameters parameters_of_test{};
const ObservedColumns columns{parameters_of_test};

std::optional<double> value_of(std::string_view text) {
    const auto parsed = Observation::parse(text, columns, "field");
    EXPECT_TRUE(parsed) << text << ": " << (parsed ? "" : to_text(parsed.error()));
    std::uint64_t steps = Observation::steps_max;
    return parsed ? parsed->value({history, parameters_of_test}, steps) : std::nullopt;
}
std::string refusal_of(std::string_view text) {
    const auto parsed = Observation::parse(text, columns, "field");
    return parsed ? "none" : to_text(parsed.error().violations[0]);
}

TEST(Observation, ComputesWhatAClosedFormGives) {
    const std::pair<const char*, double> expected[] = {
        {"12", 12},
        {"1 + 2 * 3 - 8 / 4", 5},
        {"-2 ^ 2", -4},
        {"2 ^ 3 ^ 2", 512},
        {"2 ^ -1", 0.5},
        {"(1 < 2) + (2 <= 2) + (3 > 4) + (1 == 1) + (1 != 1) + (1 >= 2)", 3},
        {"ln(exp(2))", 2},
        {"sqrt(16) + abs(-1)", 5},
        {"fitness_mean[5]", 26}, // (25 + 27) / 2
        {"fitness_mean@0[5]", 25},
        {"fitness_mean@1[-1]", 146},
        {"fitness_mean@max[3] - fitness_mean@min[3]", 2},
        {"fitness_mean@sum[1]", 4},
        {"fitness_mean@deviation[7]", 1},
        {"fitness_mean[2 + 3]", 26},
        {"(fitness_mean@0 / generation)[6]", 6},
        {"mean(generation)", 6.5},
        {"mean(generation, 2, 4)", 3},
        {"sum(fitness_mean@0)", 650},
        {"min(fitness_mean@0, 3, -1)", 9},
        {"max(abs(generation - 4))", 8},
        {"deviation(generation, 1, 3)", std::sqrt(2.0 / 3)},
        {"slope(3 * generation + 1)", 3},
        {"first(fitness_mean@0 > 50)", 8},
        {"argmax(-abs(generation - 9))", 9},
        {"argmin(fitness_mean, 4, 6)", 4},
        {"generation[-1]", 12},
        {"max(fitness_mean@0 - mean(fitness_mean@0))", 144 - 650.0 / 12},
        {"body_size_max[1]", 7},
        {"mean(count_mean)", 100}, // none in the first generation
        {"age_mean_s@1[2]", 30},
        {"predators_fitness_best[7]", 7},
        {"predators_poison_radius_max[2]", 9},
        {"predators_first_count[2]", 20},
        {"predators_age_mean_s[-1]", 40},
        {"sum(poison_radius_change)", 5.5}, // none in the first generation
        {"sum(food_eaten, 1, 2)", 30},
        {"parameter.population_size", 50},
        {"parameter.respawn + parameter.mutate_survivors", 1},
    };
    for (const auto& [text, value] : expected) {
        const auto computed = value_of(text);
        ASSERT_TRUE(computed) << text;
        EXPECT_NEAR(*computed, value, 1e-12) << text;
    }
}

TEST(Observation, HasNoValueWhereDataIsMissing) {
    for (const char* text : {"fitness_mean[13]",
                             "fitness_mean[0]",
                             "fitness_mean[-13]",
                             "fitness_mean[1.5]",
                             "mean(fitness_mean, 10, 20)",
                             "first(fitness_mean > 1e9)",
                             "1 / 0",
                             "ln(0)",
                             "ln(-1)",
                             "sqrt(-1)",
                             "exp(1000)",
                             "1e300 * 1e300",
                             "fitness_mean@2[1]",
                             "body_size_change[1]",
                             "(0 - 8) ^ 0.5",
                             "slope(fitness_mean, 3, 3)",
                             "mean(fitness_mean, 5, 4)",
                             "1 + fitness_mean[40]",
                             "count_mean[1]",
                             "predators_count_mean[1]"}) {
        EXPECT_EQ(value_of(text), std::nullopt) << text;
    }
    const History none;
    std::uint64_t steps = Observation::steps_max;
    EXPECT_FALSE(Observation::parse("generation[-1]", columns, "")->value({none, parameters_of_test}, steps));
}

TEST(Observation, StopsWhenItsStepsAreUsed) {
    const auto parsed = Observation::parse("sum(fitness_mean)", columns, "");
    std::uint64_t steps = 1000;
    EXPECT_EQ(parsed->value({history, parameters_of_test}, steps), 662);
    EXPECT_EQ(steps, 1000u - 1 - 12 * 3);
    steps = 20;
    EXPECT_EQ(parsed->value({history, parameters_of_test}, steps), std::nullopt);
    EXPECT_EQ(steps, 0u);
}

TEST(Observation, RefusesNamingThePlaceAndWhatIsAllowed) {
    using testing::HasSubstr;
    EXPECT_THAT(refusal_of("fitnes_mean[1]"),
                testing::AllOf(HasSubstr("field: got \"fitnes_mean[1]\" at character 1"), HasSubstr("fitness_mean")));
    EXPECT_THAT(refusal_of("1 +"), HasSubstr("got the end at character 4, allowed a number, a column"));
    EXPECT_THAT(refusal_of("fitness_mean"), HasSubstr("one number"));
    EXPECT_THAT(refusal_of("mean(3)"), HasSubstr("got \"3)\" at character 6, allowed a column"));
    EXPECT_THAT(refusal_of("mean(fitness_mean, 3)"), HasSubstr("at character 21, allowed ,"));
    EXPECT_THAT(refusal_of("fitness_mean[generation]"), HasSubstr("one number, the generation"));
    EXPECT_THAT(refusal_of("3[1]"), HasSubstr("a column before [ ]"));
    EXPECT_THAT(refusal_of("1 2"), HasSubstr("got \"2\" at character 3, allowed an operator"));
    EXPECT_THAT(refusal_of("fitness_mean@x[1]"), HasSubstr("the number of an island"));
    EXPECT_THAT(refusal_of("parameter.selection"), HasSubstr("a parameter that is a number"));
    EXPECT_THAT(refusal_of("parameter.populaton_size"), HasSubstr("did you mean population_size?"));
    EXPECT_THAT(refusal_of("1e999"), HasSubstr("a number of at most"));
    EXPECT_THAT(refusal_of("\n\xff"), HasSubstr("got \"??\" at character 1"));
    EXPECT_THAT(refusal_of(std::string(300, '1')), HasSubstr("got 300 bytes, allowed at most 256 bytes"));
    EXPECT_THAT(refusal_of(std::string(40, '(')), HasSubstr("at most 32 levels"));
    EXPECT_THAT(refusal_of(std::string(70, '-') + "1"), HasSubstr("at most 32 levels"));
    EXPECT_EQ(refusal_of(std::string(31, '(') + "1" + std::string(31, ')')), "none");
}

/// Writes a random expression, and computes its value in generation g next to it.
class RandomExpression {
  public:
    explicit RandomExpression(std::uint32_t seed) : stream_{{base::Seed{seed}, base::Purpose::Replicate, 0, 0}, 0} {}

    struct Written {
        std::string text;
        std::optional<double> value;
    };
    /// A number, or a column as it is in generation g.
    Written write(int depth, double g) {
        const std::uint32_t kind = pick(depth == 0 ? 3 : 10);
        if (kind == 0) {
            const std::uint32_t number = pick(9);
            return {std::to_string(number), number};
        }
        if (kind == 1) {
            return {"generation", g};
        }
        if (kind == 2) {
            return {"fitness_mean@1", g * g + 2};
        }
        const Written a = write(depth - 1, g);
        if (kind == 3) {
            return {"-(" + a.text + ")", a.value ? std::optional{-*a.value} : std::nullopt};
        }
        if (kind == 4) {
            return {"sqrt(" + a.text + ")",
                    a.value && *a.value >= 0 ? std::optional{std::sqrt(*a.value)} : std::nullopt};
        }
        const Written b = write(depth - 1, g);
        const char* const operators[] = {"+", "-", "*", "/", "<"};
        const std::uint32_t op = kind - 5;
        const std::string text = "(" + a.text + ")" + operators[op] + "(" + b.text + ")";
        if (!a.value || !b.value) {
            return {text, std::nullopt};
        }
        const double results[] = {*a.value + *b.value, *a.value - *b.value, *a.value * *b.value, *a.value / *b.value,
                                  static_cast<double>(*a.value < *b.value)};
        return {text, std::isfinite(results[op]) ? std::optional{results[op]} : std::nullopt};
    }

  private:
    std::uint32_t pick(std::uint32_t count) { return static_cast<std::uint32_t>(stream_.long_word() % count); }
    base::RandomStream stream_;
};

TEST(Observation, OfRandomExpressionsEqualsASecondEvaluation) {
    int compared = 0, with_value = 0;
    for (std::uint32_t seed = 1; seed <= 3000; ++seed) {
        const double g = 1 + seed % 12;
        // A sum with a column is always a column.
        const auto written = RandomExpression{seed}.write(3, g);
        const std::string text =
            "(0 * generation + (" + written.text + "))[" + std::to_string(static_cast<int>(g)) + "]";
        if (text.size() > Observation::bytes_max) {
            continue;
        }
        EXPECT_EQ(value_of(text), written.value) << text;
        ++compared;
        with_value += written.value.has_value();
    }
    EXPECT_GT(compared, 1500);
    EXPECT_GT(with_value, 1000);
}

} // namespace
} // namespace evod::simulation
