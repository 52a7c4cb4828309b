// Figures: the plots of a history, and how another one stands beside it.
//
// Threads      none.
#pragma once

#include "client/viewer/panels/plots/history_table.h"
#include "client/viewer/panels/plots/plot.h"

#include <deque>
#include <string>
#include <vector>

namespace evod::viewer {

enum class Quantity { Fitness, Genes, Selection, Diversity, Survivors, Deaths };

/// A plot and the numbers in it that no table has. It shows tables as they are: they must stay as they were.
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
    std::string name; // in the legend, where two are compared
};

/// gene   of Quantity::Genes and Selection: its name; empty: the means of all, or what selection did to them.
/// other  null: nothing is compared. An island that it does not have is all of its islands.
Figure figure_of(Quantity quantity, const Subject& subject, const Subject* other, const std::string& gene);

/// How a gene is spread over organisms.
Figure histogram_of(const std::string& gene, std::vector<float> numbers);

} // namespace evod::viewer
