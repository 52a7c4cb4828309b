#include "server/experiments/lesson_check.h"

#include "server/base/assert.h"
#include "server/base/inline_executor.h"
#include "server/experiments/trials.h"
#include "server/simulation/observation.h"
#include "server/simulation/world.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <ranges>
#include <utility>

namespace evod::experiments {
namespace {

constexpr std::uint32_t seeds_judged_strictly = 20;

// ---- playing ---------------------------------------------------------------------------------------------------

/// A lesson that is played with one seed, step by step.
class Play {
  public:
    Play(const Lesson& lesson, base::Seed seed)
        : lesson_{lesson}, seed_{seed}, world_{std::make_unique<simulation::World>(lesson.parameters, seed)} {}

    void perform(const LessonStep& step) {
        if (!step.set.empty()) {
            const auto requested = parameters::request_of(world_->parameters(), step.set);
            EVOD_ASSERT(requested.has_value()); // parse_lesson() has checked the values
            world_->request_parameters(*requested);
        }
        if (step.reset) {
            world_ = std::make_unique<simulation::World>(world_->restarted(seed_));
        }
        for (std::uint32_t ended = 0; ended < step.run && world_->outcome() == evolution::Outcome::Running;) {
            world_->advance_tick(executor_);
            world_->take_events();
            ended += world_->generation_over() ? 1 : 0;
        }
        for (const Observed& observed : step.observe) {
            std::vector<std::optional<double>> values;
            for (std::size_t i = 0; i < observed.expressions.size(); ++i) {
                const auto x = observed.at.empty() ? std::nullopt : std::optional{observed.at[i]};
                values.push_back(value_of(observed.expressions[i], x));
            }
            values_[observed.name] = std::move(values);
        }
    }
    const LessonValues& values() const { return values_; }
    std::optional<double> number(std::string_view name) const {
        const auto found = values_.find(name);
        return found == values_.end() ? std::nullopt : found->second.front();
    }
    std::optional<double> value_of(const std::string& expression, std::optional<double> x = {}) const {
        const auto text =
            with_values(expression, [&](std::string_view name) { return name == "x" ? x : number(name); });
        if (!text) {
            return std::nullopt;
        }
        const parameters::Parameters& active = world_->parameters().active;
        const auto parsed = simulation::Observation::parse(*text, simulation::ObservedColumns{active}, "observe");
        std::uint64_t steps_left = simulation::Observation::steps_max;
        return parsed ? parsed->value({world_->history(), active}, steps_left) : std::nullopt;
    }

  private:
    const Lesson& lesson_;
    base::Seed seed_;
    std::unique_ptr<simulation::World> world_;
    base::InlineExecutor executor_;
    LessonValues values_;
};

// ---- comparing -------------------------------------------------------------------------------------------------

/// The height of a drawn curve at x. Its points are x, y, x, y …
double height_of(const Answer& curve, double x) {
    if (x <= curve[0]) {
        return curve[1];
    }
    for (std::size_t i = 2; i < curve.size(); i += 2) {
        if (x <= curve[i]) {
            const double share = (x - curve[i - 2]) / (curve[i] - curve[i - 2]);
            return curve[i - 1] + share * (curve[i + 1] - curve[i - 1]);
        }
    }
    return curve.back();
}

/// The indices of the values in order, the largest first; of equal ones, the lower index first.
Answer order_of(const std::vector<double>& values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t i) { return values[i]; });
    return {order.begin(), order.end()};
}

/// The number of pairs of options that the answer has in the other order.
double wrong_pairs(const Answer& answer, const Answer& observed) {
    const auto place = [](const Answer& order, double option) {
        return std::ranges::find(order, option) - order.begin();
    };
    double pairs = 0;
    for (std::size_t i = 0; i < answer.size(); ++i) {
        for (std::size_t j = i + 1; j < answer.size(); ++j) {
            pairs += place(observed, answer[i]) > place(observed, answer[j]) ? 1 : 0;
        }
    }
    return pairs;
}

// ---- guesses ---------------------------------------------------------------------------------------------------

struct Guess {
    std::string name;
    Answer answer;
};

/// The guesses that need no thought, except those of choices.
std::vector<Guess> guesses_of(const Prediction& prediction) {
    switch (prediction.kind) {
    case Prediction::Kind::Number:
        return {{"the middle of the range", {(prediction.min + prediction.max) / 2}}};
    case Prediction::Kind::Order: {
        Answer listed(prediction.options.size());
        std::iota(listed.begin(), listed.end(), 0.0);
        return {{"as listed", listed}, {"as listed, reversed", {listed.rbegin(), listed.rend()}}};
    }
    case Prediction::Kind::Curve: {
        const auto& [x, y] = std::tie(prediction.x, prediction.y);
        const double middle = (y.min + y.max) / 2;
        return {{"a horizontal line", {x.min, middle, x.max, middle}},
                {"a rising line", {x.min, y.min, x.max, y.max}},
                {"a falling line", {x.min, y.max, x.max, y.min}}};
    }
    default:
        return {};
    }
}

/// What one seed gives: for each guess of the report, how often it passed.
using Passed = std::vector<std::uint32_t>;

/// Lists what is counted, in the order in which count_seed() counts.
std::vector<CountedGuess> list_guesses(const Lesson& lesson) {
    std::vector<CountedGuess> all;
    std::uint32_t choices = 0, options = 0;
    for (const LessonStep& step : lesson.steps) {
        if (step.check) {
            const Prediction& prediction = *lesson.prediction(step.check->of);
            all.push_back({.guess = "expected", .of = prediction.id, .tried = 1, .is_expected = true});
            for (const Guess& guess : guesses_of(prediction)) {
                all.push_back({.guess = guess.name, .of = prediction.id, .tried = 1});
            }
            if (prediction.kind == Prediction::Kind::Choice) {
                ++choices;
                options = std::max(options, static_cast<std::uint32_t>(prediction.options.size()));
            }
        }
        if (step.law) {
            all.push_back({.guess = "the law", .of = step.law->of, .tried = 1, .is_expected = true});
        }
    }
    for (std::uint32_t option = 1; option <= options; ++option) {
        all.push_back({.guess = "always option " + std::to_string(option), .of = "", .tried = choices});
    }
    return all;
}

std::span<const double> places_of(const Lesson& lesson, const Check& check) {
    for (const LessonStep& step : lesson.steps) {
        const auto found = std::ranges::find(step.observe, check.names.front(), &Observed::name);
        if (found != step.observe.end()) {
            return found->at;
        }
    }
    return {};
}

/// Plays the lesson with one seed.
Passed count_seed(const Lesson& lesson, base::Seed seed, std::size_t guess_count, LessonValues& values) {
    Passed passed;
    std::vector<double> right_options;
    Play play{lesson, seed};
    for (const LessonStep& step : lesson.steps) {
        play.perform(step);
        if (step.check) {
            const Prediction& prediction = *lesson.prediction(step.check->of);
            const auto count = [&](const Answer& answer) {
                const auto compared =
                    compare_answer(*step.check, answer, play.values(), places_of(lesson, *step.check));
                passed.push_back(compared && compared->passed ? 1 : 0);
                return compared;
            };
            const auto compared = count(prediction.expected);
            for (const Guess& guess : guesses_of(prediction)) {
                count(guess.answer);
            }
            if (prediction.kind == Prediction::Kind::Choice && compared) {
                right_options.push_back(compared->observed[0]);
            }
        }
        if (step.law) {
            const auto observed = play.number(step.law->of), value = play.value_of(step.law->value),
                       error = play.value_of(step.law->error);
            passed.push_back(observed && value && error && std::abs(*observed - *value) <= 2 * *error ? 1 : 0);
        }
    }
    for (double option = 0; passed.size() < guess_count; ++option) {
        passed.push_back(static_cast<std::uint32_t>(std::ranges::count(right_options, option)));
    }
    values = play.values();
    return passed;
}

/// One line for each observation that is a number.
std::vector<std::string> summary_of(const std::vector<LessonValues>& seeds) {
    std::vector<std::string> lines;
    for (const auto& [name, first] : seeds.front()) {
        if (first.size() != 1) {
            continue;
        }
        std::vector<double> values;
        for (const LessonValues& of_seed : seeds) {
            if (const auto value = of_seed.at(name).front()) {
                values.push_back(*value);
            }
        }
        std::ranges::sort(values);
        lines.push_back(name + ": " +
                        (values.empty()
                             ? std::string{"no value"}
                             : text::rounded(values[values.size() / 2], 4) + " (" + text::rounded(values.front(), 4) +
                                   " to " + text::rounded(values.back(), 4) + ")") +
                        (values.size() == seeds.size() || values.empty()
                             ? ""
                             : ", no value for " + std::to_string(seeds.size() - values.size()) + " seeds"));
    }
    return lines;
}

/// The chance of more than `count` successes in n trials with chance p each.
double chance_of_more(std::uint32_t count, std::uint32_t n, double p) {
    double term = std::pow(1 - p, n), below = 0;
    for (std::uint32_t k = 0; k <= count && k <= n; ++k) {
        below += term;
        term *= p / (1 - p) * (n - k) / (k + 1);
    }
    return 1 - below;
}

} // namespace

std::optional<Comparison> compare_answer(const Check& check, const Answer& answer, const LessonValues& values,
                                         std::span<const double> at) {
    std::vector<double> numbers;
    for (const std::string& name : check.names) {
        const auto found = values.find(name);
        if (found == values.end()) {
            return std::nullopt;
        }
        for (const auto& value : found->second) {
            if (!value) {
                return std::nullopt;
            }
            numbers.push_back(*value);
        }
    }
    Comparison compared;
    switch (check.kind) {
    case Check::Kind::Near: {
        compared.observed = numbers;
        compared.apart = answer[0] - numbers[0];
        const double within = check.in_percent ? check.within / 100 * std::abs(numbers[0]) : check.within;
        compared.passed = std::abs(*compared.apart) <= within;
        break;
    }
    case Check::Kind::ArgMax:
    case Check::Kind::ArgMin: {
        const auto right =
            check.kind == Check::Kind::ArgMax ? std::ranges::max_element(numbers) : std::ranges::min_element(numbers);
        compared.observed = {static_cast<double>(right - numbers.begin())};
        compared.passed = answer == compared.observed;
        break;
    }
    case Check::Kind::Order:
        compared.observed = order_of(numbers);
        compared.apart = wrong_pairs(answer, compared.observed);
        compared.passed = answer == compared.observed;
        break;
    case Check::Kind::Curve: {
        double sum = 0;
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            const double distance = height_of(answer, at[i]) - numbers[i];
            sum += distance * distance;
        }
        compared.observed = numbers;
        compared.apart = std::sqrt(sum / static_cast<double>(numbers.size()));
        compared.passed = *compared.apart <= check.within;
        break;
    }
    }
    return compared;
}

std::optional<LessonReport> check_lesson(const Lesson& lesson, std::uint32_t seeds, std::size_t jobs,
                                         const std::function<bool()>& stopped) {
    EVOD_ASSERT(seeds >= 1);
    LessonReport report{.guesses = list_guesses(lesson), .observed = {}};
    std::vector<Passed> passed(seeds);
    std::vector<LessonValues> values(seeds);
    for_each_trial(
        seeds, jobs,
        [&](std::size_t trial) {
            const base::Seed seed =
                trial == 0 ? lesson.seed : replicate_seed(lesson.seed, static_cast<std::uint32_t>(trial));
            passed[trial] = count_seed(lesson, seed, report.guesses.size(), values[trial]);
        },
        stopped);
    if (std::ranges::any_of(passed, &Passed::empty) && !report.guesses.empty()) {
        return std::nullopt;
    }
    for (std::size_t guess = 0; guess < report.guesses.size(); ++guess) {
        CountedGuess& counted = report.guesses[guess];
        for (const Passed& of_seed : passed) {
            counted.passed += of_seed[guess];
        }
        counted.tried *= seeds;
        counted.is_refused = is_refused(counted.is_expected, counted.passed, counted.tried, seeds);
    }
    report.observed = summary_of(values);
    return report;
}

bool is_refused(bool is_expected, std::uint32_t passed, std::uint32_t tried, std::uint32_t seeds) {
    const std::uint32_t bad = is_expected ? tried - passed : passed;
    const std::uint32_t allowed_of_ten = is_expected ? 1 : 6;
    if (seeds >= seeds_judged_strictly) {
        return bad * 10 > tried * allowed_of_ten;
    }
    return bad > 0 && chance_of_more(bad - 1, tried, allowed_of_ten / 10.0) < 0.05;
}

} // namespace evod::experiments
