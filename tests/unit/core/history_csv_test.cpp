#include "client/core/history_csv.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace evod::core {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

v1::GenerationStatistics statistics_of(std::uint64_t generation, std::uint32_t island) {
    v1::GenerationStatistics statistics;
    statistics.set_generation(generation);
    statistics.set_island(island);
    statistics.set_end_tick(9'007'199'254'740'991);
    statistics.set_fitness_best(1.0 / 3);
    statistics.set_fitness_worst(-1e-300);
    for (int gene = 0; gene < 2; ++gene) {
        statistics.add_genes()->set_mean(0.1 + gene);
        statistics.mutable_genes(gene)->set_deviation(2.0 / 7);
        if (generation == 1) {
            continue; // it came from none
        }
        statistics.mutable_genes(gene)->mutable_account()->set_selection(1.0 / 7 + gene);
        statistics.mutable_genes(gene)->mutable_account()->set_change(-1.0 / 9);
    }
    return statistics;
}

const std::vector<std::string> genes{"impulse", "body_size"};

std::string csv(std::initializer_list<v1::GenerationStatistics> all) {
    std::string text = history_heading(genes);
    for (const auto& statistics : all) {
        text += history_line(history_numbers(statistics));
    }
    return text;
}

std::string error_of(const std::string& text) {
    const auto read = read_history_csv(text);
    return read ? "" : read.error().what;
}

TEST(HistoryCsv, HasTheNamesOfTheServersExport) {
    EXPECT_EQ(history_heading({"impulse"}),
              "generation,island,end_tick,simulated_s,organism_count,fitness_best,fitness_mean,fitness_median,"
              "fitness_worst,fitness_deviation,diversity,alive_count,starved_count,poisoned_count,food_eaten,"
              "poison_eaten,clamp_count,too_fast_count,speed_limit_count,best_organism,impulse_mean,"
              "impulse_deviation,impulse_min,impulse_max,impulse_selection,impulse_transmission,impulse_migration,"
              "impulse_change\n");
}

TEST(HistoryCsv, OnlyColoniesHaveColumnsOfTheirOwn) {
    google::protobuf::RepeatedPtrField<v1::GenerationStatistics> all;
    *all.Add() = statistics_of(1, 0);
    EXPECT_EQ(history_heading(genes, colony_columns_of(all)), history_heading(genes));
    *all.Add() = statistics_of(1, 0);
    all[1].mutable_colony()->set_born_count(7);
    EXPECT_THAT(history_heading(genes, colony_columns_of(all)),
                testing::EndsWith("_change,first_count,lowest_count,count_mean,born_count,refused_count,"
                                  "without_room_count,eaten_count,old_count,died_count,children_mean,"
                                  "children_variance,age_mean_s\n"));
    v1::GenerationStatistics& both = *all.Add();
    both = statistics_of(2, 0);
    both.mutable_colony()->set_born_count(7);
    *both.mutable_predators() = statistics_of(2, 0);
    both.mutable_predators()->mutable_colony()->set_born_count(3);
    const ColonyColumns with = colony_columns_of(all);
    const std::vector<std::string> columns = history_columns(genes, with);
    EXPECT_EQ(columns[48], "predators_organism_count");
    EXPECT_EQ(columns.back(), "predators_age_mean_s");
    const auto number = [&](const v1::GenerationStatistics& of, const std::string& name) {
        const auto numbers = history_numbers(of, with);
        EXPECT_EQ(numbers.size(), columns.size());
        return numbers[static_cast<std::size_t>(std::ranges::find(columns, name) - columns.begin())];
    };
    EXPECT_EQ(number(both, "born_count"), 7);
    EXPECT_EQ(number(both, "predators_born_count"), 3);
    EXPECT_EQ(number(both, "predators_fitness_best"), 1.0 / 3);
    EXPECT_TRUE(std::isnan(number(all[0], "born_count")));
    EXPECT_TRUE(std::isnan(number(all[1], "predators_born_count")));
}

TEST(HistoryCsv, ReadsBackEveryDigit) {
    const auto read = read_history_csv(csv({statistics_of(2, 0), statistics_of(2, 1)}));
    ASSERT_TRUE(read);
    EXPECT_EQ(read->gene_names, genes);
    EXPECT_THAT(read->rows, ElementsAre(history_numbers(statistics_of(2, 0)), history_numbers(statistics_of(2, 1))));
}

TEST(HistoryCsv, SelectionColumnsMayBeEmptyOrMissing) {
    const std::string text = csv({statistics_of(1, 0), statistics_of(2, 0)});
    EXPECT_THAT(text, HasSubstr(",,,,,,,,\n2,0,"));
    const auto is_unknown = [](const auto& row) {
        return std::count_if(row.begin(), row.end(), [](double number) { return std::isnan(number); });
    };
    auto read = read_history_csv(text);
    ASSERT_TRUE(read) << read.error().what;
    EXPECT_EQ(is_unknown(read->rows[0]), 8);
    EXPECT_EQ(read->rows[1], history_numbers(statistics_of(2, 0)));

    std::string older;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = text.find('\n', begin);
        const std::string line = text.substr(begin, end - begin);
        std::size_t cut = 0;
        for (int column = 0; column < 28; ++column) {
            cut = line.find(',', cut) + 1;
        }
        older += line.substr(0, cut - 1) + "\n";
        begin = end + 1;
    }
    EXPECT_THAT(older, HasSubstr("body_size_max\n"));
    read = read_history_csv(older);
    ASSERT_TRUE(read) << read.error().what;
    EXPECT_EQ(read->rows[1].size(), 36u);
    EXPECT_EQ(is_unknown(read->rows[1]), 8);
}

TEST(HistoryCsv, TakesColumnsInAnyOrderAndIgnoresOthers) {
    std::string text = csv({statistics_of(4, 2)});
    const std::size_t line = text.find('\n') + 1;
    text = "\xef\xbb\xbf\"note\"," + text.substr(0, line - 1) + "\r\nhello," +
           text.substr(line, text.size() - line - 1) + "\r\n\r\n";
    const auto read = read_history_csv(text);
    ASSERT_TRUE(read) << read.error().what;
    EXPECT_THAT(read->rows, ElementsAre(history_numbers(statistics_of(4, 2))));
}

TEST(HistoryCsv, NamesTheErrorAndItsLine) {
    EXPECT_THAT(error_of(""), HasSubstr("line 1: there is no column generation"));
    EXPECT_THAT(error_of("generation,island\n1,0\n"), HasSubstr("line 1: there is no column end_tick"));
    const std::string good = csv({statistics_of(1, 0)});
    EXPECT_EQ(error_of(good + good.substr(good.find('\n') + 1, 5) + "\n"),
              "line 3 has 3 cells, allowed: 36, as many as the heading");
    const auto spoiled = [&](const std::string& old, const std::string& cell) {
        std::string text = good;
        return error_of(text.replace(text.find("\n" + old) + 1, old.size(), cell));
    };
    EXPECT_EQ(spoiled("1,0,", "1,-1,"), "line 2, island: must be a whole number from 0 to 65535, not -1");
    EXPECT_EQ(spoiled("1,0,", "0.5,0,"), "line 2, generation: must be a whole number from 1, not 0.5");
    EXPECT_EQ(spoiled("1,0,", "one,0,"), "line 2, generation: must be a number, not \"one\"");
    EXPECT_EQ(spoiled("1,0,", "nan,0,"), "line 2, generation: must be a number, not \"nan\"");
    EXPECT_EQ(spoiled("1,0,", ",0,"), "line 2, generation: must be a number, not \"\"");
}

} // namespace
} // namespace evod::core
