// Drawings of the next generation for the glass box: all descendants in a row, and one descendant with its parents.
//
// Owner        BreedingPanel.
// Threads      none; called on the drawing thread.
#pragma once

#include "client/viewer/panels/breeding/breeding_record.h"
#include "client/viewer/panels/breeding/sheet.h"

#include <string>
#include <vector>

namespace evod::viewer {

/// The next generation as a row of cells: elite, survivors, children. The current cell is framed.
void draw_descendants(const Sheet& sheet, const BreedingRecord& record, const std::uint32_t* current);

/// Parents, cuts, child, order mutation and mutations of one descendant; takes the height it needs.
///
/// returns  its height in pixels
float draw_family(const Sheet& sheet, const evod::v1::Descendant& descendant,
                  const std::vector<std::string>& gene_names);

} // namespace evod::viewer
