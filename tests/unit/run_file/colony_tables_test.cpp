// The tables of colonies: they are read as they were written, damage is found, and other files do not have them.
#include "server/replay/mismatch.h"
#include "server/run_file/checkpoint.h"
#include "server/run_file/run_file.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>

namespace evod::run_file {
namespace {

using replay::compare;
using support::TemporaryFolder;
using testing::HasSubstr;

parameters::Parameters colony() {
    parameters::Parameters parameters;
    parameters.reproduction = parameters::Reproduction::Births;
    parameters.population_size = 3;
    parameters.predator_count = 1;
    parameters.island_count = 2;
    return parameters;
}

simulation::IslandOpening opening_of(std::uint32_t organisms, std::uint32_t predators) {
    simulation::IslandOpening opening{
        .predator_count = predators, .next_number = 100, .numbers = {}, .age_ticks = {}, .state = {}};
    for (std::uint32_t i = 0; i < organisms; ++i) {
        opening.numbers.push_back(7 * i);
        opening.age_ticks.push_back(i);
    }
    opening.state.life_records.begin_generation(organisms);
    opening.state.life_records.children.resize(organisms, 2);
    opening.state.organisms.resize(organisms);
    opening.state.hunts_from.resize(organisms);
    opening.state.food.resize(3);
    return opening;
}

GenerationBegun begun(std::uint64_t generation) {
    GenerationBegun begun{.opening = {.moment = {.tick = 100 * generation, .generation = generation},
                                      .parameters = parameters::ParameterSet::all_in_effect(colony()),
                                      .progress = {}},
                          .born = {}};
    for (std::uint32_t island = 0; island < 2; ++island) {
        // Nothing lives on the second island from the second interval on.
        const std::uint32_t organisms = generation == 1 ? 4 : island == 0 ? 5 : 0;
        evolution::NextGeneration& born = begun.born.emplace_back();
        born.genes.setConstant(evolution::body_gene_count, organisms, 100 + static_cast<float>(generation));
        born.parents.resize(generation == 1 ? 0 : organisms);
        born.survivor_count = organisms;
        born.predator_count = generation == 1 ? 1 : island == 0 ? 2 : 0;
        begun.founders.emplace_back(organisms, island);
        if (generation > 1) {
            begun.openings.push_back(opening_of(organisms, born.predator_count));
            born.account.emplace(evolution::body_gene_count);
            born.predator_account.emplace(evolution::body_gene_count);
            born.predator_account->front().selection = 0.25;
        }
    }
    return begun;
}

GenerationEnded ended(std::uint64_t generation) {
    GenerationEnded ended{.generation = generation, .outcomes = {}, .statistics = {}};
    for (std::uint32_t island = 0; island < 2; ++island) {
        const auto bred = static_cast<std::size_t>(begun(generation).born[island].genes.cols());
        simulation::IslandOutcome& outcome = ended.outcomes.emplace_back();
        outcome.births = {{.tick = 3, .parents = {0, 1}}, {.tick = 9, .parents = {~0U, ~0U}}};
        outcome.fitness.resize(bred + 2, 1);
        outcome.lived_ticks.resize(bred + 2);
        outcome.cause.resize(bred + 2, simulation::CauseOfDeath::Old);
        simulation::GenerationStatistics& statistics = ended.statistics.emplace_back();
        statistics.generation = generation;
        statistics.island = island;
        statistics.account = begun(generation).born[island].account;
        statistics.colony = simulation::ColonyStatistics{.lowest_count = 4, .count_mean = 5.5};
        if (island == 0) {
            statistics.predators = {statistics};
            statistics.predators[0].colony->eaten_count = 17;
            statistics.predators[0].account = begun(generation).born[island].predator_account;
            statistics.predators[0].genes[2].mean = 12.5;
        }
    }
    return ended;
}

class ColonyTablesTest : public testing::Test {
  protected:
    ColonyTablesTest() {
        auto file = RunFile::create(path, {.name = "w", .run_id = {1, 2}, .seed = {3}, .parameters = colony()}, {},
                                    {begun(1), ended(1), begun(2), ended(2)});
        EXPECT_TRUE(file) << to_text(file.error());
    }
    std::unique_ptr<RunFile> open() const {
        auto file = RunFile::open_read_only(path);
        EXPECT_TRUE(file) << to_text(file.error());
        return *std::move(file);
    }
    /// What a reader says after this change of the file.
    std::string damaged_by(const char* sql) {
        {
            Database database{path, Database::Mode::Write};
            database.run(sql);
        }
        const auto file = RunFile::open_read_only(path);
        if (!file) {
            return to_text(file.error());
        }
        const auto checked = [&]() -> base::Result<void> {
            if (auto read = (*file)->generations().beginning_of(2); !read) {
                return read.error();
            }
            if (auto read = (*file)->generations().outcome_of(2); !read) {
                return read.error();
            }
            auto history = (*file)->generations().history(3, 10);
            return history ? base::Result<void>{} : history.error();
        }();
        return checked ? "" : to_text(checked.error());
    }

    TemporaryFolder folder;
    const std::string path = folder.path() + "/w.evod";
};

TEST_F(ColonyTablesTest, AreReadAsTheyWereWritten) {
    const auto file = open();
    for (const std::uint64_t generation : {1u, 2u}) {
        const auto read = file->generations().beginning_of(generation);
        ASSERT_TRUE(read && *read) << to_text(read.error());
        EXPECT_EQ((*read)->openings, begun(generation).openings);
        EXPECT_FALSE(compare((*read)->born, begun(generation).born));
        EXPECT_EQ((*read)->born[0].predator_account, begun(generation).born[0].predator_account);
        const auto over = file->generations().outcome_of(generation);
        ASSERT_TRUE(over && *over) << to_text(over.error());
        EXPECT_EQ((*over)->outcomes, ended(generation).outcomes);
        EXPECT_FALSE(compare((*over)->statistics, ended(generation).statistics));
        EXPECT_EQ((*over)->statistics[0].predators[0].account, begun(generation).born[0].predator_account);
    }
    const auto history = file->generations().history(3, 10);
    ASSERT_TRUE(history) << to_text(history.error());
    ASSERT_EQ(history->size(), 2u);
    EXPECT_FALSE(compare((*history)[1], ended(2).statistics));
}

TEST_F(ColonyTablesTest, DamageIsFound) {
    EXPECT_EQ(damaged_by("UPDATE interval SET checksum = checksum"), "");
    EXPECT_THAT(damaged_by("UPDATE predator_statistics SET diversity = 7 WHERE generation = 2"),
                HasSubstr("statistics of the colony in generation 2"));
    EXPECT_THAT(damaged_by("UPDATE birth SET births = zeroblob(24) WHERE generation = 2"),
                HasSubstr("births of interval 2"));
    EXPECT_THAT(damaged_by("DELETE FROM interval WHERE island = 1"), HasSubstr("openings of interval 2"));
    EXPECT_THAT(damaged_by("DROP TABLE birth"), HasSubstr("lacks the table \"birth\""));
}

TEST_F(ColonyTablesTest, AMissingRowIsFound) {
    EXPECT_THAT(damaged_by("DELETE FROM colony WHERE generation = 2 AND species = 1"),
                HasSubstr("statistics of the colony in generation 2"));
}

TEST_F(ColonyTablesTest, OtherFilesLackThem) {
    parameters::Parameters parameters;
    const auto file = RunFile::create(folder.path() + "/x.evod",
                                      {.name = "x", .run_id = {1, 2}, .seed = {3}, .parameters = parameters}, {}, {});
    ASSERT_TRUE(file) << to_text(file.error());
    EXPECT_EQ((*file)->database().number("SELECT count(*) FROM sqlite_schema WHERE name IN ('interval', 'birth', "
                                         "'colony', 'predator_statistics')"),
              0);
}

TEST(PackedOpening, RefusesBytesThatCannotBeAColony) {
    const std::string packed = pack(opening_of(4, 1));
    const auto again = unpack_opening(packed);
    ASSERT_TRUE(again) << to_text(again.error());
    EXPECT_EQ(*again, opening_of(4, 1));
    for (std::size_t size = 0; size < packed.size(); ++size) {
        EXPECT_FALSE(unpack_opening(std::string_view{packed}.substr(0, size)));
    }
    simulation::IslandOpening huge;
    huge.state.food.resize(1 << 20); // 12 MB of zeros
    EXPECT_FALSE(unpack_opening(pack(huge)));
}

} // namespace
} // namespace evod::run_file
