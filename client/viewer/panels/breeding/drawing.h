// Pictures of the next generation, for the glass box.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/panels/breeding/breeding_record.h"
#include "client/viewer/panels/breeding/sheet.h"

#include <string>
#include <vector>

namespace evod::viewer {

/// The next generation as a row of cells: elite, survivors, children; the current one framed.
void draw_descendants(const Sheet& sheet, const BreedingRecord& record, const std::uint32_t* current);

/// Parents, cuts, child, rearrangement and mutations of one descendant, as high as it takes.
///
/// returns  its height in pixels
float draw_family(const Sheet& sheet, const evod::v1::Descendant& descendant,
                  const std::vector<std::string>& gene_names);

} // namespace evod::viewer
