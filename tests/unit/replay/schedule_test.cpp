#include "server/parameters/schedule.h"

#include "server/jobs/thread_pool.h"
#include "server/parameters/experiment.h"
#include "server/replay/past_changes.h"
#include "server/replay/recovery.h"
#include "server/replay/rerun.h"
#include "server/replay/run_file_fork.h"
#include "server/replay/verify.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

namespace evod::replay {
namespace {

using namespace run_file;
using namespace recording;

using parameters::Schedule;
using testing::HasSubstr;

/// Generations of 120 ticks.
class StoredScheduleTest : public testing::Test {
  protected:
    StoredScheduleTest() : data{*DataFolder::open(folder.path())} {
        schedule.add(1, {"mutation_chance", 0.4});
        schedule.add(3, {"mutation_chance", 0.05});
        schedule.add(1, {"population_size", 12u});
        schedule.add(3, {"population_size", 20u});
        schedule.add(1, {"food_health", 25.0});
        schedule.add(2, {"food_health", 40.0});
        schedule.add(5, {"food_health", 5.0});
    }
    std::unique_ptr<RunFile> file_left() {
        thread.reset();
        auto file = RunFile::open(data.file_of("w"), {});
        EXPECT_TRUE(file) << to_text(file.error());
        return *std::move(file);
    }
    void expect_agrees(RunFile& file) {
        const auto verified = verify(file, three_threads, [](const VerifyProgress&) {});
        ASSERT_TRUE(verified) << to_text(verified.error());
        EXPECT_FALSE(verified->difference) << verified->difference->part;
    }

    TemporaryFolder folder;
    DataFolder data;
    Schedule schedule;
    std::unique_ptr<StorageThread> thread = std::make_unique<StorageThread>(RunFile::Options{});
    base::InlineExecutor executor;
    jobs::ThreadPool three_threads{3};
};

TEST_F(StoredScheduleTest, ItContinuesAfterAKillAtAnyMoment) {
    for (const std::uint64_t ticks : {0u, 100u, 239u, 240u, 241u, 300u, 480u, 481u, 550u}) {
        folder.clear();
        thread = std::make_unique<StorageThread>(RunFile::Options{});
        RecordedRun run{data, *thread, {7}, {}, schedule};
        run.advance(ticks);
        run.command(set_parameter("mutation_step", 9.0)); // so that the file contains this moment
        const auto file = file_left();
        EXPECT_EQ(file->identity().schedule, schedule);
        auto recovered = recover(*file, three_threads);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        simulation::World& again = recovered->world;
        ASSERT_EQ(again.moment(), run.world().moment());
        EXPECT_EQ(again.schedule(), schedule);
        EXPECT_EQ(again.parameters().revision, run.world().parameters().revision);
        EXPECT_TRUE(again.parameters().active == run.world().parameters().active) << ticks;
        EXPECT_TRUE(again.parameters().requested == run.world().parameters().requested) << ticks;
        for (int tick = 0; tick < 300; ++tick) {
            again.advance_tick(three_threads);
            run.world().advance_tick(executor);
            ASSERT_EQ(again.hash(), run.world().hash());
        }
        EXPECT_TRUE(again.parameters().active == run.world().parameters().active) << ticks;
        EXPECT_EQ(again.changes().all(), run.world().changes().all()) << ticks;
        EXPECT_GT(again.changes().all().size(), 1u);
        expect_agrees(*file);
    }
}

TEST_F(StoredScheduleTest, EveryGenerationAndCheckpointReproducesTheRun) {
    std::vector<base::StateHash> hashes;
    {
        RecordedRun run{data, *thread, {7}, {}, schedule};
        hashes.push_back(run.world().hash());
        for (int tick = 1; tick <= 700; ++tick) {
            run.advance(1);
            if (tick == 250 || tick == 600) {
                run.checkpoint();
            }
            if (tick == 300) {
                run.command(set_parameter("mutation_chance", 0.7)); // after the scheduled value of its generation
            }
            if (tick == 400) {
                run.command(set_parameter("food_health", 33.0)); // until the next scheduled value
            }
            hashes.push_back(run.world().hash());
        }
        EXPECT_EQ(run.world().parameters().active.food_health, 5);
        EXPECT_EQ(run.world().parameters().active.mutation_chance, 0.7);
    }
    const auto file = file_left();
    expect_agrees(*file);
    for (std::uint64_t generation = 1; generation <= 6; ++generation) {
        auto rerun = Rerun::at(*file, generation, executor);
        ASSERT_TRUE(rerun) << to_text(rerun.error());
        while (rerun->world().moment().tick < 700) {
            rerun->advance_tick(executor);
            ASSERT_EQ(rerun->world().hash(), hashes[rerun->world().moment().tick]) << generation;
        }
    }
    for (const std::uint64_t tick : {255u, 610u}) {
        auto rerun = Rerun::before(*file, tick, executor);
        ASSERT_TRUE(rerun) << to_text(rerun.error());
        EXPECT_EQ(rerun->world().moment().tick, tick == 255u ? 250u : 600u);
        rerun->advance_to(700, executor);
        EXPECT_EQ(rerun->world().hash(), hashes[700]);
    }
}

TEST_F(StoredScheduleTest, AForkHasTheSchedule) {
    base::StateHash origin;
    {
        RecordedRun run{data, *thread, {7}, {}, schedule};
        run.advance(620);
        origin = run.world().hash();
    }
    const auto file = file_left();
    for (const std::uint64_t generation : {2u, 3u, 4u}) {
        const std::string path = folder.path() + "/fork" + std::to_string(generation) + ".evod";
        ASSERT_TRUE(fork(*file, generation, path, "fork", {3, generation}, executor));
        const auto forked = RunFile::open(path, {});
        ASSERT_TRUE(forked) << to_text(forked.error());
        EXPECT_EQ((*forked)->identity().schedule, schedule);
        auto recovered = recover(**forked, executor);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        while (recovered->world.moment().tick < 620) {
            recovered->world.advance_tick(executor);
        }
        EXPECT_EQ(recovered->world.hash(), origin);
        EXPECT_EQ(recovered->world.parameters().active.food_health, 5);
        expect_agrees(**forked);
    }
}

TEST_F(StoredScheduleTest, AChangedScheduleIsReported) {
    {
        RecordedRun run{data, *thread, {7}, {}, schedule};
        run.advance(300);
    }
    const std::string path = data.file_of("w");
    (void)file_left();
    std::filesystem::copy_file(path, path + ".sound");
    const auto forged = [&](const std::string& sql) -> base::Refusal {
        std::filesystem::copy_file(path + ".sound", path, std::filesystem::copy_options::overwrite_existing);
        change(data.file_of("w"), sql);
        const auto file = RunFile::open(path, {});
        return file ? base::Refusal{.code = {}, .message = "read", .violations = {}} : file.error();
    };
    for (const char* sql : {"UPDATE run SET value = '{}' WHERE key = 'schedule'", // with a wrong checksum
                            "DELETE FROM run WHERE key = 'schedule'"}) {
        const base::Refusal refused = forged(sql);
        EXPECT_EQ(refused.code, base::RefusalCode::DataLoss) << sql;
        EXPECT_THAT(refused.message, HasSubstr("table run")) << sql;
    }
    // With a right checksum.
    const auto rewritten = [&](const std::string& text) {
        std::filesystem::copy_file(path + ".sound", path, std::filesystem::copy_options::overwrite_existing);
        Database database{path, Database::Mode::Write};
        RowWriter{database, "run", {"key", "value"}}.text("schedule").text(text).finish();
        EXPECT_FALSE(database.failed());
    };
    for (const char* text : {"no JSON", "[]", R"({"island_count": {"1": 2, "3": 4}})", R"({"mutation_chance": 0.4})",
                             R"({"mutation_chance": {"1": 0.4, "3": 7}})", R"({"mutation_chance": {"3": 0.05}})",
                             R"({"mutation_chance": {"1": 0.3, "3": 0.05}})"}) { // the run began with 0.4
        rewritten(text);
        const auto file = RunFile::open(path, {});
        ASSERT_FALSE(file) << text;
        EXPECT_EQ(file.error().code, base::RefusalCode::DataLoss) << text;
    }
    Schedule other = schedule;
    other.remove("food_health");
    rewritten(parameters::to_schedule_text(other)); // a valid schedule
    const auto file = RunFile::open(path, {});
    ASSERT_TRUE(file) << to_text(file.error());
    const auto verified = verify(**file, executor, [](const VerifyProgress&) {});
    ASSERT_TRUE(verified) << to_text(verified.error());
    ASSERT_TRUE(verified->difference);
    EXPECT_EQ(verified->difference->differs.generation, 2u);
}

v1::Request at_generation(v1::Request request, std::uint64_t generation) {
    request.mutable_set_parameters()->set_at_generation(generation);
    return request;
}
v1::Request at_tick(v1::Request request, std::uint64_t tick) {
    request.mutable_set_parameters()->set_at_tick(tick);
    return request;
}
v1::Request cancel(std::uint64_t id) {
    v1::Request request;
    request.mutable_cancel_change()->set_id(id);
    return request;
}

TEST_F(StoredScheduleTest, PlannedChangesSurviveAKillAtAnyMoment) {
    for (const std::uint64_t ticks : {11u, 120u, 121u, 199u, 200u, 201u, 239u, 240u, 241u, 300u, 470u}) {
        folder.clear();
        thread = std::make_unique<StorageThread>(RunFile::Options{});
        RecordedRun run{data, *thread, {7}, {}, schedule};
        run.advance(10);
        run.command(at_generation(set_parameter("mutation_step", 3.0), 3)); // 1
        run.command(at_tick(set_parameter("poison_harm", 1.0), 200));       // 2
        run.command(at_generation(set_parameter("food_count", 9u), 4));     // 3
        run.command(at_tick(set_parameter("impulse_min", 240.0), 450));     // 4: not allowed at that moment
        run.command(at_tick(set_parameter("respawn_s", 2.0), 460));         // 5
        run.command(cancel(3));
        run.command(set_parameter("impulse_max", 230.0));
        run.advance(ticks - 10);
        if (ticks % 2 == 0) {
            run.checkpoint();
        }
        run.command(set_parameter("steering_lookahead_s", 0.2)); // so that the file contains this moment
        const auto file = file_left();
        auto recovered = recover(*file, three_threads);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        simulation::World& again = recovered->world;
        ASSERT_EQ(again.moment(), run.world().moment());
        EXPECT_EQ(again.hash(), run.world().hash());
        ASSERT_EQ(again.planned().size(), run.world().planned().size()) << ticks;
        for (std::size_t i = 0; i < again.planned().size(); ++i) {
            EXPECT_EQ(again.planned()[i].id, run.world().planned()[i].id);
            EXPECT_EQ(again.planned()[i].at, run.world().planned()[i].at);
            EXPECT_EQ(again.planned()[i].assignments, run.world().planned()[i].assignments);
            EXPECT_EQ(again.planned()[i].by.user, "alice") << "with the name of its client";
        }
        EXPECT_EQ(again.changes().all(), run.world().changes().all()) << ticks;
        EXPECT_EQ(again.plan({.id = 0, .at = {.generation = 99, .tick = {}}, .assignments = {}, .by = {}}), 6u);
        while (again.moment().tick < 600) {
            again.advance_tick(three_threads);
            ASSERT_EQ(again.cancel(6).has_value(), again.moment().tick == ticks + 1);
            run.world().advance_tick(executor);
            ASSERT_EQ(again.hash(), run.world().hash()) << ticks;
            ASSERT_TRUE(again.parameters().active == run.world().parameters().active) << ticks;
            ASSERT_EQ(again.parameters().revision, run.world().parameters().revision);
        }
        const parameters::Parameters& held = again.parameters().active;
        EXPECT_EQ(held.mutation_step, 3);
        EXPECT_EQ(held.poison_harm, 1);
        EXPECT_EQ(held.food_count, 40u);
        EXPECT_EQ(held.impulse_min, 20);
        EXPECT_EQ(held.respawn_s, 2);
        EXPECT_EQ(again.changes().all(), run.world().changes().all()) << ticks;
        expect_agrees(*file);
    }
}

TEST_F(StoredScheduleTest, EveryMomentWithPlannedChangesIsReproduced) {
    std::vector<base::StateHash> hashes;
    std::deque<simulation::Change> changes;
    {
        RecordedRun run{data, *thread};
        for (std::uint64_t tick = 0; tick <= 600; ++tick) {
            hashes.push_back(run.world().hash());
            if (tick == 130) {
                run.command(at_generation(set_parameter("population_size", 20u), 4));
            }
            if (tick == 240) { // between generations 2 and 3
                run.command(at_generation(set_parameter("mutation_chance", 0.9), 3));
            }
            if (tick == 250) {
                run.command(at_tick(set_parameter("food_health", 70.0), 480));
            }
            if (tick == 300) {
                run.checkpoint();
            }
            run.advance(1);
        }
        changes = run.world().changes().all();
        EXPECT_EQ(changes.size(), 3u);
    }
    const auto file = file_left();
    expect_agrees(*file);
    for (std::uint64_t generation = 1; generation <= 5; ++generation) {
        auto rerun = Rerun::at(*file, generation, executor);
        ASSERT_TRUE(rerun) << to_text(rerun.error());
        rerun->advance_to(600, executor);
        EXPECT_EQ(rerun->world().hash(), hashes[600]) << generation;
        EXPECT_EQ(rerun->world().changes().all(), changes) << generation;
    }
    auto rerun = Rerun::before(*file, 310, executor);
    ASSERT_TRUE(rerun) << to_text(rerun.error());
    EXPECT_EQ(rerun->world().moment().tick, 300u);
    EXPECT_EQ(rerun->world().planned().size(), 2u);
    EXPECT_EQ(rerun->world().changes().all().size(), 1u) << "the change for generation 3";
    rerun->advance_to(600, executor);
    EXPECT_EQ(rerun->world().changes().all(), changes);
    EXPECT_EQ(rerun->world().hash(), hashes[600]);

    // A fork has no planned changes of its origin.
    const std::string path = folder.path() + "/fork.evod";
    ASSERT_TRUE(fork(*file, 3, path, "fork", {3, 3}, executor));
    const auto forked = RunFile::open(path, {});
    auto recovered = recover(**forked, executor);
    ASSERT_TRUE(recovered) << to_text(recovered.error());
    EXPECT_TRUE(recovered->world.planned().empty());
    EXPECT_TRUE(recovered->world.changes().all().empty());
    while (recovered->world.moment().tick < 600) {
        recovered->world.advance_tick(executor);
    }
    EXPECT_EQ(recovered->world.parameters().active.population_size, 12u);
    EXPECT_NE(recovered->world.hash(), hashes[600]);
}

TEST_F(StoredScheduleTest, AnImpossiblePlannedChangeIsReported) {
    const auto error_of = [&](const v1::Request& forged, bool found_by_recovery) {
        folder.clear();
        thread = std::make_unique<StorageThread>(RunFile::Options{});
        {
            RecordedRun run{data, *thread};
            run.advance(50);
            run.command(at_generation(set_parameter("mutation_chance", 0.9), 3));
            run.advance(250);
        }
        const auto file = file_left();
        JournalEntry entry = (*file->journal().read())[0];
        v1::Request request = forged;
        request.set_client_key("test");
        entry.origin.request = request.SerializeAsString();
        file->begin();
        file->write(entry);
        EXPECT_TRUE(file->commit());
        const auto verified = verify(*file, executor, [](const VerifyProgress&) {});
        const auto recovered = recover(*file, executor);
        EXPECT_EQ(recovered.has_error(), found_by_recovery) << forged.ShortDebugString();
        if (!recovered) {
            EXPECT_EQ(recovered.error().code, base::RefusalCode::DataLoss);
        }
        return verified ? std::string{"agrees"} : verified.error().message;
    };
    // Recovery starts later, and reads earlier entries only for planned changes.
    const v1::Request past_generation = at_generation(set_parameter("mutation_chance", 0.9), 1);
    EXPECT_THAT(error_of(past_generation, false), HasSubstr("entry 1 of its journal"));
    for (const v1::Request& forged : {at_tick(set_parameter("mutation_chance", 0.9), 50),
                                      at_tick(set_parameter("mutation_chance", 7.0), 90), cancel(1)}) {
        EXPECT_THAT(error_of(forged, true), HasSubstr("entry 1 of its journal")) << forged.ShortDebugString();
    }
}

} // namespace
} // namespace evod::replay
