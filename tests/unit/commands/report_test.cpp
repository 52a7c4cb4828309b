#include "server/commands/report.h"

#include <gtest/gtest.h>

namespace evod::commands {
namespace {

TEST(Report, RowsAreAsWideAsTheHeading) {
    simulation::GenerationStatistics statistics;
    statistics.generation = 12;
    statistics.fitness_best = 99.95;
    for (const bool with_island : {false, true}) {
        EXPECT_EQ(table_row(statistics, with_island).size(), table_heading(with_island).size());
    }
}

TEST(Report, ColoniesHaveColumnsOfBirthsAndPredators) {
    simulation::GenerationStatistics statistics;
    statistics.colony = simulation::ColonyStatistics{.born_count = 146, .eaten_count = 21, .old_count = 3};
    statistics.predators.resize(1);
    statistics.predators.front().alive_count = 53;
    const std::string row = table_row(statistics, false, true);
    EXPECT_EQ(row.size(), table_heading(false, true).size());
    EXPECT_TRUE(row.ends_with("    146     21      3        53")) << row;
}

TEST(Report, TheIslandHasAColumnOnlyIfThereAreSeveral) {
    EXPECT_EQ(table_heading(false).find("island"), std::string::npos);
    EXPECT_NE(table_heading(true).find("island"), std::string::npos);
}

TEST(RealTime, ShowsSlowRunsWithDecimals) {
    EXPECT_EQ(real_time_text(0.26), "0.3 × real time");
    EXPECT_EQ(real_time_text(0.02), "0.020 × real time");
    EXPECT_EQ(real_time_text(7269.4), "7269 × real time");
}

} // namespace
} // namespace evod::commands
