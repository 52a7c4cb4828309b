// Fitness curve: draws the best and the mean fitness of each generation.
//
// Owner        none: functions.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/drawing/gui.h"
#include "client/viewer/world/fitness_history.h"

#include <cstdint>
#include <optional>
#include <span>

namespace evod::viewer {

/// Returns the generations to draw in this many columns of pixels: all of them, or one per column, with the greatest
/// best fitness and the mean of the means of its generations.
std::vector<FitnessHistory::Generation> reduced(std::span<const FitnessHistory::Generation> generations,
                                                std::size_t columns);

/// Draws the curve as a widget as wide as the panel. A note shows the numbers of the generation under the mouse.
///
/// complete  whether all finished generations are known
/// returns   the generation that the user has clicked
std::optional<std::uint64_t> build_fitness_curve(std::span<const FitnessHistory::Generation> generations, bool complete,
                                                 const Gui& gui);

} // namespace evod::viewer
