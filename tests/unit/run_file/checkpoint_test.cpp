#include "server/run_file/checkpoint.h"

#include "server/jobs/thread_pool.h"
#include "server/replay/archive.h"
#include "server/replay/rerun.h"
#include "server/replay/verify.h"
#include "server/run_file/check.h"
#include "tests/support/waiting.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <random>

namespace evod::run_file {
namespace {

using namespace recording;
using namespace replay;

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;

class CheckpointTest : public testing::Test {
  protected:
    CheckpointTest() : data{*DataFolder::open(folder.path())} {}

    /// The file as a failure of the machine would leave it now.
    std::unique_ptr<RunFile> file_left() {
        thread.reset();
        auto file = RunFile::open(data.file_of("w"), {});
        EXPECT_TRUE(file) << to_text(file.error());
        return *std::move(file);
    }
    static std::vector<std::uint64_t> ticks_of(RunFile& file) {
        std::vector<std::uint64_t> ticks;
        for (const StoredCheckpoint& checkpoint : *file.checkpoints().read(0, file.contents().tick)) {
            ticks.push_back(checkpoint.moment.tick);
        }
        return ticks;
    }
    void expect_agrees(RunFile& file, std::uint64_t checkpoints) {
        const auto checked = check(file);
        EXPECT_TRUE(checked) << to_text(checked.error());
        const auto verified = verify(file, three_threads, [](const VerifyProgress&) {});
        ASSERT_TRUE(verified) << to_text(verified.error());
        EXPECT_FALSE(verified->difference) << verified->difference->part << ": " << verified->difference->stored
                                           << " but " << verified->difference->simulated;
        EXPECT_EQ(verified->checkpoints, checkpoints);
    }

    TemporaryFolder folder;
    DataFolder data;
    std::unique_ptr<StorageThread> thread = std::make_unique<StorageThread>(RunFile::Options{});
    base::InlineExecutor executor;
    jobs::ThreadPool three_threads{3};
};

TEST(CheckpointState, ContainsFitnessFromClients) {
    const std::vector<simulation::IslandShape> shapes(2, {.organisms = 3, .has_bodies = false});
    simulation::WorldState state{.moment = {}, .parameters = {}, .islands = {}, .ended = {}};
    state.islands.resize(2);
    for (simulation::IslandState& island : state.islands) {
        island.life_records.begin_generation(3);
    }
    state.ratings = {{{1.5, -2, 1e100}}, {{7}, {1, 2, 3, 4, 5, 6}}};
    simulation::WorldState again = state;
    again.ratings.clear();
    ASSERT_TRUE(unpack(pack(state), shapes, again));
    EXPECT_EQ(again.ratings, state.ratings);
    EXPECT_EQ(again.islands, state.islands);
}

TEST(CheckpointState, ContainsChromosomesOfAnyLength) {
    base::InlineExecutor executor;
    parameters::Parameters parameters = small_world();
    parameters.controller = evolution::Controller::Network;
    simulation::World world{parameters, {7}};
    const auto expect_the_same_again = [&] {
        const simulation::WorldState state = world.state(executor);
        simulation::WorldState again{.moment = {}, .parameters = state.parameters, .islands = {}, .ended = {}};
        ASSERT_TRUE(unpack(pack(state), world.shapes(), again));
        EXPECT_EQ(again.islands, state.islands);
        ASSERT_EQ(again.ended.size(), state.ended.size());
        for (std::size_t island = 0; island < state.ended.size(); ++island) {
            EXPECT_EQ(again.ended[island].genes.back().mean, state.ended[island].genes.back().mean);
        }
    };
    const evolution::ConstGenes genes = evolution::column(world.island(0).born().genes, 0);
    ASSERT_GT(genes.size(), evolution::body_gene_count);
    (void)world.place({.world = "w", .organisms = {{.x_px = 50, .y_px = 50, .genes = {genes.begin(), genes.end()}}}});
    expect_the_same_again();
    while (!world.generation_over()) {
        world.advance_tick(executor);
    }
    expect_the_same_again();
}

TEST_F(CheckpointTest, TheNewestThreeAreKept) {
    RecordedRun run{data, *thread};
    for (int count = 0; count < 6; ++count) {
        run.advance(50);
        run.checkpoint();
    }
    const auto file = file_left();
    EXPECT_THAT(ticks_of(*file), ElementsAre(200, 250, 300));
    EXPECT_EQ(file->contents().tick, 300u);
    expect_agrees(*file, 3);
}

TEST_F(CheckpointTest, AWorldContinuesFromACheckpointExactly) {
    std::mt19937 random{1};
    for (int round = 0; round < 20; ++round) {
        folder.clear();
        thread = std::make_unique<StorageThread>(RunFile::Options{});
        parameters::Parameters parameters = small_world();
        if (round % 4 == 3) { // organisms then have headings
            parameters.controller = evolution::Controller::Network;
        }
        RecordedRun run{data, *thread, {7}, {}, {}, parameters};
        run.advance(random() % 200);
        run.command(set_parameter("food_health", 3.0));
        run.advance(1 + random() % 200);
        if (run.world().generation_over()) {
            run.advance(1);
        }
        const std::uint64_t tick = run.world().moment().tick;
        if (round % 2 == 0) { // a server does not do this, but a file may contain it
            run.command(set_parameter("force_per_unit", 1.5));
        }
        run.checkpoint();
        run.command(set_parameter("force_per_unit", 2.0));  // at the same tick, but after it
        run.command(set_parameter("population_size", 17u)); // from the next generation on
        run.advance(random() % 100);
        run.command(set_parameter("food_health", 4.0)); // the last moment in the file

        const auto file = file_left();
        const auto rerun = Rerun::before(*file, tick, executor);
        ASSERT_TRUE(rerun) << to_text(rerun.error());
        EXPECT_EQ(rerun->world().moment().tick, tick);
        auto recovered = recover(*file, three_threads);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        simulation::World& again = recovered->world;
        EXPECT_EQ(again.moment(), run.world().moment());
        EXPECT_EQ(again.hash(), run.world().hash());
        EXPECT_EQ(again.parameters().revision, run.world().parameters().revision);
        EXPECT_TRUE(again.parameters().active == run.world().parameters().active);
        EXPECT_TRUE(again.parameters().requested == run.world().parameters().requested);
        EXPECT_EQ(again.history().size(), run.world().history().size());
        expect_agrees(*file, 1);
        for (int after = 0; after < 300; ++after) {
            again.advance_tick(three_threads);
            run.world().advance_tick(executor);
            ASSERT_EQ(again.hash(), run.world().hash());
        }
    }
}

TEST_F(CheckpointTest, EveryTickIsReachedFromTheLastBeginningBeforeIt) {
    RecordedRun run{data, *thread};
    std::vector<base::StateHash> hashes{run.world().hash()};
    for (std::uint64_t tick = 1; tick <= 400; ++tick) {
        run.advance(1);
        hashes.push_back(run.world().hash());
        if (tick == 130 || tick == 290 || tick == 330) {
            run.checkpoint();
        }
        if (tick % 65 == 0) {
            run.command(set_parameter("food_health", static_cast<double>(tick % 20)));
        }
    }
    const auto file = file_left();
    for (const auto& [tick, from] : {std::pair{0u, 0u},
                                     {1u, 0u},
                                     {120u, 0u},
                                     {121u, 120u},
                                     {129u, 120u},
                                     {130u, 130u},
                                     {240u, 130u},
                                     {241u, 240u},
                                     {289u, 240u},
                                     {290u, 290u},
                                     {329u, 290u},
                                     {360u, 330u},
                                     {361u, 360u},
                                     {390u, 360u}}) {
        auto rerun = Rerun::before(*file, tick, executor);
        ASSERT_TRUE(rerun) << to_text(rerun.error());
        EXPECT_EQ(rerun->world().moment().tick, from) << tick;
        rerun->advance_to(tick, executor);
        EXPECT_EQ(rerun->world().hash(), hashes[tick]) << tick;
    }
    EXPECT_EQ(Rerun::before(*file, 401, executor).error().code, base::RefusalCode::NotFound);
}

TEST_F(CheckpointTest, ADamagedCheckpointIsNamed) {
    {
        RecordedRun run{data, *thread};
        run.advance(170);
        run.checkpoint();
    }
    (void)file_left();
    for (const char* damage : {"UPDATE checkpoint SET state = substr(state, 1, length(state) - 1)",
                               "UPDATE checkpoint SET low = low + 1", "UPDATE checkpoint SET journal_entries = 7",
                               "UPDATE checkpoint SET state = CAST(x'00' || substr(state, 2) AS BLOB)"}) {
        change(data.file_of("w"), damage);
        const auto file = RunFile::open(data.file_of("w"), {});
        for (const auto& refused : {check(**file).error(), recover(**file, executor).error()}) {
            EXPECT_EQ(refused.code, base::RefusalCode::DataLoss);
            EXPECT_THAT(refused.message, HasSubstr("the row 170 of its table checkpoint"));
        }
    }
}

TEST_F(CheckpointTest, ACheckpointOfAnotherWorldIsReported) {
    RecordedRun run{data, *thread};
    run.advance(170);
    const Checkpoint sound = checkpoint_of(run.world(), 0, executor);
    run.advance(20);
    const auto file = file_left();
    const auto expect_reported = [&](const Checkpoint& checkpoint, const char* why, const char* part) {
        file->begin();
        file->write(checkpoint);
        ASSERT_TRUE(file->commit());
        const auto refused = recover(*file, executor).error();
        EXPECT_EQ(refused.code, base::RefusalCode::DataLoss);
        EXPECT_THAT(refused.message, HasSubstr("checkpoint after tick 170 does not belong to this run: "));
        EXPECT_THAT(refused.message, HasSubstr(why));
        const auto verified =
            verify(**RunFile::open_read_only(file->path()), three_threads, [](const VerifyProgress&) {});
        ASSERT_TRUE(verified) << to_text(verified.error());
        ASSERT_TRUE(verified->difference);
        EXPECT_EQ(verified->difference->differs.tick, 170u);
        EXPECT_THAT(verified->difference->part, HasSubstr(part));
        EXPECT_NE(verified->difference->stored, verified->difference->simulated);
    };
    Checkpoint other = sound;
    other.hash.low += 1;
    expect_reported(other, "its state hash differs", "the state hash");
    other = sound;
    other.state.islands[1].food[3].x += 1;
    expect_reported(other, "its state hash differs", "the checkpoint: the position of food 3 on island 1");
    other = sound;
    other.state.islands[0].food[3].x = -1;
    expect_reported(other, "position of an item", "the checkpoint: the position of food 3 on island 0");
    other = sound;
    other.state.islands[0].crates.resize(1);
    expect_reported(other, "its size differs", "the checkpoint");
    other = sound;
    other.state.parameters.active.damping = 0.5;
    expect_reported(other, "parameters", "the checkpoint: the parameter damping, in effect");
    other = sound;
    other.state.islands[0].counts.food_eaten += 1; // no hash covers this
    file->begin();
    file->write(other);
    ASSERT_TRUE(file->commit());
    const auto verified = verify(*file, three_threads, [](const VerifyProgress&) {});
    ASSERT_TRUE(verified && verified->difference);
    EXPECT_THAT(verified->difference->part, HasSubstr("the checkpoint: the counts on island 0"));
}

TEST_F(CheckpointTest, ATruncatedStateIsRefused) {
    RecordedRun run{data, *thread};
    run.advance(100);
    const simulation::WorldState state = run.world().state(executor);
    const std::string packed = pack(state);
    const std::vector<simulation::IslandShape> shapes = run.world().shapes();
    simulation::WorldState again;
    ASSERT_TRUE(unpack(packed, shapes, again));
    EXPECT_EQ(again.islands, state.islands);
    for (std::size_t size = 0; size < packed.size(); ++size) {
        EXPECT_FALSE(unpack(std::string_view{packed}.substr(0, size), shapes, again));
    }
    std::mt19937 random{4};
    for (int flip = 0; flip < 2000; ++flip) {
        std::string flipped = packed;
        flipped[random() % packed.size()] ^= static_cast<char>(1 << random() % 8);
        if (unpack(flipped, shapes, again)) { // other values, the same number of them
            EXPECT_EQ(again.islands.size(), 2u);
        }
    }
    std::vector<simulation::IslandShape> others = shapes;
    others[1].food += 1;
    EXPECT_FALSE(unpack(packed, others, again));
    others.pop_back();
    EXPECT_FALSE(unpack(packed, others, again));
}

TEST_F(CheckpointTest, ACheckpointCountsWithItsLastPart) {
    RecordedRun run{data, *thread};
    run.advance(170);
    const StoredCheckpoint checkpoint = pack(checkpoint_of(run.world(), 0, executor));
    thread.reset();
    const auto part_count = [&] {
        return Database{data.file_of("w"), Database::Mode::Read}.number("SELECT count(*) FROM checkpoint_part");
    };
    {
        const auto file = RunFile::open(data.file_of("w"), {.part_bytes = 256});
        EXPECT_FALSE(*(*file)->write_checkpoint_part(checkpoint));
        EXPECT_FALSE(*(*file)->write_checkpoint_part(checkpoint));
    }
    EXPECT_EQ(part_count(), 2);
    {
        const auto file = RunFile::open(data.file_of("w"), {.part_bytes = 256});
        EXPECT_THAT(ticks_of(**file), ElementsAre());
        expect_agrees(**RunFile::open_read_only(data.file_of("w")), 0);
        EXPECT_FALSE(*(*file)->purge_step()) << "a file that is only opened stays as it is";
        EXPECT_EQ(part_count(), 2);
        // The first write to the file deletes the orphaned parts.
        (*file)->begin();
        ASSERT_TRUE((*file)->commit());
        EXPECT_TRUE(*(*file)->purge_step());
        EXPECT_FALSE(*(*file)->purge_step());
        EXPECT_EQ(part_count(), 0);
        EXPECT_FALSE(*(*file)->write_checkpoint_part(checkpoint));
        EXPECT_FALSE(*(*file)->purge_step()) << "one that is being written stays";
        EXPECT_EQ(part_count(), 1);
    }
    {
        // Written from its first part, over the orphaned ones.
        const auto file = RunFile::open(data.file_of("w"), {.part_bytes = 200});
        while (!*(*file)->write_checkpoint_part(checkpoint)) {
            EXPECT_THAT(ticks_of(**file), ElementsAre());
        }
        EXPECT_EQ(part_count(), static_cast<std::int64_t>((checkpoint.state.size() - 1) / 200));
        const auto read = *(*file)->checkpoints().last(170);
        EXPECT_EQ(read->state, checkpoint.state);
        EXPECT_EQ(read->hash, checkpoint.hash);
        expect_agrees(**RunFile::open_read_only(data.file_of("w")), 1);
        // A commit that was reported as failed and had succeeded.
        EXPECT_TRUE(*(*file)->write_checkpoint_part(checkpoint));
        expect_agrees(**RunFile::open_read_only(data.file_of("w")), 1);
    }
    const std::int64_t parts = part_count();
    for (const auto& [damage, named] : {
             std::pair{"UPDATE checkpoint_part SET bytes = zeroblob(length(bytes)) WHERE part = 2",
                       "part 2 of the row 170 of its table checkpoint"},
             {"UPDATE checkpoint_part SET part = 100 WHERE part = 1", "part 1 of the row 170 of its table checkpoint"},
             {"DELETE FROM checkpoint_part WHERE part = 3", "part 3 of the row 170 of its table checkpoint"},
             {"DELETE FROM checkpoint_part WHERE part = (SELECT max(part) FROM checkpoint_part)",
              "the row 170 of its table checkpoint"},
             {"DELETE FROM checkpoint_part", "the row 170 of its table checkpoint"},
             {"UPDATE checkpoint SET state = zeroblob(length(state))", "the row 170 of its table checkpoint"},
         }) {
        const std::string sound = data.file_of("w") + ".sound";
        std::filesystem::copy_file(data.file_of("w"), sound, std::filesystem::copy_options::overwrite_existing);
        change(data.file_of("w"), damage);
        {
            const auto file = RunFile::open_read_only(data.file_of("w"));
            for (const auto& refused : {check(**file).error(), recover(**file, executor).error()}) {
                EXPECT_EQ(refused.code, base::RefusalCode::DataLoss) << damage;
                EXPECT_THAT(refused.message, HasSubstr(named)) << damage;
            }
        }
        ASSERT_TRUE(run_file::remove_run_file(data.file_of("w")));
        std::filesystem::rename(sound, data.file_of("w"));
        EXPECT_EQ(part_count(), parts);
    }
}

TEST_F(CheckpointTest, ARunMayBeginWithOne) {
    RecordedRun run{data, *thread};
    run.command(set_parameter("food_health", 9.0));
    run.advance(170);
    run.command(set_parameter("population_size", 15u));
    const GenerationBegun begun = beginning_of(run.world());
    const Checkpoint checkpoint = checkpoint_of(run.world(), 0, executor);
    const std::string path = data.file_of("fork");
    {
        const auto file = RunFile::create(path,
                                          {.name = "fork",
                                           .run_id = {3, 4},
                                           .seed = {7},
                                           .parameters = run.world().parameters().active,
                                           .requested = run.world().parameters().requested,
                                           .first_generation = 2,
                                           .first_tick = 170,
                                           .forked_from = simulation::RunId{1, 2}},
                                          {}, {begun, checkpoint});
        ASSERT_TRUE(file) << to_text(file.error());
        for (const auto& recovered : {recover(**file, executor), recover(**file, three_threads)}) {
            ASSERT_TRUE(recovered) << to_text(recovered.error());
            EXPECT_EQ(recovered->world.hash(), run.world().hash());
        }
        expect_agrees(**file, 0);
        simulation::World again = std::move(recover(**file, executor)->world);
        for (int tick = 0; tick < 200; ++tick) {
            again.advance_tick(executor);
            run.world().advance_tick(executor);
            ASSERT_EQ(again.hash(), run.world().hash());
        }
    }
    thread.reset();
    std::filesystem::remove(data.file_of("w"));
    { DataFolder taken = std::move(data); }
    base::StateHash hash = checkpoint.hash;
    for (int part = 0; part < 6; ++part) {
        const auto archive = Archive::open(folder.path(), {}, executor);
        ASSERT_TRUE(archive) << to_text(archive.error());
        simulation::Laboratory laboratory = (*archive)->take_laboratory();
        simulation::Entry& entry = **laboratory.find("fork");
        EXPECT_EQ(entry.world.hash(), hash);
        for (int tick = 0; tick < 70; ++tick) {
            laboratory.advance(entry, executor);
            (*archive)->recorder().of("fork")->follow(entry.world);
        }
        (*archive)->recorder().of("fork")->make_checkpoint(entry.world, executor);
        hash = entry.world.hash();
        (*archive)->recorder().close_all(laboratory);
        (*archive)->close();
    }
    {
        const auto file = RunFile::open_read_only(path);
        EXPECT_THAT(ticks_of(**file), ElementsAre(170, 450, 520, 590));
        expect_agrees(**file, 3);
        EXPECT_EQ(Rerun::at(**file, 2, executor)->world().moment().tick, 170u);
        EXPECT_EQ(Rerun::before(**file, 169, executor).error().code, base::RefusalCode::NotFound);
    }
    {
        Database database{path, Database::Mode::Write};
        database.run("DELETE FROM checkpoint WHERE tick = 170");
    }
    const auto file = RunFile::open_read_only(path);
    EXPECT_THAT(check(**file).error().message, HasSubstr("the row 170 of its table checkpoint"));
    EXPECT_THAT(Rerun::at(**file, 2, executor).error().message, HasSubstr("with which the run begins is missing"));
}

TEST_F(CheckpointTest, ACheckpointIsDueWhenSimulatingWouldTakeLong) {
    parameters::Parameters parameters = small_world();
    parameters.generation_s = 1000;
    simulation::World world{parameters, {1}};
    const auto number = thread->create(data.file_of("w"), beginning_of_run(world, "w", {}));
    RunRecorder recorder{*thread, number, {.generations = 1}, 0};
    world.advance_tick(executor);
    recorder.follow(world);
    EXPECT_FALSE(recorder.checkpoint_due(world, 2s)) << "as long as that is not too long";
    EXPECT_TRUE(recorder.checkpoint_due(world, 1ms));
    recorder.make_checkpoint(world, executor);
    EXPECT_FALSE(recorder.checkpoint_due(world, 1s));
    // The next one is due after fifty times what the last one took.
    ASSERT_TRUE(wait_until([&] { return thread->idle(); }));
    recorder.checkpoint_took(1s);
    EXPECT_FALSE(recorder.checkpoint_due(world, 48s));
    EXPECT_TRUE(recorder.checkpoint_due(world, 1h));
    // No checkpoint is due right after the beginning of a generation.
    simulation::World next{small_world(), {1}};
    for (int tick = 0; tick < 120; ++tick) {
        next.advance_tick(executor);
    }
    EXPECT_FALSE(recorder.checkpoint_due(next, 1000s)) << "its generation is over";
    next.advance_tick(executor);
    recorder.follow(next);
    EXPECT_FALSE(recorder.checkpoint_due(next, 1s));
}

} // namespace
} // namespace evod::run_file
