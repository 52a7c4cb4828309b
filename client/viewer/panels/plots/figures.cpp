#include "client/viewer/panels/plots/figures.h"

#include "client/viewer/text/numbers.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace evod::viewer {

namespace {

constexpr Colour gene_colours[] = {palette::series_blue,   palette::series_orange,    palette::series_green,
                                   palette::series_purple, palette::series_vermilion, palette::series_sky};
/// Returns a colour for the gene with this index in a plot; the colours after the first six are darker.
Colour gene_colour(std::size_t index) {
    Colour colour = gene_colours[index % std::size(gene_colours)];
    if (index / std::size(gene_colours) % 2 == 1) {
        for (std::uint8_t* part : {&colour.red, &colour.green, &colour.blue}) {
            *part = static_cast<std::uint8_t>(*part * 0.55);
        }
    }
    return colour;
}

constexpr std::uint8_t band_alpha = 60;
constexpr std::size_t bins_min = 8, bins_max = 60;

Colour pale(Colour colour) {
    colour.alpha = band_alpha;
    return colour;
}

class FigureBuilder {
  public:
    FigureBuilder(const Subject& subject, const Subject* other, std::size_t window)
        : subject_{subject}, other_{other}, window_{window} {
        plot().marks.push_back({subject.changes, other != nullptr ? subject.name : ""});
        if (other != nullptr) {
            plot().marks.push_back({other->changes, other->name});
        }
        plot().smoothed = running_mean_name(window);
    }

    Figure take() { return std::move(figure_); }
    Plot& plot() { return figure_.plot; }

    /// Adds a line for a column of the subject; if `compared`, also one for the same column of the other subject.
    void line(const std::string& column, const std::string& name, Colour colour, bool compared, bool whole = false) {
        add_line(subject_, Series::Kind::Line, column, name, colour, whole);
        if (other_ != nullptr && compared) {
            add_line(*other_, Series::Kind::Dashes, column, name + ", " + other_->name, colour, whole);
            plot().solid = subject_.name;
            plot().dashed = other_->name;
        }
    }

    /// Adds a band of one standard deviation on either side of the mean, as far as it is within the range of the
    /// values.
    void band(const std::string& of, const std::string& least, const std::string& greatest, Colour colour) {
        const auto mean = column(subject_, of + "_mean"), deviation = column(subject_, of + "_deviation");
        const auto min = column(subject_, least), max = column(subject_, greatest);
        if (mean.empty() || mean.size() != deviation.size()) {
            return;
        }
        std::vector<double> low(mean.size()), high(mean.size());
        for (std::size_t i = 0; i < mean.size(); ++i) {
            low[i] = std::max(mean[i] - deviation[i], min[i]);
            high[i] = std::min(mean[i] + deviation[i], max[i]);
        }
        figure_.plot.series.push_back({.kind = Series::Kind::Band,
                                       .name = "± 1 standard deviation",
                                       .colour = pale(colour),
                                       .x = column(subject_, "generation"),
                                       .y = figure_.numbers.emplace_back(running_mean(high, window_)),
                                       .low = figure_.numbers.emplace_back(running_mean(low, window_))});
    }

    void stack(const std::string& column, const std::string& name, Colour colour) {
        add(subject_, Series::Kind::Stack, column, named(name, subject_), colour, true);
    }
    void compare(const std::string& column, const std::string& name, Colour colour) {
        if (other_ != nullptr) {
            add(*other_, Series::Kind::Dashes, column, named(name, *other_), colour, true);
        }
    }

    static std::span<const double> column(const Subject& subject, const std::string& name) {
        const bool has_island = subject.island && *subject.island < subject.table.island_count();
        return subject.table.column(has_island ? subject.island : std::nullopt, name);
    }

  private:
    std::string named(const std::string& name, const Subject& subject) const {
        return other_ == nullptr ? name : name + ", " + subject.name;
    }
    /// Adds a line, with its running mean; the legend names a line of the compared history only by its dashes.
    void add_line(const Subject& subject, Series::Kind kind, const std::string& column, std::string name, Colour colour,
                  bool whole) {
        if (!add(subject, kind, column, std::move(name), colour, whole)) {
            return;
        }
        Series& series = figure_.plot.series.back();
        series.in_legend = kind == Series::Kind::Line;
        if (window_ > 1) {
            series.raw = series.y;
            series.y = figure_.numbers.emplace_back(running_mean(series.raw, window_));
        }
    }
    /// Returns false if the history contains no such numbers.
    bool add(const Subject& subject, Series::Kind kind, const std::string& name, std::string legend, Colour colour,
             bool whole) {
        const auto x = column(subject, "generation"), y = column(subject, name);
        const bool known = std::ranges::any_of(y, [](double number) { return std::isfinite(number); });
        if (x.size() == y.size() && known) {
            figure_.plot.series.push_back(
                {.kind = kind, .name = std::move(legend), .colour = colour, .x = x, .y = y, .whole = whole});
            return true;
        }
        return false;
    }

    const Subject& subject_;
    const Subject* other_;
    std::size_t window_; // generations of the running mean
    Figure figure_;
};

/// Returns whether the plotted genes are weights of a network.
bool is_weight(const std::string& gene, const Subject& subject) {
    const std::string& first = !gene.empty() || subject.genes.empty() ? gene : subject.genes.front();
    return first.find('<') != std::string::npos;
}

/// Returns whether an axis from 0 leaves the curves of fitness at least half of its height.
bool starts_at_zero(const Subject& subject) {
    const auto worst = range_of(FigureBuilder::column(subject, "fitness_worst"));
    const auto best = range_of(FigureBuilder::column(subject, "fitness_best"));
    return worst && best && worst->min < best->max / 2;
}

} // namespace

std::string running_mean_name(std::size_t window) {
    return "mean of " + std::to_string(window);
}

Figure figure_of(Quantity quantity, const Subject& subject, const Subject* other, const std::string& gene,
                 std::size_t window) {
    FigureBuilder make{subject, other, window};
    make.plot().x_label = "generation";
    make.plot().counted_x = true;
    switch (quantity) {
    case Quantity::Fitness:
        make.plot().title = "Fitness";
        make.plot().y_label = "fitness";
        make.plot().from_zero = starts_at_zero(subject);
        make.line("fitness_best", "best", palette::series_vermilion, true);
        make.line("fitness_mean", "mean", palette::series_blue, true);
        make.line("fitness_median", "median", palette::series_sky, false);
        make.line("fitness_worst", "worst", palette::series_grey, false);
        make.band("fitness", "fitness_worst", "fitness_best", palette::series_blue);
        break;
    case Quantity::Genes:
        make.plot().y_label = is_weight(gene, subject) ? "weight" : "gene units";
        if (gene.empty()) {
            make.plot().title = "Means of the genes";
            const auto& names = subject.genes.empty() ? subject.table.gene_names() : subject.genes;
            for (std::size_t i = 0; i < names.size(); ++i) {
                make.line(names[i] + "_mean", names[i], gene_colour(i), true);
            }
        } else {
            make.plot().title = "Gene " + gene;
            make.line(gene + "_mean", "mean", palette::series_green, true);
            make.line(gene + "_max", "greatest", palette::series_grey, false);
            make.line(gene + "_min", "least", palette::series_grey, false);
            make.band(gene, gene + "_min", gene + "_max", palette::series_green);
        }
        break;
    case Quantity::Selection:
        make.plot().y_label = is_weight(gene, subject) ? "weight per generation" : "gene units per generation";
        if (gene.empty()) {
            make.plot().title = "Selection of the genes";
            const auto& names = subject.genes.empty() ? subject.table.gene_names() : subject.genes;
            for (std::size_t i = 0; i < names.size(); ++i) {
                make.line(names[i] + "_selection", names[i], gene_colour(i), true);
            }
        } else { // the change is the sum of the other series
            make.plot().title = "Causes of change in the mean of " + gene;
            make.line(gene + "_change", "change", palette::series_grey, true);
            make.line(gene + "_selection", "selection", palette::series_blue, true);
            make.line(gene + "_transmission", "transmission", palette::series_orange, true);
            make.line(gene + "_migration", "migration", palette::series_purple, true);
        }
        break;
    case Quantity::Diversity:
        make.plot().title = "Diversity";
        make.plot().y_label = "mean standard deviation, as a share of the gene's range";
        make.plot().from_zero = true;
        make.line("diversity", "diversity", palette::series_purple, true);
        break;
    case Quantity::Survivors:
        make.plot().title = "Alive at the end";
        make.plot().y_label = "organisms";
        make.plot().from_zero = true;
        make.line("alive_count", "alive at the end", palette::series_green, true, true);
        make.line("organism_count", "born", palette::series_grey, false, true);
        break;
    case Quantity::Deaths:
        make.plot().title = "Causes of death";
        make.plot().y_label = "organisms";
        make.plot().from_zero = true;
        make.stack("starved_count", "starved", palette::series_orange);
        make.stack("poisoned_count", "poisoned", palette::series_vermilion);
        make.compare("starved_count", "starved", palette::series_sky);
        make.compare("poisoned_count", "poisoned", palette::series_blue);
        break;
    }
    return make.take();
}

std::vector<std::string> most_changed(Quantity quantity, const Subject& subject, std::vector<std::string> genes,
                                      std::size_t count_max) {
    if (genes.size() <= count_max) {
        return genes;
    }
    const auto change_of = [&](const std::string& gene) {
        if (quantity == Quantity::Selection) {
            const auto selection = FigureBuilder::column(subject, gene + "_selection");
            return std::accumulate(selection.begin(), selection.end(), 0.0, [](double sum, double number) {
                return std::isfinite(number) ? sum + number : sum; // the first generation has none
            });
        }
        const auto mean = FigureBuilder::column(subject, gene + "_mean");
        return mean.empty() ? 0.0 : mean.back() - mean.front();
    };
    std::vector<std::pair<double, std::size_t>> ranked; // the negative change, so that ties keep their order
    for (std::size_t i = 0; i < genes.size(); ++i) {
        const double change = change_of(genes[i]);
        ranked.push_back({std::isfinite(change) ? -std::abs(change) : 0, i});
    }
    std::ranges::sort(ranked);
    std::vector<std::string> most;
    for (std::size_t i = 0; i < count_max; ++i) {
        most.push_back(genes[ranked[i].second]);
    }
    return most;
}

Figure fitness_curves(const Subject& subject) {
    FigureBuilder make{subject, nullptr, running_mean_default};
    make.line("fitness_best", "best", palette::series_orange, false);
    make.line("fitness_mean", "mean", palette::series_blue, false);
    for (Series& series : make.plot().series) {
        series.newest = significant(series.raw.back());
    }
    return make.take();
}

Figure histogram_of(const std::string& gene, std::vector<float> numbers) {
    Figure figure;
    figure.plot.title = gene;
    figure.plot.x_label = gene;
    figure.plot.y_label = "organisms";
    figure.plot.from_zero = true;
    if (numbers.empty()) {
        return figure;
    }
    const auto [least, greatest] = std::ranges::minmax(numbers);
    const Range range = with_room({least, greatest}, 0);
    const auto count = std::clamp(static_cast<std::size_t>(2 * std::cbrt(static_cast<double>(numbers.size()))),
                                  bins_min, bins_max); // number of bins by Rice's rule
    const double width = range.width() / static_cast<double>(count);
    auto& middles = figure.numbers.emplace_back();
    for (std::size_t i = 0; i < count; ++i) {
        middles.push_back(range.min + (static_cast<double>(i) + 0.5) * width);
    }
    auto& bins = figure.numbers.emplace_back(histogram(numbers, range, count));
    figure.plot.series.push_back({.kind = Series::Kind::Bars,
                                  .name = "organisms",
                                  .in_legend = false,
                                  .colour = palette::series_green,
                                  .x = middles,
                                  .y = bins,
                                  .low = {},
                                  .bar_width = width,
                                  .whole = true});
    return figure;
}

} // namespace evod::viewer
