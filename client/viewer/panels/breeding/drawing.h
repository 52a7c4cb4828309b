// The glass box's pictures, on a draw list of Dear ImGui: each fills the rectangle that it is given.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/panels/breeding/breeding_record.h"
#include "client/viewer/panels/breeding/comparison.h"

#include <imgui.h>

#include <span>
#include <string>
#include <vector>

namespace evod::viewer {

struct Sheet {
    ImDrawList& list;
    ImFont& font;
    ImVec2 corner, size; // pixels
    ImVec2 end() const { return {corner.x + size.x, corner.y + size.y}; }
};

/// Fitness by rank; where a wheel is spun, the weights below. Those of `marked` have a dot above.
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

/// The next generation as a row of cells: elite, survivors, children; the current one framed.
void draw_descendants(const Sheet& sheet, const BreedingRecord& record, const std::uint32_t* current);

/// Parents, cuts, child, rearrangement and mutations of one descendant, as high as it takes.
///
/// returns  its height in pixels
float draw_family(const Sheet& sheet, const evod::v1::Descendant& descendant,
                  const google::protobuf::RepeatedPtrField<std::string>& gene_names);

} // namespace evod::viewer
