// Verdict: the conclusions from the comparison of a world with its controls, as sentences.
//
// Threads  none.
#pragma once

#include "server/experiments/comparison.h"
#include "server/experiments/controls.h"

#include <optional>
#include <string>
#include <vector>

namespace evod::experiments {

/// A control, and how the world differs from it; without a finding: the control cannot differ and was not run.
struct ControlResult {
    Control control;
    std::optional<Finding> finding;
};

/// A number with its sign; zero has none.
std::string signed_text(double value, int decimals);

/// Did evolution do it? One line for the answer, one for mutation, one for poison.
///
/// rise     of the world: mean over its replicates, and its 95 % interval.
/// results  of the four controls, in the order of all_controls.
///
/// The answer needs two controls. Random selection has no selection pressure, but also keeps more genetic variety,
/// because no organism has many children. Shuffled fitness has the same pressure without a relation to fitness. The
/// answer is yes if the world rises more than both.
std::vector<std::string> verdict(double rise, const Interval& rise_interval, const std::vector<ControlResult>& results,
                                 int decimals);

} // namespace evod::experiments
