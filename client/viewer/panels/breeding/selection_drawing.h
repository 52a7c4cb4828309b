// Drawings of a selection for the glass box. Each drawing fills its sheet.
//
// Owner        BreedingPanel.
// Threads      none; called on the drawing thread.
#pragma once

#include "client/viewer/panels/breeding/breeding_record.h"
#include "client/viewer/panels/breeding/comparison.h"
#include "client/viewer/panels/breeding/sheet.h"

#include <span>

namespace evod::viewer {

// `complete` states whether all picks were made. Until then, notes do not contain the final number of copies.

/// Draws fitness by rank; for a wheel with fitness scaling, also draws the weights below. Dots mark the ranks whose
/// `copies` are not 0; a pointer marks the organism `current`.
void draw_ranking(const Sheet& sheet, const BreedingRecord& record, const Comparison& comparison,
                  std::span<const std::uint32_t> copies, const evod::v1::Pick* current, bool complete);

/// Draws the wheel with the pointer of pick `index` and small marks for earlier picks. For universal sampling, marks
/// all picks.
void draw_wheel(const Sheet& sheet, const BreedingRecord& record, std::uint32_t index, bool complete);

/// Draws the contestants of the tournament of pick `index` and marks its winners.
void draw_tournament(const Sheet& sheet, const BreedingRecord& record, std::uint32_t index, bool complete);

/// Draws the picks up to `index` in order, coloured by rank.
void draw_picks(const Sheet& sheet, const BreedingRecord& record, std::uint32_t index);

/// Draws the observed and the expected copies of each rank. If the picks are complete, draws the deviations in standard
/// errors below.
///
/// expected_share  the fraction of all picks that `copies` includes, 0 to 1.
void draw_copies(const Sheet& sheet, const Comparison& comparison, std::span<const std::uint32_t> copies,
                 double expected_share, bool complete);

} // namespace evod::viewer
