#include "server/simulation/first_population.h"

#include "server/replay/archive.h"
#include "server/replay/rerun.h"
#include "server/replay/run_file_fork.h"
#include "server/replay/verify.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

namespace evod::replay {
namespace {

using namespace run_file;
using namespace recording;

using testing::HasSubstr;

/// A run that begins with a population of another seed.
class FirstPopulationTest : public testing::Test {
  protected:
    FirstPopulationTest() : data{*DataFolder::open(folder.path())} {
        std::vector<evolution::GeneMatrix> islands;
        for (std::uint32_t island = 0; island < 2; ++island) {
            islands.push_back(evolution::initial_population(12, small_world(), {99}, island));
        }
        population = std::make_shared<const std::vector<evolution::GeneMatrix>>(std::move(islands));
    }

    void expect_all_agrees(const std::string& path) {
        const auto file = RunFile::open_read_only(path);
        ASSERT_TRUE(file) << to_text(file.error());
        const auto verified = verify(**file, executor, [](const VerifyProgress&) {});
        ASSERT_TRUE(verified) << to_text(verified.error());
        EXPECT_FALSE(verified->difference) << verified->difference->part;
    }
    static const evolution::GeneMatrix& genes(const simulation::World& world, std::size_t island) {
        return world.islands()[island].born().genes;
    }
    void expect_begins_with_it(const simulation::World& world) {
        ASSERT_EQ(world.moment().tick, 0u);
        for (std::size_t island = 0; island < 2; ++island) {
            EXPECT_TRUE((genes(world, island) == (*population)[island]).all());
        }
    }

    TemporaryFolder folder;
    std::optional<DataFolder> data;
    simulation::FirstPopulation population;
    base::InlineExecutor executor;
};

TEST_F(FirstPopulationTest, TheRunContinuesAfterAnyEndAndVerifies) {
    for (const std::uint64_t ticks : {0u, 1u, 70u, 120u, 300u}) {
        folder.clear();
        auto thread = std::make_unique<StorageThread>(RunFile::Options{});
        RecordedRun run{*data, *thread, {7}, population};
        expect_begins_with_it(run.world());
        run.advance(ticks);
        run.command(set_parameter("food_health", 3.0)); // the last moment in the file
        thread.reset();                                 // as if the machine failed now: there is no end mark

        const auto file = RunFile::open_read_only(data->file_of("w"));
        ASSERT_TRUE(file) << to_text(file.error());
        auto recovered = recover(**file, executor);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        EXPECT_EQ(recovered->world.hash(), run.world().hash());
        EXPECT_TRUE(simulation::same(recovered->world.first_population(), population));
        expect_all_agrees(data->file_of("w"));
    }
}

TEST_F(FirstPopulationTest, AFileWithoutGenerationsBeginsWithIt) {
    ASSERT_TRUE(RunFile::create(
        data->file_of("w"),
        {.name = "w", .run_id = {1, 2}, .seed = {7}, .parameters = small_world(), .first_population = population}, {}));
    const auto file = RunFile::open_read_only(data->file_of("w"));
    auto recovered = recover(**file, executor);
    ASSERT_TRUE(recovered) << to_text(recovered.error());
    expect_begins_with_it(recovered->world);
}

TEST_F(FirstPopulationTest, AResetAfterARestartBeginsWithIt) {
    {
        StorageThread thread{{}};
        RecordedRun run{*data, thread, {7}, population};
        run.advance(200);
        run.recorder().close_all(run.laboratory());
    }
    data.reset();
    {
        const auto archive = Archive::open(folder.path(), {}, executor);
        ASSERT_TRUE(archive) << to_text(archive.error());
        simulation::Laboratory laboratory = (*archive)->take_laboratory();
        simulation::Entry& entry = **laboratory.find("w");
        ASSERT_TRUE(laboratory.apply(simulation::ResetWorld{"w", base::Seed{8}, {3, 4}}));
        expect_begins_with_it(entry.world);
        (*archive)->recorder().begin_after_reset(run_file::beginning_of_run(entry.world, "w", {3, 4}), {1, 2}, 200);
        for (int tick = 0; tick < 150; ++tick) {
            laboratory.advance(entry, executor);
            (*archive)->recorder().of("w")->follow(entry.world);
        }
        (*archive)->recorder().close_all(laboratory);
        (*archive)->close();
    }
    expect_all_agrees(folder.path() + "/w.evod");
    expect_all_agrees(folder.path() + "/w." + to_text(simulation::RunId{1, 2}) + ".evod");
}

TEST_F(FirstPopulationTest, AForkContinuesTheRunAndResetsToItsPopulation) {
    base::StateHash hash;
    {
        StorageThread thread{{}};
        RecordedRun run{*data, thread, {7}, population};
        run.advance(300);
        hash = run.world().hash();
        run.recorder().close_all(run.laboratory());
    }
    const auto origin = RunFile::open_read_only(data->file_of("w"));
    for (const std::uint64_t generation : {1u, 3u}) {
        const std::string path = data->file_of("fork" + std::to_string(generation));
        const auto forked = fork(**origin, generation, path, "fork", {5, 6}, executor);
        ASSERT_TRUE(forked) << to_text(forked.error());
        expect_all_agrees(path);
        const auto file = RunFile::open_read_only(path);
        auto recovered = recover(**file, executor);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        while (recovered->world.moment().tick < 300) {
            recovered->world.advance_tick(executor);
        }
        EXPECT_EQ(recovered->world.hash(), hash);
        recovered->world = recovered->world.restarted({7});
        expect_begins_with_it(recovered->world);
    }
}

TEST_F(FirstPopulationTest, DamageToItIsNamed) {
    {
        StorageThread thread{{}};
        RecordedRun run{*data, thread, {7}, population};
        run.recorder().close_all(run.laboratory());
    }
    for (const char* sql : {"UPDATE first_population SET organism_count = 11 WHERE island = 1",
                            "DELETE FROM first_population WHERE island = 1"}) {
        {
            Database database{data->file_of("w"), Database::Mode::Write};
            database.run(sql);
            ASSERT_FALSE(database.failed());
        }
        const auto file = RunFile::open_read_only(data->file_of("w"));
        ASSERT_FALSE(file);
        EXPECT_EQ(file.error().code, base::RefusalCode::DataLoss);
        EXPECT_THAT(file.error().message, HasSubstr("first_population"));
    }
}

} // namespace
} // namespace evod::replay
