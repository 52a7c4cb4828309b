#include "server/replay/run_file_fork.h"

#include "server/replay/archive.h"
#include "server/replay/generation_reader.h"
#include "server/replay/mismatch.h"
#include "server/replay/rerun.h"
#include "server/replay/run_tables.h"
#include "server/replay/verify.h"
#include "server/run_file/check.h"
#include "server/simulation/entities.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <sstream>

namespace evod::replay {
namespace {

using namespace run_file;
using namespace recording;

using testing::HasSubstr;

class ForkTest : public testing::Test {
  protected:
    /// Six generations and a half; a change in the second, one in the fifth.
    ForkTest() : data{*DataFolder::open(folder.path())} {
        StorageThread thread{{}};
        RecordedRun run{*data, thread};
        for (int tick = 0; tick < 780; ++tick) {
            if (tick == 150) {
                run.command(set_parameter("mutation_chance", 0.4));
            }
            if (tick == 500) {
                run.command(set_parameter("food_health", 1.0));
            }
            hashes.push_back(run.world().hash());
            run.advance(1);
        }
        last_hash = run.world().hash();
        run.recorder().close_all(run.laboratory());
    }
    auto fork_at(std::optional<std::uint64_t> generation, const std::string& name) {
        const auto origin = RunFile::open_read_only(data->file_of("w"));
        return fork(**origin, generation, data->file_of(name), name, {generation.value_or(0), 3}, executor);
    }
    /// From generation 1 on.
    static void expect_history(const simulation::History& history, RunFile& origin, std::size_t generations) {
        ASSERT_EQ(history.size(), generations);
        for (std::size_t i = 0; i < generations; ++i) {
            EXPECT_FALSE(compare(history[i], *origin.generations().statistics_of(i + 1))) << "generation " << i + 1;
        }
    }

    TemporaryFolder folder;
    std::optional<DataFolder> data;
    base::InlineExecutor executor;
    std::vector<base::StateHash> hashes; // by tick
    base::StateHash last_hash;
};

TEST_F(ForkTest, AForkEqualsItsOriginUntilACommand) {
    for (const std::uint64_t generation : {1u, 3u, 4u}) {
        const std::string name = "fork" + std::to_string(generation);
        const auto forked = fork_at(generation, name);
        ASSERT_TRUE(forked) << to_text(forked.error());
        const auto file = RunFile::open_read_only(data->file_of(name));
        ASSERT_TRUE(file) << to_text(file.error());
        EXPECT_EQ((*file)->identity().forked_from, (simulation::RunId{1, 2}));
        EXPECT_TRUE(check(**file));
        EXPECT_TRUE((*file)->end_mark()->has_value()); // closed, to be continued
        auto recovered = recover(**file, executor);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        simulation::World& world = recovered->world;
        EXPECT_EQ(world.moment().generation, generation);
        EXPECT_EQ(world.moment().generation_tick, 0u);
        EXPECT_FALSE(recovered->control.endless);
        // The fork does not contain the origin's next command.
        for (const std::uint64_t last = generation < 2 ? 240 : 500; world.moment().tick < last;) {
            world.advance_tick(executor);
            ASSERT_EQ(world.hash(), hashes[world.moment().tick]) << world.moment().tick;
        }
    }
}

TEST_F(ForkTest, WithoutAGenerationAForkBeginsAtTheEnd) {
    const auto moment = fork_at(std::nullopt, "fork");
    ASSERT_TRUE(moment) << to_text(moment.error());
    EXPECT_EQ(moment->tick, 780u);
    EXPECT_GT(moment->generation_tick, 0u);
    std::filesystem::remove(data->file_of("w"));
    const auto file = RunFile::open_read_only(data->file_of("fork"));
    ASSERT_TRUE(file) << to_text(file.error());
    EXPECT_TRUE(check(**file));
    EXPECT_EQ((*file)->identity().first_tick, 780u);
    EXPECT_EQ((*file)->identity().parameters.mutation_chance, 0.4);
    EXPECT_EQ((*file)->identity().parameters.food_health, 1.0);
    const auto verified = verify(**file, executor, [](const VerifyProgress&) {});
    ASSERT_TRUE(verified) << to_text(verified.error());
    EXPECT_FALSE(verified->difference);
    const auto recovered = recover(**file, executor);
    ASSERT_TRUE(recovered) << to_text(recovered.error());
    EXPECT_EQ(recovered->world.hash(), last_hash);
    EXPECT_TRUE(recovered->journal.empty());
}

TEST_F(ForkTest, AForkAfterAGenerationBeginsWithTheNext) {
    data.reset();
    folder.clear();
    data.emplace(*DataFolder::open(folder.path()));
    hashes.clear();
    {
        StorageThread thread{{}};
        RecordedRun run{*data, thread};
        while (!run.world().generation_over()) {
            run.advance(1);
        }
        run.command(set_parameter("mutation_chance", 0.25)); // the fork has the parameters requested at its beginning
        run.recorder().close_all(run.laboratory());
        last_hash = run.world().hash();
        run.world().advance_tick(executor);
        hashes.push_back(run.world().hash());
    }
    ASSERT_TRUE(fork_at(std::nullopt, "fork"));
    data.reset();
    {
        const auto archive = Archive::open(folder.path(), {}, executor);
        ASSERT_TRUE(archive) << to_text(archive.error());
        simulation::Laboratory laboratory = (*archive)->take_laboratory();
        simulation::Entry& entry = **laboratory.find("fork");
        EXPECT_EQ(entry.world.hash(), last_hash);
        laboratory.advance(entry, executor);
        EXPECT_EQ(entry.world.hash(), hashes[0]);
        EXPECT_EQ(entry.world.moment().generation, 2u);
        (*archive)->recorder().of("fork")->follow(entry.world);
        (*archive)->recorder().close_all(laboratory);
        (*archive)->close();
    }
    const auto file = RunFile::open_read_only(folder.path() + "/fork.evod");
    const auto checked = check(**file);
    EXPECT_TRUE(checked) << to_text(checked.error());
    const auto verified = verify(**file, executor, [](const VerifyProgress&) {});
    ASSERT_TRUE(verified) << to_text(verified.error());
    EXPECT_FALSE(verified->difference);
}

TEST_F(ForkTest, FilesOfAKilledForkAreReplaced) {
    ASSERT_TRUE(fork_at(3, "fork"));
    std::filesystem::rename(data->file_of("fork"), DataFolder::next_file_of(data->file_of("fork")));
    const auto moment = fork_at(2, "fork");
    ASSERT_TRUE(moment) << to_text(moment.error());
    EXPECT_EQ((*RunFile::open_read_only(data->file_of("fork")))->identity().first_generation, 2u);
    EXPECT_TRUE(data->files()->replaced.empty());
}

TEST_F(ForkTest, AForkNeedsNoOtherFile) {
    ASSERT_TRUE(fork_at(3, "fork"));
    std::filesystem::remove(data->file_of("w"));
    data.reset();
    base::StateHash hash;
    for (const std::uint64_t tick : {240u, 530u, 820u}) {
        const auto archive = Archive::open(folder.path(), {}, executor);
        ASSERT_TRUE(archive) << to_text(archive.error());
        simulation::Laboratory laboratory = (*archive)->take_laboratory();
        simulation::Entry& entry = **laboratory.find("fork");
        EXPECT_EQ(entry.world.moment().tick, tick);
        EXPECT_EQ(entry.state(), simulation::RunState::Waiting);
        if (tick > 240) {
            EXPECT_EQ(entry.world.hash(), hash);
        }
        for (int i = 0; i < 290; ++i) {
            laboratory.advance(entry, executor);
            (*archive)->recorder().of("fork")->follow(entry.world);
        }
        hash = entry.world.hash();
        (*archive)->recorder().close_all(laboratory);
        (*archive)->close();
        const auto file = RunFile::open_read_only(folder.path() + "/fork.evod");
        const auto checked = check(**file);
        EXPECT_TRUE(checked) << to_text(checked.error());
    }
    data.emplace(*DataFolder::open(folder.path()));
    // A fork of a fork has no history from before the first fork.
    const auto origin = RunFile::open_read_only(data->file_of("fork"));
    EXPECT_TRUE(fork(**origin, 5, data->file_of("second"), "second", {}, executor));
    EXPECT_EQ(fork(**origin, 2, data->file_of("third"), "third", {}, executor).error().code,
              base::RefusalCode::NotFound);
}

TEST_F(ForkTest, AForkHasTheHistoryAndFoundersOfItsOrigin) {
    ASSERT_TRUE(fork_at(4, "fork"));
    const auto origin = RunFile::open_read_only(data->file_of("w"));
    auto file = RunFile::open(data->file_of("fork"), {});
    EXPECT_EQ((*file)->identity().inherited_generations, 3u);
    auto recovered = recover(**file, executor);
    ASSERT_TRUE(recovered) << to_text(recovered.error());
    expect_history(recovered->world.history(), **origin, 3);
    EXPECT_FALSE(recovered->world.bred().founders.empty());
    EXPECT_EQ(recovered->world.bred().founders, (*(*origin)->generations().beginning_of(4))->founders);
    EXPECT_EQ((*file)->generations().last_ended(), 0u) << "of its own";
    while (!recovered->world.generation_over()) {
        recovered->world.advance_tick(executor);
    }
    (*file)->begin();
    (*file)->write(end_of(recovered->world));
    recovered->world.breed_next_generation(executor);
    (*file)->write(beginning_of(recovered->world));
    ASSERT_TRUE((*file)->commit());

    ASSERT_TRUE(fork(**file, 5, data->file_of("second"), "second", {}, executor));
    const auto second = RunFile::open_read_only(data->file_of("second"));
    expect_history(recover(**second, executor)->world.history(), **origin, 4);
    EXPECT_EQ((*second)->generations().history(5, 2)->size(), 2u);

    file->reset();
    Database{data->file_of("fork"), Database::Mode::Write}.run("DELETE FROM inherited_statistics WHERE generation = 1");
    EXPECT_THAT(to_text(check(**RunFile::open_read_only(data->file_of("fork"))).error()),
                HasSubstr("inherited_statistics"));
}

/// A state hash is recorded every 60 ticks; a generation of these worlds takes 120.
TEST_F(ForkTest, AForkVerifiesWhereverItBegins) {
    for (std::uint64_t first_tick = 179; first_tick <= 240; ++first_tick) {
        SCOPED_TRACE("fork at tick " + std::to_string(first_tick));
        const TemporaryFolder elsewhere;
        auto there = *DataFolder::open(elsewhere.path());
        {
            StorageThread thread{{}};
            RecordedRun run{there, thread};
            run.advance(first_tick);
            run.fork({3, 4});
            run.advance(130, "fork");
            run.recorder().close_all(run.laboratory());
        }
        const auto file = RunFile::open_read_only(there.file_of("fork"));
        ASSERT_TRUE(file) << to_text(file.error());
        const auto verified = verify(**file, executor, [](const VerifyProgress&) {});
        ASSERT_TRUE(verified) << to_text(verified.error());
        EXPECT_FALSE(verified->difference) << verified->difference->part;
        EXPECT_EQ(verified->ticks, 130u);
    }
}

TEST_F(ForkTest, AForkOfALiveWorldKeepsItsHistoryAtARestart) {
    for (const std::uint64_t ticks : {360u, 400u}) { // at the end of a generation, and within the next
        const TemporaryFolder elsewhere;
        auto there = *DataFolder::open(elsewhere.path());
        StorageThread thread{{}};
        RecordedRun run{there, thread};
        run.advance(ticks);
        run.fork({3, 4});
        const simulation::World& forked = (*run.laboratory().find("fork"))->world;
        EXPECT_EQ(forked.history().size(), 3u);
        run.recorder().close_all(run.laboratory());
        while (!thread.idle()) {
        }
        const auto file = RunFile::open_read_only(there.file_of("fork"));
        const auto checked = check(**file);
        EXPECT_TRUE(checked) << to_text(checked.error());
        const auto recovered = recover(**file, executor);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        ASSERT_EQ(recovered->world.history().size(), forked.history().size());
        for (std::size_t i = 0; i < forked.history().size(); ++i) {
            EXPECT_FALSE(compare(recovered->world.history()[i], forked.history()[i]));
        }
        EXPECT_EQ(recovered->world.bred().founders, forked.bred().founders);
    }
}

/// Forks of a live world, of its first generation in the file, and of the whole file, each read back as by a restart.
class ForkAfterChange : public testing::Test {
  protected:
    static simulation::FirstPopulation given_population() {
        return std::make_shared<const std::vector<evolution::GeneMatrix>>(
            2, evolution::GeneMatrix::Constant(evolution::body_gene_count, 12, 100));
    }
    /// change  changes the world "w", which has had no tick yet if `ticks` is 0.
    template <class Change>
    void expect_whole_forks(std::uint64_t ticks, Change&& change, const parameters::Parameters& initial = small_world(),
                            const simulation::FirstPopulation& first = {}) {
        auto data = *DataFolder::open(folder.path());
        const simulation::World* live = nullptr;
        {
            StorageThread thread{{}};
            RecordedRun run{data, thread, {7}, first, {}, initial};
            run.advance(ticks);
            change(run);
            run.fork({3, 4});
            live = &(*run.laboratory().find("fork"))->world;
            EXPECT_TRUE(live->parameters() == run.world().parameters());
            run.recorder().close_all(run.laboratory());
            ASSERT_TRUE(thread.finish());
            expect_whole(data.file_of("fork"), live->hash(), live->parameters());
            const simulation::World opening = run.world().at_its_opening(executor);
            const auto origin = RunFile::open_read_only(data.file_of("w"));
            for (const auto generation : {std::optional<std::uint64_t>{}, std::optional<std::uint64_t>{1}}) {
                const std::string path = data.file_of("cold");
                std::filesystem::remove(path);
                const auto forked = fork(**origin, generation, path, "cold", {5, 6}, executor);
                ASSERT_TRUE(forked) << to_text(forked.error());
                expect_whole(path, generation ? opening.hash() : run.world().hash(),
                             generation ? opening.parameters() : run.world().parameters());
            }
        }
    }
    /// The file restores a world with this hash and these parameters, runs on, verifies and gives its tables.
    void expect_whole(const std::string& path, const base::StateHash& hash, const parameters::ParameterSet& set) {
        auto file = RunFile::open(path, {});
        ASSERT_TRUE(file) << to_text(file.error());
        EXPECT_TRUE(check(**file));
        auto recovered = recover(**file, executor);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        EXPECT_EQ(recovered->world.hash(), hash);
        EXPECT_TRUE(recovered->world.parameters() == set);
        {
            const EndMark contents = (*file)->contents();
            const std::uint64_t ended = (*file)->generations().last_ended();
            NewRecordFinder news{contents.tick, contents.generations, ended};
            (*file)->begin();
            for (int tick = 0; tick < 130; ++tick) {
                recovered->world.advance_tick(executor);
                news.report(recovered->world, [&](const auto& record) { (*file)->write(record); });
            }
            (*file)->write(EndMark{.tick = recovered->world.moment().tick});
            ASSERT_TRUE((*file)->commit());
        }
        const auto verified = verify(**file, executor, [](const VerifyProgress&) {});
        ASSERT_TRUE(verified) << to_text(verified.error());
        EXPECT_FALSE(verified->difference) << verified->difference->part << ": " << verified->difference->stored << ", "
                                           << verified->difference->simulated;
        for (const RunTable table : {RunTable::Generations, RunTable::Organisms, RunTable::Population}) {
            std::ostringstream out;
            const auto written = write_table({**file, executor}, {.table = table}, out);
            EXPECT_TRUE(written) << to_text(written.error());
        }
    }

    TemporaryFolder folder;
    base::InlineExecutor executor;
};

TEST_F(ForkAfterChange, ParametersSetBeforeTheFirstTickAreKept) {
    expect_whole_forks(0, [](RecordedRun& run) { run.command(set_parameter("poison_harm", 0.0)); });
}

TEST_F(ForkAfterChange, ABoundNarrowedBeforeTheFirstTickIsKept) {
    expect_whole_forks(0, [](RecordedRun& run) { run.command(set_parameter("body_size_max", 90.0)); });
}

TEST_F(ForkAfterChange, GenesThatWaitForAResetDoNotCount) {
    for (const std::uint32_t genes : {0u, 4u}) {
        folder.clear();
        parameters::Parameters initial = small_world();
        initial.free_genes = genes;
        expect_whole_forks(
            50, [&](RecordedRun& run) { run.command(set_parameter("free_genes", 4 - genes)); }, initial);
    }
}

TEST_F(ForkAfterChange, AControllerThatWaitsForAResetDoesNotCount) {
    expect_whole_forks(50, [](RecordedRun& run) { run.command(set_parameter("controller", std::string{"network"})); });
}

TEST_F(ForkAfterChange, AGivenPopulationNeedNotFitLaterParameters) {
    expect_whole_forks(
        50, [](RecordedRun& run) { run.command(set_parameter("population_size", 20u)); }, small_world(),
        given_population());
    folder.clear();
    expect_whole_forks(
        50, [](RecordedRun& run) { run.command(set_parameter("body_size_max", 90.0)); }, small_world(),
        given_population());
}

TEST_F(ForkAfterChange, PlacedOrganismsOfAnotherModelAreNotCalledDamage) {
    simulation::World world{small_world(), {7}};
    simulation::PlaceEntities place{.world = "w", .items = {}, .organisms = {}};
    place.organisms.push_back({.x_px = 640, .y_px = 360, .genes = std::vector<float>(evolution::body_gene_count, 100)});
    if (!simulation::check(world, place)) {
        place.organisms.front().x_px = 320;
    }
    ASSERT_TRUE(simulation::check(world, place));
    (void)world.place(place);
    while (!world.generation_over()) {
        world.advance_tick(executor);
    }
    world.become_fork();
    RunBeginning beginning = beginning_of_fork(world, "fork", {3, 4}, {1, 2}, executor);
    for (const std::uint32_t newer : {0u, 1u}) {
        RunIdentity identity = beginning.identity;
        identity.model_version += newer;
        const std::string path = folder.path() + "/fork" + std::to_string(newer) + ".evod";
        const auto file = RunFile::create(path, identity, {}, RunFile::records_of(beginning));
        ASSERT_TRUE(file) << to_text(file.error());
        const auto whole = GenerationReader{**file, executor}.read(1);
        ASSERT_EQ(whole.has_value(), newer == 0);
        if (!whole) {
            EXPECT_EQ(whole.error().code, base::RefusalCode::FailedPrecondition) << to_text(whole.error());
        }
    }
}

TEST_F(ForkTest, AMissingGenerationOrAnExistingFileIsRefused) {
    const auto refused = fork_at(8, "fork").error();
    EXPECT_EQ(refused.code, base::RefusalCode::NotFound);
    EXPECT_THAT(to_text(refused), HasSubstr("got 8, allowed 1 to 7"));
    EXPECT_FALSE(std::filesystem::exists(data->file_of("fork")));
    ASSERT_TRUE(fork_at(2, "fork"));
    EXPECT_EQ(fork_at(2, "fork").error().code, base::RefusalCode::AlreadyExists);
}

} // namespace
} // namespace evod::replay
