// Verdict: derives conclusions from the comparison of a world with its controls, and formats them as sentences.
//
// Threads  none.
#pragma once

#include "server/experiments/comparison.h"
#include "server/experiments/controls.h"

#include <optional>
#include <string>
#include <vector>

namespace evod::experiments {

/// A control and its difference from the world. There is no finding if the control cannot differ and was not run.
struct ControlResult {
    Control control;
    std::optional<Finding> finding;
};

/// A number with its sign. Zero has no sign.
std::string signed_text(double value, int decimals);

/// Answers the question "Did evolution do it?". Returns one line for the answer, one for mutation and one for poison.
///
/// rise     rise of the world: the mean over its replicates, with its 95 % confidence interval.
/// results  results of the four controls, in the order of all_controls.
///
/// The answer needs two controls. Random selection has no selection pressure, but also keeps more genetic variety,
/// because no organism has many children. Shuffled fitness has the same selection pressure, but without a relation to
/// the real fitness. The answer is yes if the world rises more than both controls.
std::vector<std::string> verdict(double rise, const Interval& rise_interval, const std::vector<ControlResult>& results,
                                 int decimals);

} // namespace evod::experiments
