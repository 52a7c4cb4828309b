// Verdict: what the comparison of a world with its controls comes to, in sentences.
#pragma once

#include "server/experiments/comparison.h"
#include "server/experiments/controls.h"

#include <optional>
#include <string>
#include <vector>

namespace evod::experiments {

/// A control and what the world has over it; no finding: it cannot differ, and was not run.
struct Weighed {
    Control control;
    std::optional<Finding> finding;
};

/// With so many decimals, and its sign; a zero has none.
std::string signed_text(double value, int decimals);

/// Did evolution do it? A line each for the answer and for what the other controls tell.
///
/// rise     of the world, mean over its replicates, and its 95 % interval.
/// weighed  the four controls, in the order of all_controls.
///
/// The answer rests on two of them. Random selection shows what comes without any pressure; but it also keeps more of
/// the variety, for nobody has many children. Shuffled fitness has all of the pressure and none of its aim. Evolution
/// by selection did it if the world rises above both.
std::vector<std::string> verdict(double rise, const Interval& rise_interval, const std::vector<Weighed>& weighed,
                                 int decimals);

} // namespace evod::experiments
