#include "server/replay/columns.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>

namespace evod::replay {
namespace {

const std::vector<std::string> genes{"impulse"};

/// The two lines of a table with one row.
std::pair<std::string, std::string> table_of(const simulation::GenerationStatistics& statistics, ColonyColumns colony) {
    std::stringstream text;
    Table table{text, Table::Format::Csv, statistics_columns(genes, colony)};
    write_row(table, statistics, genes, colony);
    std::string heading, row;
    std::getline(text, heading);
    std::getline(text, row);
    return {heading, row};
}

simulation::GenerationStatistics statistics_of(std::uint32_t born) {
    simulation::GenerationStatistics statistics;
    statistics.genes.resize(1);
    statistics.colony = simulation::ColonyStatistics{.first_count = 40, .born_count = born};
    return statistics;
}

TEST(Columns, TheSpeciesOfAColonyHaveColumnsOfTheirOwn) {
    simulation::GenerationStatistics statistics = statistics_of(71);
    const auto [heading, row] = table_of(statistics, ColonyColumns::None);
    const auto [heading_prey, row_prey] = table_of(statistics, ColonyColumns::Prey);
    EXPECT_EQ(heading_prey, heading + ",first_count,lowest_count,count_mean,born_count,refused_count,"
                                      "without_room_count,eaten_count,old_count,died_count,children_mean,"
                                      "children_variance,age_mean_s");
    EXPECT_EQ(row_prey, row + ",40,0,0,71,0,0,0,0,0,0,0,0");
    const auto [heading_both, row_alone] = table_of(statistics, ColonyColumns::Both);
    EXPECT_THAT(heading_both, testing::StartsWith(heading_prey + ",predators_organism_count,predators_fitness_best,"));
    EXPECT_THAT(heading_both, testing::EndsWith(",predators_age_mean_s"));
    const auto cells = [](const std::string& line) { return std::ranges::count(line, ','); };
    EXPECT_EQ(row_alone,
              row_prey + std::string(static_cast<std::size_t>(cells(heading_both) - cells(heading_prey)), ','));
    statistics.predators = {statistics_of(5)};
    const std::string row_both = table_of(statistics, ColonyColumns::Both).second;
    EXPECT_EQ(cells(row_both), cells(heading_both));
    EXPECT_THAT(row_both, testing::EndsWith(",40,0,0,5,0,0,0,0,0,0,0,0"));
}

TEST(Columns, FollowTheParametersOfTheWorld) {
    parameters::Parameters parameters;
    EXPECT_EQ(colony_columns_of(parameters), ColonyColumns::None);
    parameters.reproduction = parameters::Reproduction::Births;
    EXPECT_EQ(colony_columns_of(parameters), ColonyColumns::Prey);
    parameters.predator_count = 1;
    EXPECT_EQ(colony_columns_of(parameters), ColonyColumns::Both);
}

} // namespace
} // namespace evod::replay
