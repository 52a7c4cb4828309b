#include "client/viewer/panels/plots/figures.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>

namespace evod::viewer {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::IsNan;

HistoryTable table_of(std::uint32_t islands, std::uint64_t generations) {
    HistoryTable table;
    table.set_gene_names({"impulse", "body_size"});
    for (std::uint64_t generation = 1; generation <= generations; ++generation) {
        std::vector<std::vector<double>> rows;
        for (std::uint32_t island = 0; island < islands; ++island) {
            v1::GenerationStatistics statistics;
            statistics.set_generation(generation);
            statistics.set_island(island);
            statistics.set_organism_count(10);
            statistics.set_fitness_mean(5 + island);
            statistics.set_fitness_deviation(2);
            statistics.set_fitness_best(20);
            statistics.set_fitness_worst(4);
            statistics.set_starved_count(3);
            statistics.set_poisoned_count(1);
            statistics.add_genes()->set_mean(100);
            statistics.mutable_genes(0)->set_deviation(4);
            statistics.mutable_genes(0)->set_min(90);
            statistics.mutable_genes(0)->set_max(102);
            statistics.add_genes()->set_mean(50);
            if (generation > 1) { // the first generation has no predecessor
                v1::GeneAccount& account = *statistics.mutable_genes(0)->mutable_account();
                account.set_selection(3 + 2 * island);
                account.set_transmission(-1);
                account.set_migration(0.5);
                account.set_change(2.5 + 2 * island);
            }
            rows.push_back(core::history_numbers(statistics));
        }
        table.add(rows);
    }
    return table;
}

std::vector<std::string> names_of(const Figure& figure) {
    std::vector<std::string> names;
    for (const Series& series : figure.plot.series) {
        names.push_back(series.name);
    }
    return names;
}

TEST(Figures, TheCurvesOfTheSidebarHaveRunningMeans) {
    HistoryTable table;
    EXPECT_TRUE(fitness_curves({table, std::nullopt, ""}).plot.series.empty());
    for (std::uint64_t generation = 1; generation <= 12; ++generation) {
        v1::GenerationStatistics statistics;
        statistics.set_generation(generation);
        statistics.set_organism_count(10);
        statistics.set_fitness_best(static_cast<double>(10 * generation));
        statistics.set_fitness_mean(static_cast<double>(generation));
        table.add(std::array{core::history_numbers(statistics)});
    }
    const Figure figure = fitness_curves({table, std::nullopt, ""});
    ASSERT_THAT(names_of(figure), ElementsAre("best", "mean"));
    const Series& best = figure.plot.series[0];
    EXPECT_EQ(best.raw[11], 120);
    EXPECT_EQ(best.y[11], 75) << "the mean of 30 to 120";
    EXPECT_EQ(best.newest, "120");
    EXPECT_EQ(figure.plot.smoothed, "mean of 10");
}

/// A table of genes a, b, …, whose means change by these numbers from the first generation to the second.
HistoryTable table_of_changes(const std::vector<double>& changes) {
    HistoryTable table;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < changes.size(); ++i) {
        names.push_back({static_cast<char>('a' + i)});
    }
    table.set_gene_names(names);
    for (std::uint64_t generation = 1; generation <= 2; ++generation) {
        v1::GenerationStatistics statistics;
        statistics.set_generation(generation);
        statistics.set_organism_count(10);
        for (std::size_t i = 0; i < changes.size(); ++i) {
            v1::GeneStatistics& gene = *statistics.add_genes();
            gene.set_mean(generation == 1 ? 1 : 1 + changes[i]);
            if (generation > 1) {
                gene.mutable_account()->set_selection(-changes[changes.size() - 1 - i]);
            }
        }
        table.add(std::array{core::history_numbers(statistics)});
    }
    return table;
}

TEST(Figures, AFewGenesArePlottedTheMostChangedFirst) {
    const HistoryTable table = table_of_changes({0, -3, 1, 2});
    Subject subject{table, std::nullopt, "lab"};
    const std::vector<std::string> all = table.gene_names();
    EXPECT_EQ(most_changed(Quantity::Genes, subject, all, 4), all) << "few enough to keep their order";
    EXPECT_THAT(most_changed(Quantity::Genes, subject, all, 3), ElementsAre("b", "d", "c"));
    EXPECT_THAT(most_changed(Quantity::Selection, subject, all, 3), ElementsAre("c", "a", "b"));
    EXPECT_THAT(names_of(figure_of(Quantity::Genes, subject, nullptr, "", 1)), ElementsAre("a", "b", "c", "d"));
    subject.genes = {"b", "d"};
    EXPECT_THAT(names_of(figure_of(Quantity::Genes, subject, nullptr, "", 1)), ElementsAre("b", "d"));
    EXPECT_THAT(names_of(figure_of(Quantity::Selection, subject, nullptr, "", 1)), ElementsAre("b", "d"));
}

TEST(Figures, TwelveCurvesHaveTwelveColours) {
    const HistoryTable table = table_of_changes(std::vector<double>(12, 1.0));
    std::vector<Colour> colours;
    for (const Series& series : figure_of(Quantity::Genes, {table, std::nullopt, "lab"}, nullptr, "", 1).plot.series) {
        EXPECT_EQ(std::ranges::count(colours, series.colour), 0) << series.name;
        colours.push_back(series.colour);
    }
    EXPECT_EQ(colours.size(), genes_in_plot_max);
}

TEST(Figures, FitnessIsFourLinesAndABand) {
    const HistoryTable table = table_of(1, 3);
    const Figure figure = figure_of(Quantity::Fitness, {table, 0u, "lab"}, nullptr, "", 1);
    EXPECT_THAT(names_of(figure), ElementsAre("best", "mean", "median", "worst", "± 1 standard deviation"));
    EXPECT_THAT(figure.plot.series[4].low, Each(4)) << "not 3, because the worst is 4";
    EXPECT_THAT(figure.plot.series[4].y, Each(7));
    EXPECT_THAT(figure.plot.series[0].x, ElementsAre(1, 2, 3));
    EXPECT_TRUE(figure.plot.from_zero);
    EXPECT_EQ(whole_x(figure.plot), (Range{1, 3}));
}

TEST(Figures, TheMedianOfSeveralIslandsIsNotShown) {
    const HistoryTable table = table_of(2, 3);
    EXPECT_THAT(names_of(figure_of(Quantity::Fitness, {table, std::nullopt, "lab"}, nullptr, "", 1)),
                ElementsAre("best", "mean", "worst", "± 1 standard deviation"));
}

TEST(Figures, AComparisonAddsLinesWithTheirOwnNames) {
    const HistoryTable table = table_of(2, 3), other = table_of(1, 5);
    const Subject beside{other, 1u, "yesterday"}; // has no island 1
    const Figure figure = figure_of(Quantity::Diversity, {table, 1u, "lab"}, &beside, "", 1);
    EXPECT_THAT(names_of(figure), ElementsAre("diversity", "diversity, yesterday"));
    EXPECT_EQ(figure.plot.series[1].kind, Series::Kind::Dashes);
    EXPECT_FALSE(figure.plot.series[1].in_legend);
    EXPECT_EQ(figure.plot.solid + " " + figure.plot.dashed, "lab yesterday");
    EXPECT_EQ(figure.plot.series[1].x.size(), 5u);
    EXPECT_EQ(whole_x(figure.plot), (Range{1, 5}));
}

TEST(Figures, GenesAreShownOneByOneOrTogether) {
    const HistoryTable table = table_of(1, 3);
    EXPECT_THAT(names_of(figure_of(Quantity::Genes, {table, 0u, "lab"}, nullptr, "", 1)),
                ElementsAre("impulse", "body_size"));
    const Figure figure = figure_of(Quantity::Genes, {table, 0u, "lab"}, nullptr, "impulse", 1);
    EXPECT_THAT(names_of(figure), ElementsAre("mean", "greatest", "least", "± 1 standard deviation"));
    EXPECT_THAT(figure.plot.series[3].low, Each(96));
    EXPECT_THAT(figure.plot.series[3].y, Each(102)) << "not 104, because the greatest is 102";
}

TEST(Figures, SelectionIsShownForAllGenesOrOneInParts) {
    const HistoryTable table = table_of(2, 3);
    EXPECT_THAT(names_of(figure_of(Quantity::Selection, {table, 0u, "lab"}, nullptr, "", 1)), ElementsAre("impulse"))
        << "the other gene has no account";
    const Figure figure = figure_of(Quantity::Selection, {table, std::nullopt, "lab"}, nullptr, "impulse", 1);
    ASSERT_THAT(names_of(figure), ElementsAre("change", "selection", "transmission", "migration"));
    EXPECT_THAT(figure.plot.series[3].y, ElementsAre(IsNan(), 0.5, 0.5));
    EXPECT_THAT(figure.plot.series[1].y, ElementsAre(IsNan(), 4, 4)) << "the mean of both islands";
    EXPECT_THAT(figure.plot.series[0].y, ElementsAre(IsNan(), 3.5, 3.5));
    EXPECT_TRUE(names_of(figure_of(Quantity::Selection, {table, 0u, "lab"}, nullptr, "body_size", 1)).empty());
}

TEST(Figures, ARunningMeanKeepsTheNumbersOfEachGeneration) {
    HistoryTable table;
    for (std::uint64_t generation = 1; generation <= 4; ++generation) {
        v1::GenerationStatistics statistics;
        statistics.set_generation(generation);
        statistics.set_diversity(static_cast<double>(generation));
        table.add(std::vector<std::vector<double>>{core::history_numbers(statistics)});
    }
    const Figure figure = figure_of(Quantity::Diversity, {table, 0u, "lab"}, nullptr, "", 3);
    EXPECT_THAT(figure.plot.series.at(0).raw, ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(figure.plot.series.at(0).y, ElementsAre(1, 1.5, 2, 3));
    EXPECT_EQ(figure.plot.smoothed, "mean of 3");
    EXPECT_TRUE(figure_of(Quantity::Diversity, {table, 0u, "lab"}, nullptr, "", 1).plot.series.at(0).raw.empty());
}

TEST(Figures, MarkTheChangesOfBothHistories) {
    const HistoryTable table = table_of(1, 3);
    const std::vector<Mark> changes{{2, "generation 2: a 1 → 2 by alice"}}, others{{1, "x"}, {3, "y"}};
    const Subject subject{table, 0u, "lab", changes}, beside{table, 0u, "fork", others};
    const Figure alone = figure_of(Quantity::Fitness, subject, nullptr, "", 1);
    ASSERT_EQ(alone.plot.marks.size(), 1u);
    EXPECT_EQ(alone.plot.marks[0].name, "") << "no need to name the only history";
    EXPECT_EQ(alone.plot.marks[0].marks[0].text, "generation 2: a 1 → 2 by alice");
    const Figure both = figure_of(Quantity::Fitness, subject, &beside, "", 1);
    ASSERT_EQ(both.plot.marks.size(), 2u);
    EXPECT_EQ(both.plot.marks[0].name, "lab");
    EXPECT_EQ(both.plot.marks[1].name, "fork");
    EXPECT_EQ(both.plot.marks[1].marks.size(), 2u);
}

TEST(Figures, DeathsAreStacked) {
    const HistoryTable table = table_of(2, 3);
    const Figure figure = figure_of(Quantity::Deaths, {table, std::nullopt, "lab"}, nullptr, "", 1);
    ASSERT_THAT(names_of(figure), ElementsAre("starved", "poisoned"));
    EXPECT_EQ(figure.plot.series[0].kind, Series::Kind::Stack);
    EXPECT_THAT(figure.plot.series[0].y, Each(6));
    EXPECT_EQ(whole_x(figure.plot), (Range{0.5, 3.5})) << "whole bars";
}

TEST(Figures, AnEmptyTableGivesNoSeries) {
    const HistoryTable table;
    for (const auto quantity : {Quantity::Fitness, Quantity::Genes, Quantity::Selection, Quantity::Diversity,
                                Quantity::Survivors, Quantity::Deaths}) {
        EXPECT_TRUE(figure_of(quantity, {table, std::nullopt, "lab"}, nullptr, "", 10).plot.series.empty());
    }
    EXPECT_TRUE(histogram_of("impulse", {}).plot.series.empty());
}

TEST(Figures, AHistogramCountsEveryOrganism) {
    const Figure figure = histogram_of("impulse", {1, 1, 2, 5, 9});
    const Series& bars = figure.plot.series.at(0);
    EXPECT_EQ(bars.y.size(), 8u);
    EXPECT_DOUBLE_EQ(bars.bar_width, 1);
    EXPECT_EQ(bars.y[0] + bars.y[1] + bars.y[4] + bars.y[7], 5);
    EXPECT_EQ(bars.y[0], 2);
    const Figure alike = histogram_of("impulse", {3, 3, 3});
    double count = 0;
    for (const double bin : alike.plot.series.at(0).y) {
        count += bin;
    }
    EXPECT_EQ(count, 3);
}

} // namespace
} // namespace evod::viewer
