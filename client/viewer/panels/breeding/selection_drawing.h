// Drawings of a selection for the glass box. Each fills its sheet.
//
// Owner        BreedingPanel.
// Threads      none; called on the drawing thread.
#pragma once

#include "client/viewer/panels/breeding/breeding_record.h"
#include "client/viewer/panels/breeding/comparison.h"
#include "client/viewer/panels/breeding/sheet.h"

#include <span>

namespace evod::viewer {

/// Fitness by rank, and for a scaled wheel the weights below it. A dot marks ranks that have `copies`, a pointer marks
/// the organism of `current`.
void draw_ranking(const Sheet& sheet, const BreedingRecord& record, const Comparison& comparison,
                  std::span<const std::uint32_t> copies, const evod::v1::Pick* current);

/// The wheel with the pointer of pick `index` and small marks for the earlier picks; for universal sampling, for all.
void draw_wheel(const Sheet& sheet, const BreedingRecord& record, std::uint32_t index);

/// The contestants of a tournament with its winners marked.
void draw_tournament(const Sheet& sheet, const BreedingRecord& record, std::uint32_t index);

/// The picks up to `index` in order, coloured by rank.
void draw_picks(const Sheet& sheet, const BreedingRecord& record, std::uint32_t index);

/// Copies of each rank with the expected copies; below them the deviations in standard errors.
///
/// expected_share  the fraction of the picks that `copies` counts, 0 to 1.
void draw_copies(const Sheet& sheet, const Comparison& comparison, std::span<const std::uint32_t> copies,
                 double expected_share);

} // namespace evod::viewer
