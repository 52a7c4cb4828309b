// Lesson check: plays a lesson with several seeds, and counts how often its checks pass: with the predictions that its
// author expects, and with guesses that need no thought.
//
// Threads      `jobs` threads share the seeds (trials.h).
// Determinism  the counts depend only on the lesson and the number of seeds.
#pragma once

#include "server/experiments/lesson_file.h"

#include <algorithm>
#include <functional>
#include <map>
#include <span>

namespace evod::experiments {

/// The values of the observations of a lesson so far, by name. A list has several.
using LessonValues = std::map<std::string, std::vector<std::optional<double>>, std::less<>>;

/// How an answer compares with what was observed.
struct Comparison {
    Answer observed; // in the form of the answer; of a curve: its values at the places of the observation
    bool passed = false;
    std::optional<double> apart; // docs/LESSONS.md, Checks
};
/// Compares an answer with observations; nullopt if one of them has no value.
///
/// at  the places of the observation of a curve.
std::optional<Comparison> compare_answer(const Check& check, const Answer& answer, const LessonValues& values,
                                         std::span<const double> at);

struct CountedGuess {
    std::string guess; // "expected", "the middle", "always option 2", "a horizontal line", "the law"
    std::string of;    // id of the prediction, or name of the observation of a law; empty: all choices of the lesson
    std::uint32_t passed = 0, tried = 0; // over all seeds
    bool is_expected = false;            // it has to pass
    bool is_refused = false;
};

struct LessonReport {
    std::vector<CountedGuess> guesses;
    std::vector<std::string> observed; // for each observation that is a number: name, median, least and largest value

    bool is_refused() const { return std::ranges::any_of(guesses, &CountedGuess::is_refused); }
};

/// Plays a lesson with its own seed and others that are derived from it. Returns nullopt after stopped() returned true.
std::optional<LessonReport> check_lesson(
    const Lesson& lesson, std::uint32_t seeds, std::size_t jobs,
    const std::function<bool()>& stopped = [] { return false; });

/// Whether a guess that passed in `passed` of `tried` cases is refused: from 20 seeds on, an expected answer must pass
/// nine of ten, and another one at most six of ten. With fewer seeds, it is refused only if the chance of so bad a
/// result would be below 5 % at these shares.
bool is_refused(bool is_expected, std::uint32_t passed, std::uint32_t tried, std::uint32_t seeds);

} // namespace evod::experiments
