// Pictures of a selection, for the glass box: each fills the sheet that it is given.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/panels/breeding/breeding_record.h"
#include "client/viewer/panels/breeding/comparison.h"
#include "client/viewer/panels/breeding/sheet.h"

#include <span>

namespace evod::viewer {

/// Fitness by rank; where a wheel is spun, the weights below. A dot is above those that have `copies`, a pointer above
/// `current`.
void draw_ranking(const Sheet& sheet, const BreedingRecord& record, const Comparison& comparison,
                  std::span<const std::uint32_t> copies, const evod::v1::Pick* current);

/// The wheel, with the pointer of pick `index`, and small ones where those before fell; of universal sampling all.
void draw_wheel(const Sheet& sheet, const BreedingRecord& record, std::uint32_t index);

/// The contestants of a tournament, its winners marked.
void draw_tournament(const Sheet& sheet, const BreedingRecord& record, std::uint32_t index);

/// The picks so far in order, coloured by rank.
void draw_picks(const Sheet& sheet, const BreedingRecord& record, std::uint32_t index);

/// How often each rank was picked, and its expectation; below, the deviations in standard errors.
void draw_copies(const Sheet& sheet, const Comparison& comparison, std::span<const std::uint32_t> copies,
                 double expected_share);

} // namespace evod::viewer
