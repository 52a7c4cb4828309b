// Figures: builds the plots of a history, alone or compared with another one.
//
// Owner        PlotsPanel.
// Threads      none.
#pragma once

#include "client/viewer/panels/plots/history_table.h"
#include "client/viewer/panels/plots/plot.h"

#include <deque>
#include <string>
#include <vector>

namespace evod::viewer {

enum class Quantity { Fitness, Genes, Selection, Diversity, Survivors, Deaths };

/// A plot with the numbers that it computes itself. Its series also refer to the tables, which must not change while it
/// lives.
struct Figure {
    Plot plot;
    std::deque<std::vector<double>> numbers;

    Figure() = default;
    Figure(Figure&&) = default;
    Figure& operator=(Figure&&) = default;
};

struct Subject {
    const HistoryTable& table;
    HistoryTable::Island island;
    std::string name; // in the legend of a comparison
};

/// gene   name of a gene for Quantity::Genes and Selection; empty: the means, or the selection, of all genes.
/// other  null: no comparison. If it has no such island, all its islands together are shown.
Figure figure_of(Quantity quantity, const Subject& subject, const Subject* other, const std::string& gene);

/// The distribution of a gene over organisms.
Figure histogram_of(const std::string& gene, std::vector<float> numbers);

} // namespace evod::viewer
