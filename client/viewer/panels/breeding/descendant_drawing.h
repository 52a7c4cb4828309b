// Drawings of the next generation for the glass box: one of all descendants in a row, one of a descendant with its
// parents.
//
// Owner        BreedingPanel.
// Threads      none; called on the drawing thread.
#pragma once

#include "client/viewer/panels/breeding/breeding_record.h"
#include "client/viewer/panels/breeding/sheet.h"

#include <string>
#include <vector>

namespace evod::viewer {

/// Draws the next generation as a row of cells: elite, survivors, children. The cell of `current` is framed.
void draw_descendants(const Sheet& sheet, const BreedingRecord& record, const std::uint32_t* current);

/// Draws one descendant with its parents, cuts, crossover, order mutation and mutations, below each other. Of a long
/// chromosome, only the genes of the body are drawn like this; a small cell shows from which parent each other gene comes.
///
/// body_count  the number of genes of the body, which come first
/// returns     the height of the drawing in pixels
float draw_family(const Sheet& sheet, const evod::v1::Descendant& descendant,
                  const std::vector<std::string>& gene_names, std::size_t body_count);

} // namespace evod::viewer
