// Verifies runs as they were recorded, and runs with one record changed, with a right checksum.
#include "server/replay/verify.h"

#include "server/jobs/thread_pool.h"
#include "server/replay/archive.h"
#include "server/replay/run_file_fork.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <random>

namespace evod::replay {
namespace {

using namespace run_file;
using namespace recording;

using testing::HasSubstr;

class VerifyTest : public testing::Test {
  protected:
    VerifyTest() : data{*DataFolder::open(folder.path())} {}

    /// A run of four generations and a half, 120 ticks each, with changes within and between generations; as a server
    /// leaves it that is killed.
    void record(std::uint64_t ticks = 540) {
        folder.clear();
        StorageThread thread{{}};
        RecordedRun run{data, thread};
        run.command(set_parameter("food_health", 20.0)); // 1, before the first tick
        for (std::uint64_t tick = 0; tick < ticks; ++tick) {
            run.advance(1);
            if (tick + 1 == 130) {
                run.command(set_parameter("food_health", 7.0)); // 2, from the next tick on
            }
            if (tick + 1 == 240) {
                run.command(set_parameter("mutation_chance", 0.5)); // 3, between generations 2 and 3
            }
            if (tick + 1 == 300) {
                run.command(set_parameter("food_count", 30u)); // 4, from generation 4 on
            }
        }
    }

    std::unique_ptr<RunFile> file() {
        auto opened = RunFile::open(data.file_of("w"), {});
        EXPECT_TRUE(opened) << to_text(opened.error());
        return *std::move(opened);
    }
    template <class Record>
    void write(const Record& record) {
        const auto to = file();
        to->begin();
        to->write(record);
        ASSERT_TRUE(to->commit());
    }

    base::Result<Verified> verified(base::Executor& executor) {
        return verify(*file(), executor, [](const VerifyProgress&) {});
    }
    /// The difference of a changed run; the same with every executor.
    Difference difference() {
        Difference first;
        for (base::Executor* executor : std::initializer_list<base::Executor*>{&one_thread, &two_threads, &many}) {
            const auto result = verified(*executor);
            EXPECT_TRUE(result) << to_text(result.error());
            EXPECT_TRUE(result && result->difference);
            if (!result || !result->difference) {
                return {};
            }
            const Difference& found = *result->difference;
            if (executor == &one_thread) {
                first = found;
            }
            EXPECT_EQ(found.agrees.has_value(), first.agrees.has_value());
            if (found.agrees && first.agrees) {
                EXPECT_EQ(found.agrees->tick, first.agrees->tick);
            }
            EXPECT_EQ(found.differs.generation, first.differs.generation);
            EXPECT_EQ(found.differs.tick, first.differs.tick);
            EXPECT_EQ(found.part, first.part);
            EXPECT_EQ(found.stored, first.stored);
            EXPECT_EQ(found.simulated, first.simulated);
        }
        return first;
    }
    void expect_difference(std::uint64_t generation, std::uint64_t tick, const std::string& part,
                           std::optional<std::uint64_t> agrees) {
        const Difference found = difference();
        EXPECT_EQ(found.differs.generation, generation);
        EXPECT_EQ(found.differs.tick, tick);
        EXPECT_THAT(found.part, HasSubstr(part));
        EXPECT_NE(found.stored, found.simulated);
        EXPECT_EQ(found.agrees ? std::optional{found.agrees->tick} : std::nullopt, agrees);
    }

    TemporaryFolder folder;
    DataFolder data;
    base::InlineExecutor one_thread;
    jobs::ThreadPool two_threads{2}, many{7}; // fewer and more threads than generations
};

TEST_F(VerifyTest, ARunAgreesWithItselfOnAnyNumberOfThreads) {
    record();
    for (base::Executor* executor : std::initializer_list<base::Executor*>{&one_thread, &two_threads, &many}) {
        const auto result = verified(*executor);
        ASSERT_TRUE(result) << to_text(result.error());
        EXPECT_FALSE(result->difference) << result->difference->part;
        EXPECT_EQ(result->generations, 5u);
        EXPECT_EQ(result->ticks, 540u);
        EXPECT_EQ(result->hashes, 9u);
        EXPECT_NEAR(result->simulated_s, 9, 1e-9);
    }
}

TEST_F(VerifyTest, ARunWhoseFitnessWasShuffledForAWhileAgrees) {
    std::vector<std::vector<evolution::Parents>> parents;
    for (const bool shuffled : {false, true}) {
        folder.clear();
        {
            StorageThread thread{{}};
            RecordedRun run{data, thread};
            run.advance(130);
            if (shuffled) {
                run.command(set_parameter("shuffle_fitness", true)); // from the breeding after generation 3 on …
            }
            run.advance(230);
            if (shuffled) {
                run.command(set_parameter("shuffle_fitness", false)); // … and not after generation 4
            }
            run.advance(180);
            parents.push_back(run.world().islands()[0].born().parents);
            run.recorder().close_all(run.laboratory());
        }
        for (base::Executor* executor : std::initializer_list<base::Executor*>{&one_thread, &many}) {
            const auto result = verified(*executor);
            ASSERT_TRUE(result) << to_text(result.error());
            EXPECT_FALSE(result->difference) << result->difference->part;
            EXPECT_EQ(result->ticks, 540u);
        }
    }
    EXPECT_NE(parents[0], parents[1]);
}

TEST_F(VerifyTest, ARunWhoseFitnessWeightsChangeAgrees) {
    {
        StorageThread thread{{}};
        RecordedRun run{data, thread};
        run.advance(70);
        run.command(set_parameter("fitness_per_food", 10.0)); // in generations 2 and 3
        run.command(set_parameter("fitness_per_second", 0.0));
        run.advance(230);
        run.command(set_parameter("fitness_per_food", 0.0));
        run.command(set_parameter("fitness_per_poison", -3.0));
        run.advance(240);
        run.recorder().close_all(run.laboratory());
    }
    for (base::Executor* executor : std::initializer_list<base::Executor*>{&one_thread, &many}) {
        const auto result = verified(*executor);
        ASSERT_TRUE(result) << to_text(result.error());
        EXPECT_FALSE(result->difference) << result->difference->part;
        EXPECT_EQ(result->ticks, 540u);
    }
    auto ended = **file()->generations().outcome_of(3);
    ended.outcomes[0].fitness[3] += 10; // one more meal
    write(ended);
    expect_difference(3, 360, "the fitness of organism 3 on island 0", 360);
}

TEST_F(VerifyTest, ARunAgreesAfterAKillAtAnyMoment) {
    for (const std::uint64_t ticks : {0, 1, 59, 60, 119, 120, 121, 180, 239, 240, 241, 299, 300, 301}) {
        record(ticks);
        const auto result = verified(two_threads);
        ASSERT_TRUE(result) << to_text(result.error());
        EXPECT_FALSE(result->difference) << ticks << " ticks: " << result->difference->part;
        EXPECT_LE(result->ticks, ticks);
        EXPECT_EQ(result->hashes, ticks / ticks_per_hash);
    }
}

TEST_F(VerifyTest, AgreesWhereverTheLastCommitCame) {
    record();
    // The last records, newest first, in the order of handing over.
    for (const char* sql : {"DELETE FROM state_hash WHERE tick = 540", "DELETE FROM generation WHERE generation = 5",
                            "DELETE FROM statistics WHERE generation = 4", "DELETE FROM state_hash WHERE tick = 480",
                            "DELETE FROM state_hash WHERE tick = 420", "DELETE FROM generation WHERE generation = 4",
                            "DELETE FROM statistics WHERE generation = 3", "DELETE FROM state_hash WHERE tick = 360",
                            "DELETE FROM journal WHERE number = 4", "DELETE FROM state_hash WHERE tick = 300"}) {
        change(data.file_of("w"), sql);
        change(data.file_of("w"), "DELETE FROM population WHERE generation > (SELECT max(generation) FROM generation)");
        change(data.file_of("w"), "DELETE FROM outcome WHERE generation > (SELECT max(generation) FROM statistics)");
        const auto result = verified(two_threads);
        ASSERT_TRUE(result) << sql << ": " << to_text(result.error());
        EXPECT_FALSE(result->difference) << sql << ": " << result->difference->part;
    }
}

TEST_F(VerifyTest, ARunContinuedAfterItsEndAgrees) {
    {
        StorageThread thread{{}};
        RecordedRun run{data, thread};
        run.command(set_parameter("generation_limit", 2u));
        run.advance(1000);
        ASSERT_EQ(run.world().moment().tick, 240u);
        run.command(set_parameter("generation_limit", 3u));
        run.advance(1000);
        run.recorder().close_all(run.laboratory());
    }
    const auto result = verified(two_threads);
    ASSERT_TRUE(result) << to_text(result.error());
    EXPECT_FALSE(result->difference) << result->difference->part;
    EXPECT_EQ(result->ticks, 360u);

    // Without the raised limit, the run would end before its third generation.
    auto entry = (*file()->journal().read())[1];
    entry.origin.request = (*file()->journal().read())[0].origin.request;
    write(entry);
    expect_difference(3, 240, "the run's end", 240);
}

TEST_F(VerifyTest, AFunctionOfTheChromosomeIsVerifiedTickByTick) {
    {
        StorageThread thread{{}};
        simulation::Laboratory laboratory;
        parameters::Parameters parameters = small_world();
        parameters.fitness = parameters::FitnessFunction::Rastrigin;
        ASSERT_TRUE(laboratory.apply(simulation::CreateWorld{"w", parameters, {3}, {1, 2}}));
        Recorder recorder{data, thread};
        simulation::Entry& entry = **laboratory.find("w");
        recorder.begin(run_file::beginning_of_run(entry.world, "w", {1, 2}));
        for (int tick = 0; tick < 150; ++tick) {
            entry.world.advance_tick(one_thread);
            recorder.of("w")->follow(entry.world);
        }
        recorder.close_all(laboratory);
    }
    const auto result = verified(two_threads);
    ASSERT_TRUE(result) << to_text(result.error());
    EXPECT_FALSE(result->difference) << result->difference->part;
    EXPECT_EQ(result->generations, 150u);
    EXPECT_EQ(result->hashes, 2u);

    auto ended = **file()->generations().outcome_of(77);
    ended.outcomes[0].fitness[3] += 1;
    write(ended);
    expect_difference(77, 77, "the fitness of organism 3 on island 0", 76);
}

TEST_F(VerifyTest, AForkAgreesFromItsBeginningOn) {
    record();
    const TemporaryFolder other;
    const std::string path = other.path() + "/f.evod";
    ASSERT_TRUE(fork(*file(), 3, path, "f", {3, 4}, one_thread));
    {
        const auto archive = Archive::open(other.path(), {}, one_thread);
        ASSERT_TRUE(archive) << to_text(archive.error());
        simulation::Laboratory laboratory = (*archive)->take_laboratory();
        simulation::Entry& entry = **laboratory.find("f");
        for (int tick = 0; tick < 200; ++tick) {
            laboratory.advance(entry, one_thread);
            (*archive)->recorder().of("f")->follow(entry.world);
        }
        (*archive)->recorder().close_all(laboratory);
        (*archive)->close();
    }
    const auto forked = *RunFile::open(path, {});
    std::atomic<std::uint64_t> ticks_in_all = 0;
    const auto result =
        verify(*forked, two_threads, [&](const VerifyProgress& now) { ticks_in_all = now.ticks_in_all; });
    ASSERT_TRUE(result) << to_text(result.error());
    EXPECT_FALSE(result->difference) << result->difference->part;
    EXPECT_EQ(result->generations, 2u);
    EXPECT_EQ(result->ticks, 200u);
    EXPECT_EQ(result->hashes, 3u);
    EXPECT_EQ(ticks_in_all, 200u);
}

TEST_F(VerifyTest, APurgedRunAgreesAndItsRetainedPartIsCompared) {
    const auto record_much = [this] {
        folder.clear();
        StorageThread thread{
            {.durability = Durability::Relaxed, .vfs = nullptr, .file_bytes_max = std::int64_t{230} << 10}};
        RecordedRun run{data, thread};
        for (int part = 0; part < 12; ++part) {
            run.advance(1010);
            run.command(set_parameter("mutation_chance", 0.1 + 0.01 * part));
            while (!thread.idle()) { // so that the retention is reduced several times
            }
        }
        run.recorder().close_all(run.laboratory());
    };
    record_much();
    constexpr std::uint64_t taken_out = 2;
    ASSERT_FALSE(*file()->generations().beginning_of(taken_out)) << "nothing was taken out";
    const auto result = verified(two_threads);
    ASSERT_TRUE(result) << to_text(result.error());
    EXPECT_FALSE(result->difference) << result->difference->part;
    EXPECT_EQ(result->generations, 101u);
    EXPECT_EQ(result->ticks, 12'120u);
    EXPECT_EQ(result->hashes, file()->contents().hashes);
    EXPECT_LT(result->hashes, 190u);

    GenerationEnded ended{
        .generation = taken_out, .outcomes = {}, .statistics = *file()->generations().statistics_of(taken_out)};
    ++ended.statistics[1].food_eaten;
    write(ended);
    expect_difference(2, 240, "the statistics: food_eaten on island 1", 120);

    record_much();
    GenerationBegun begun{.opening = **file()->generations().opening_of(taken_out), .born = {}};
    begun.opening.progress.best_fitness += 1;
    write(begun);
    expect_difference(2, 120, "the best fitness so far", 120);

    record_much();
    HashRecord link = (*file()->hashes(0, 12'000)).at(2);
    ASSERT_GT(link.tick, 180u);
    link.hash.low ^= 1;
    write(link);
    expect_difference((link.tick - 1) / 120 + 1, link.tick, "the state hash", difference().agrees->tick);
}

TEST_F(VerifyTest, ReportsItsProgressOfReadingAndSimulating) {
    record();
    std::vector<std::uint64_t> read;
    VerifyProgress last;
    ASSERT_TRUE(verify(*file(), one_thread, [&](const VerifyProgress& now) {
        if (now.ticks == 0) {
            read.push_back(now.generations);
        }
        EXPECT_EQ(now.generations_in_all, file()->generations().last());
        EXPECT_GE(now.ticks, last.ticks);
        last = now;
    }));
    EXPECT_EQ(read.size(), last.generations_in_all) << "each generation, as it is read";
    EXPECT_TRUE(std::ranges::is_sorted(read));
    EXPECT_EQ(read.front(), 0u);
    EXPECT_EQ(last.ticks, last.ticks_in_all);
    EXPECT_EQ(last.generations, last.generations_in_all);
}

TEST_F(VerifyTest, AChangedStateHashIsReported) {
    record();
    HashRecord link = (*file()->hashes(120, 180)).at(0);
    const std::string was = to_text(link.hash);
    link.hash.high ^= 1;
    write(link);
    expect_difference(2, 180, "the state hash", 120);
    EXPECT_EQ(difference().simulated, was);
    EXPECT_EQ(difference().stored, to_text(link.hash));
}

TEST_F(VerifyTest, AMissingLastStateHashIsReported) {
    record();
    change(data.file_of("w"), "DELETE FROM state_hash WHERE tick >= 480");
    expect_difference(4, 480, "the state hash", 420);
}

TEST_F(VerifyTest, AChangedOutcomeIsReported) {
    struct Change {
        std::function<void(GenerationEnded&)> make;
        const char* part;
    };
    for (const Change& change : std::initializer_list<Change>{
             {[](auto& ended) { ended.outcomes[1].fitness[11] = std::nextafter(ended.outcomes[1].fitness[11], 1e9); },
              "the fitness of organism 11 on island 1"},
             {[](auto& ended) { ended.outcomes[0].fitness[2] = std::numeric_limits<double>::quiet_NaN(); },
              "the fitness of organism 2 on island 0"},
             {[](auto& ended) { ++ended.outcomes[0].lived_ticks[5]; }, "the ticks lived of organism 5 on island 0"},
             {[](auto& ended) { ended.outcomes[0].cause[0] = static_cast<simulation::CauseOfDeath>(9); },
              "the cause of death of organism 0 on island 0"},
             {[](auto& ended) {
                  for (IslandOutcome& outcome : ended.outcomes) {
                      outcome.fitness.pop_back();
                      outcome.lived_ticks.pop_back();
                      outcome.cause.pop_back();
                  }
              },
              "the number of organisms on island 0"},
             {[](auto& ended) { ended.statistics[1].diversity += 1e-9; }, "the statistics: diversity on island 1"},
             {[](auto& ended) { ++ended.statistics[0].food_eaten; }, "the statistics: food_eaten on island 0"},
             {[](auto& ended) { ended.statistics[0].genes[5].max += 1; },
              "the statistics: poison_radius_max on island 0"},
         }) {
        record();
        GenerationEnded ended = **file()->generations().outcome_of(3);
        change.make(ended);
        write(ended);
        expect_difference(3, 360, change.part, 360);
    }
}

TEST_F(VerifyTest, AChangedBeginningIsReported) {
    struct Change {
        std::function<void(GenerationBegun&)> make;
        const char* part;
    };
    for (const Change& change : std::initializer_list<Change>{
             {[](auto& begun) { begun.born[1].genes(2, 7) += 0.5f; },
              "the chromosomes: gene body_size of organism 7 on island 1"},
             {[](auto& begun) { begun.born[0].genes(0, 0) = std::numeric_limits<float>::quiet_NaN(); },
              "gene normal_speed of organism 0 on island 0"},
             {[](auto& begun) { begun.born[0].genes(5, 11) = 1e30f; }, "gene poison_radius of organism 11 on island 0"},
             {[](auto& begun) {
                  begun.born[0].genes.conservativeResize(Eigen::NoChange, 11);
                  begun.born[0].parents.pop_back();
                  begun.founders[0].pop_back();
              },
              "the number of organisms on island 0"},
             {[](auto& begun) { begun.born[1].parents[4].second ^= 1; }, "the parents of organism 4 on island 1"},
             {[](auto& begun) { begun.founders[1][3] ^= 1; }, "the founder of organism 3 on island 1"},
             {[](auto& begun) { ++begun.born[0].elite_count; }, "the number of elite organisms on island 0"},
             {[](auto& begun) { ++begun.born[0].survivor_count; }, "the number of survivors on island 0"},
             {[](auto& begun) { ++begun.born[1].clamped_count; }, "the number of genes clamped to their bounds"},
             {[](auto& begun) { begun.opening.moment.simulated_s += 1; }, "the simulated seconds"},
             {[](auto& begun) { begun.opening.parameters.active.food_count = 3; },
              "the parameter food_count, in effect"},
             {[](auto& begun) { begun.opening.parameters.requested.values.food_count = 3; },
              "the parameter food_count, requested"},
             {[](auto& begun) { ++begun.opening.parameters.revision; }, "the revision of the parameters"},
             {[](auto& begun) { ++begun.opening.progress.generations; }, "completed generations"},
             {[](auto& begun) { ++begun.opening.progress.stagnant; }, "generations without improvement"},
             {[](auto& begun) { begun.opening.progress.best_fitness += 1; }, "the best fitness so far"},
             {[](auto& begun) { begun.opening.progress.last_best_fitness += 1; }, "of the previous generation"},
             {[](auto& begun) { begun.opening.progress.last_died_out ^= true; },
              "whether the previous generation died out"},
         }) {
        record();
        GenerationBegun begun = **file()->generations().beginning_of(4);
        change.make(begun);
        write(begun);
        SCOPED_TRACE(change.part);
        expect_difference(4, 360, change.part, 360);
    }
}

TEST_F(VerifyTest, AnotherBeginningOfTheRunAgreesWithNothing) {
    record();
    GenerationBegun begun = **file()->generations().beginning_of(1);
    begun.born[0].genes(3, 3) += 1;
    write(begun);
    expect_difference(1, 0, "the chromosomes: gene base_health of organism 3 on island 0", std::nullopt);
}

TEST_F(VerifyTest, ARunUnderAnotherSeedAgreesWithNothing) {
    record();
    const auto from = file();
    RunIdentity identity = from->identity();
    identity.seed.value += 1;
    const std::string path = folder.path() + "/other.evod";
    auto to = *RunFile::create(path, identity, {});
    to->begin();
    to->write(**from->generations().beginning_of(1));
    ASSERT_TRUE(to->commit());
    const auto result = verify(*to, one_thread, [](const VerifyProgress&) {});
    ASSERT_TRUE(result && result->difference);
    EXPECT_FALSE(result->difference->agrees);
}

TEST_F(VerifyTest, AChangedFirstTickIsReported) {
    for (const auto& [first_tick, tick] : {std::pair{239u, 239u}, {241u, 240u}, {0u, 120u}, {100'000u, 240u}}) {
        record();
        GenerationBegun begun = **file()->generations().beginning_of(3);
        begun.opening.moment.tick = first_tick;
        write(begun);
        const Difference found = difference();
        EXPECT_EQ(found.differs.generation, 2u) << first_tick;
        EXPECT_EQ(found.differs.tick, tick) << first_tick;
        EXPECT_EQ(found.part, "the generation's end") << first_tick;
    }
}

TEST_F(VerifyTest, AChangedCommandIsReportedWhereItActs) {
    record();
    JournalEntry entry = (*file()->journal().read())[2];
    entry.origin.request = [] {
        v1::Request request = set_parameter("mutation_chance", 0.25);
        request.set_client_key("test");
        return request.SerializeAsString();
    }();
    write(entry);
    expect_difference(3, 240, "the parameter mutation_chance", 240);
    EXPECT_EQ(difference().stored, "0.5");
    EXPECT_EQ(difference().simulated, "0.25");
}

TEST_F(VerifyTest, AMovedCommandIsReported) {
    record();
    JournalEntry entry = (*file()->journal().read())[2];
    entry.tick = 245;
    write(entry);
    expect_difference(3, 240, "the parameter mutation_chance", 240);
}

TEST_F(VerifyTest, AnUnknownCommandIsReported) {
    const auto refused_with = [&](const std::string& request, std::uint64_t tick = 130) {
        record();
        JournalEntry entry = (*file()->journal().read())[1];
        entry.origin.request = request;
        entry.tick = tick;
        write(entry);
        const auto result = verified(two_threads);
        EXPECT_TRUE(result.has_error());
        return result ? base::Refusal{} : result.error();
    };
    const auto request = [](const char* name, parameters::ParameterValue value) {
        v1::Request message = set_parameter(name, std::move(value));
        message.set_client_key("test");
        return message.SerializeAsString();
    };
    for (const std::string& bytes : {std::string{"no message"}, std::string{}, request("food_health", -1.0),
                                     request("no_such_parameter", 1u), request("population_size", 4'000'000u)}) {
        const base::Refusal refused = refused_with(bytes);
        EXPECT_EQ(refused.code, base::RefusalCode::DataLoss);
        EXPECT_THAT(refused.message, HasSubstr("entry 2 of its journal"));
    }
    EXPECT_THAT(refused_with(request("food_health", 7.0), 241).message, HasSubstr("entry 3 of its journal"));
}

TEST_F(VerifyTest, TheFirstOfManyDifferencesIsReported) {
    record();
    for (const std::uint64_t generation : {2, 3, 4}) {
        GenerationEnded ended = **file()->generations().outcome_of(generation);
        ended.outcomes[0].fitness[0] += 1;
        write(ended);
    }
    HashRecord link = (*file()->hashes(180, 240)).at(0);
    link.hash.low += 1;
    write(link);
    expect_difference(2, 240, "the state hash", 180);
}

TEST_F(VerifyTest, DamageIsNamed) {
    record();
    change(data.file_of("w"), "UPDATE outcome SET fitness = zeroblob(96) WHERE generation = 4 AND island = 1");
    const auto result = verified(two_threads);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, base::RefusalCode::DataLoss);
    EXPECT_THAT(result.error().message, HasSubstr("the outcome of generation 4"));
}

TEST_F(VerifyTest, ARunOfAnotherModelIsNotSimulated) {
    RunIdentity identity{.name = "old", .run_id = {}, .seed = {}, .parameters = {}};
    identity.model_version = simulation::model_version + 1;
    const auto made = *RunFile::create(folder.path() + "/old.evod", identity, {});
    const auto result = verify(*made, one_thread, [](const VerifyProgress&) {});
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, base::RefusalCode::FailedPrecondition);
}

TEST_F(VerifyTest, ARunThatHasNotBegunAgrees) {
    const auto made =
        *RunFile::create(folder.path() + "/new.evod", {.name = "new", .run_id = {}, .seed = {}, .parameters = {}}, {});
    const auto result = verify(*made, one_thread, [](const VerifyProgress&) {});
    ASSERT_TRUE(result) << to_text(result.error());
    EXPECT_FALSE(result->difference);
    EXPECT_EQ(result->generations, 0u);
}

TEST_F(VerifyTest, ProgressCountsEveryTick) {
    record();
    std::atomic<std::uint64_t> most = 0;
    const auto result = verify(*file(), two_threads, [&](const VerifyProgress& now) {
        EXPECT_EQ(now.ticks_in_all, now.ticks == 0 ? 0u : 540u) << "known when all is read";
        for (std::uint64_t seen = most; seen < now.ticks && !most.compare_exchange_weak(seen, now.ticks);) {
        }
    });
    ASSERT_TRUE(result);
    EXPECT_EQ(most, 540u);
}

TEST_F(VerifyTest, AServerMayWriteMeanwhile) {
    StorageThread thread{{}};
    RecordedRun run{data, thread};
    run.advance(400);
    while (!thread.idle()) {
    }
    const auto reading = *RunFile::open_read_only(data.file_of("w"));
    std::uint64_t in_all = 0;
    const auto result = verify(*reading, one_thread, [&](const VerifyProgress& now) {
        if (std::exchange(in_all, now.ticks_in_all) != 0) {
            return;
        }
        run.advance(300);
        while (!thread.idle()) {
        }
    });
    ASSERT_TRUE(result) << to_text(result.error());
    EXPECT_FALSE(result->difference);
    EXPECT_GE(result->ticks, 361u);
    EXPECT_LE(result->ticks, 400u);
}

} // namespace
} // namespace evod::replay
