// Figures: builds the plots of one history, or of one history compared with another.
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

/// Generations of a running mean, unless the user chooses another number.
constexpr std::size_t running_mean_default = 10;
/// Returns the name of a running mean of this many generations: "mean of 10".
std::string running_mean_name(std::size_t window);

/// A plot together with the numbers computed for it. Its series also refer to columns of the history tables, which must
/// not change while the Figure exists.
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
    std::string name;                // name in the legend of a comparison
    std::span<const Mark> changes{}; // changes of parameters
    // The genes whose means, or whose selection, are plotted together; empty: all genes of the table.
    std::vector<std::string> genes{};
};

/// The maximum number of genes in one plot.
constexpr std::size_t genes_in_plot_max = 12;

/// Returns those of the genes that have changed most in the history of `subject`, the most changed first: in their
/// mean, or, for Quantity::Selection, by selection. If there are at most `count_max`, returns all of them in their
/// order.
std::vector<std::string> most_changed(Quantity quantity, const Subject& subject, std::vector<std::string> genes,
                                      std::size_t count_max = genes_in_plot_max);

/// Builds the plot of a quantity for `subject`.
///
/// gene   the gene shown for Quantity::Genes and Quantity::Selection; empty: the means, or the selection, of all genes.
/// other  the compared history; null: no comparison. If it has no island with this number, all its islands together are
///        shown.
/// window the number of generations of the running mean of each line and band; 1: none.
Figure figure_of(Quantity quantity, const Subject& subject, const Subject* other, const std::string& gene,
                 std::size_t window);

/// Builds the curves of the best and the mean fitness, as the sidebar shows them: with their running means, and with
/// the newest values in the legend. Without series while no generation has ended.
Figure fitness_curves(const Subject& subject);

/// Builds a histogram of a gene's values, one value per organism.
Figure histogram_of(const std::string& gene, std::vector<float> numbers);

} // namespace evod::viewer
