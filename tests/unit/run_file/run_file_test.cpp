#include "server/run_file/run_file.h"

#include "server/replay/verify.h"
#include "server/run_file/check.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace evod::run_file {
namespace {

using namespace recording;
using namespace replay;

using base::RefusalCode;
using testing::HasSubstr;

std::string content_of(const std::string& path) {
    std::ifstream file{path, std::ios::binary};
    std::ostringstream bytes;
    bytes << file.rdbuf();
    return bytes.str();
}

void put(const std::string& path, std::string_view bytes) {
    std::ofstream{path, std::ios::binary}.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

class RunFileTest : public testing::Test {
  protected:
    /// The file of a run of four generations and a half with changes, closed.
    std::string recorded() {
        auto data = DataFolder::open(folder.path());
        StorageThread thread{{}};
        RecordedRun run{*data, thread};
        run.advance(130);
        run.command(set_parameter("mutation_chance", 0.5));
        run.advance(200);
        run.checkpoint();
        run.advance(210);
        run.command(set_parameter("food_health", 7.0));
        run.recorder().close_all(run.laboratory());
        return data->file_of("w");
    }

    TemporaryFolder folder;
};

TEST_F(RunFileTest, AddedTriggersAndViewsAreRefused) {
    const std::string path = recorded(), sound = content_of(path);
    const std::string endless = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT ";
    const std::pair<const char*, std::string> additions[] = {
        {"trigger \"forget\"",
         "CREATE TRIGGER forget AFTER INSERT ON journal BEGIN DELETE FROM journal WHERE number = new.number; END"},
        {"trigger \"ignore\"", "CREATE TRIGGER ignore BEFORE INSERT ON journal BEGIN SELECT raise(IGNORE); END"},
        {"view \"founders\"", "DROP TABLE founders; CREATE VIEW founders AS " + endless +
                                  "i AS generation, i AS island, x'' AS founders, i AS checksum FROM n"},
        {"view \"run\"",
         "DROP TABLE run; CREATE VIEW run AS " + endless + "i AS key, i AS value, i AS checksum FROM n"},
        {"view \"other\"", "CREATE VIEW other AS SELECT 1"},
        {"index \"quick\"", "CREATE INDEX quick ON journal (tick)"},
        {"table \"songs\"", "CREATE TABLE songs (title TEXT)"},
        {"table \"thinned\"", "DROP TABLE thinned; CREATE TABLE thinned (number INTEGER PRIMARY KEY, keep_every, "
                              "until_generation, until_tick, checksum AS (number))"}};
    for (const auto& [name, sql] : additions) {
        put(path, sound);
        change(path, sql);
        for (const auto& refused : {RunFile::open_read_only(path), RunFile::open(path, {})}) {
            ASSERT_FALSE(refused) << sql;
            EXPECT_EQ(refused.error().code, RefusalCode::DataLoss);
            EXPECT_THAT(refused.error().message, HasSubstr(path));
            EXPECT_THAT(refused.error().message, HasSubstr(name));
        }
    }
}

TEST_F(RunFileTest, AMissingTableIsNamed) {
    const std::string path = recorded();
    change(path, "DROP TABLE outcome");
    const auto refused = RunFile::open_read_only(path);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, RefusalCode::DataLoss);
    EXPECT_THAT(refused.error().message, HasSubstr("it lacks the table \"outcome\""));
}

TEST_F(RunFileTest, ReadsBackEverythingThatWasWritten) {
    const RunIdentity identity{.name = "w",
                               .run_id = {0x0123456789abcdef, 0xfedcba9876543210},
                               .seed = {~std::uint64_t{0}},
                               .parameters = small_world(),
                               .began_unix_ms = 1234};
    base::InlineExecutor executor;
    simulation::World world{identity.parameters, identity.seed};
    const GenerationBegun begun{world.opening(), {world.islands()[0].born(), world.islands()[1].born()}};
    while (!world.generation_over()) {
        world.advance_tick(executor);
    }
    const GenerationEnded ended{1,
                                {{world.outcomes()[0].fitness, world.islands()[0].life_records().lived_ticks,
                                  world.islands()[0].life_records().cause},
                                 {world.outcomes()[1].fitness, world.islands()[1].life_records().lived_ticks,
                                  world.islands()[1].life_records().cause}},
                                world.history().back()};
    world.breed_next_generation(executor);
    const GenerationBegun second{world.opening(), {world.islands()[0].born(), world.islands()[1].born()}};
    const JournalEntry entry{
        .number = 1,
        .tick = 17,
        .origin = {base::client_actor("ä", "a: b\n client:", "::1:5000"), "key", ~std::uint64_t{0},
                   std::string("\0\1\2", 3)},
        .answer = std::string("\0\xff", 2),
        .control = {
            .endless = true, .until_generation = 3, .until_tick = std::nullopt, .paused = true, .speed = std::nullopt}};
    const std::string path = folder.path() + "/run.evod";
    {
        const auto file = RunFile::create(path, identity, {});
        ASSERT_TRUE(file) << to_text(file.error());
        (*file)->begin();
        (*file)->write(begun);
        (*file)->write(entry);
        (*file)->write(HashRecord{60, {1, ~std::uint64_t{0}}});
        (*file)->write(ended);
        (*file)->write(second);
        ASSERT_TRUE((*file)->commit());
    }
    const auto file = RunFile::open_read_only(path);
    ASSERT_TRUE(file) << to_text(file.error());
    EXPECT_EQ((*file)->identity().name, "w");
    EXPECT_EQ((*file)->identity().run_id, identity.run_id);
    EXPECT_EQ((*file)->identity().seed.value, identity.seed.value);
    EXPECT_TRUE((*file)->identity().parameters == identity.parameters);
    EXPECT_EQ((*file)->identity().began_unix_ms, 1234);
    EXPECT_EQ((*file)->identity().build, build_text());
    EXPECT_THAT(build_text(), HasSubstr(" for ")); // this processor
    EXPECT_FALSE(*(*file)->end_mark());

    const auto journal = *(*file)->journal().read();
    ASSERT_EQ(journal.size(), 1u);
    EXPECT_EQ(journal[0].tick, entry.tick);
    EXPECT_EQ(journal[0].origin.by, entry.origin.by);
    EXPECT_EQ(journal[0].origin.request_id, entry.origin.request_id);
    EXPECT_EQ(journal[0].origin.request, entry.origin.request);
    EXPECT_EQ(journal[0].answer, entry.answer);
    EXPECT_EQ(journal[0].control.until_generation, 3u);
    EXPECT_FALSE(journal[0].control.until_tick);
    EXPECT_FALSE(journal[0].control.speed);
    EXPECT_TRUE(journal[0].control.endless && journal[0].control.paused);

    for (const auto& [generation, expected] : {std::pair{1u, &begun}, {2u, &second}}) {
        const auto read = *(*file)->generations().beginning_of(generation);
        ASSERT_TRUE(read);
        EXPECT_EQ(read->opening.moment.tick, expected->opening.moment.tick);
        EXPECT_EQ(read->opening.moment.simulated_s, expected->opening.moment.simulated_s);
        EXPECT_EQ(read->opening.progress, expected->opening.progress);
        EXPECT_TRUE(read->opening.parameters.active == expected->opening.parameters.active);
        ASSERT_EQ(read->born.size(), 2u);
        for (std::size_t island = 0; island < 2; ++island) {
            EXPECT_TRUE((read->born[island].genes == expected->born[island].genes).all());
            EXPECT_EQ(read->born[island].parents, expected->born[island].parents);
            EXPECT_EQ(read->born[island].elite_count, expected->born[island].elite_count);
            EXPECT_EQ(read->born[island].survivor_count, expected->born[island].survivor_count);
            EXPECT_EQ(read->born[island].clamped_count, expected->born[island].clamped_count);
        }
    }
    const auto outcome = *(*file)->generations().outcome_of(1);
    ASSERT_TRUE(outcome);
    EXPECT_EQ(outcome->outcomes, ended.outcomes);
    ASSERT_EQ(outcome->statistics.size(), 2u);
    EXPECT_EQ(outcome->statistics[1].fitness_median, ended.statistics[1].fitness_median);
    EXPECT_FALSE(*(*file)->generations().outcome_of(2));
    EXPECT_FALSE(*(*file)->generations().beginning_of(3));
    EXPECT_EQ((*(*file)->hashes(0, 60))[0].hash.high, ~std::uint64_t{0});
    EXPECT_EQ((*(*file)->generations().history(10, 10)).size(), 1u);
    EXPECT_EQ((*file)->contents().tick, 121u); // a generation is recorded after its first tick
}

TEST_F(RunFileTest, AWrittenRunIsSound) {
    const auto file = RunFile::open_read_only(recorded());
    ASSERT_TRUE(file) << to_text(file.error());
    const auto checked = check(**file);
    ASSERT_TRUE(checked) << to_text(checked.error());
    const auto mark = *(*file)->end_mark();
    ASSERT_TRUE(mark);
    EXPECT_FALSE(mark->ended);
    EXPECT_EQ(mark->tick, 540u);
    EXPECT_EQ(mark->journal_entries, 2u);
    EXPECT_EQ(mark->generations, 5u);
    EXPECT_EQ(mark->hashes, 9u);
}

TEST_F(RunFileTest, ADamagedTableIsNamed) {
    const std::string path = recorded(), sound = content_of(path);
    for (const auto& [sql, named] : {
             std::pair{"UPDATE run SET value = '8' WHERE key = 'seed'", "seed"},
             {"DELETE FROM run WHERE key = 'parameters'", "table run"},
             {"UPDATE journal SET tick = tick + 1 WHERE number = 2", "journal"},
             {"DELETE FROM journal WHERE number = 1", "journal"},
             {"UPDATE parameters SET revision = revision + 1 WHERE number = 2", "parameters"},
             {"UPDATE generation SET simulated_s = 0 WHERE generation = 3", "row 3 of its table generation"},
             {"DELETE FROM generation WHERE generation = 3", "row 3 of its table generation"},
             {"UPDATE population SET chromosomes = zeroblob(288) WHERE generation = 2", "population of generation 2"},
             {"DELETE FROM population WHERE generation = 2 AND island = 1", "population of generation 2"},
             {"UPDATE outcome SET fitness = zeroblob(96) WHERE generation = 4 AND island = 1",
              "outcome of generation 4"},
             {"DELETE FROM outcome WHERE generation = 2", "outcome of generation 2"},
             {"UPDATE statistics SET alive_count = alive_count + 1 WHERE generation = 2", "statistics of generation 2"},
             {"UPDATE state_hash SET low = low + 1 WHERE tick = 60", "state_hash"},
             {"DELETE FROM state_hash WHERE tick = 120", "state_hash"},
             {"UPDATE end_mark SET tick = 539", "end mark"},
             {"DELETE FROM state_hash WHERE tick = 540", "end mark"},
         }) {
        put(path, sound);
        ASSERT_NO_FATAL_FAILURE(change(path, sql));
        const auto file = RunFile::open_read_only(path);
        const base::Refusal refused = file ? check(**file).error() : file.error();
        EXPECT_EQ(refused.code, RefusalCode::DataLoss) << sql;
        EXPECT_THAT(refused.message, HasSubstr(named)) << sql;
        EXPECT_THAT(refused.message, HasSubstr(path)) << sql;
    }
}

TEST_F(RunFileTest, OtherFilesAreRefused) {
    const std::string path = folder.path() + "/other.evod";
    const auto refused = [&] { return RunFile::open(path, {}).error(); };
    EXPECT_EQ(refused().code, RefusalCode::Unavailable); // not there
    put(path,
        "no database, but longer than the head of one, which is a hundred bytes and begins with a text of its own");
    EXPECT_EQ(refused().code, RefusalCode::DataLoss);
    put(path, "");
    EXPECT_EQ(refused().code, RefusalCode::DataLoss);
    std::filesystem::remove(path);
    {
        Database foreign{path, Database::Mode::Create};
        foreign.run("CREATE TABLE songs (title TEXT)");
    }
    EXPECT_THAT(refused().message, HasSubstr("is not a run file"));
    std::filesystem::remove(path);
}

TEST_F(RunFileTest, TheJournalListsItsClientKeys) {
    const std::string path = folder.path() + "/run.evod";
    const auto file = RunFile::create(path, {.name = "w", .run_id = {}, .seed = {}, .parameters = {}}, {});
    ASSERT_TRUE(file) << to_text(file.error());
    std::uint64_t number = 0;
    (*file)->begin();
    const auto write = [&](const base::Actor& by, const std::string& key, std::uint64_t id) {
        (*file)->write(JournalEntry{
            .number = ++number, .tick = 0, .origin = {by, key, id, "request"}, .answer = {}, .control = {}});
    };
    const base::Actor ada = base::client_actor("ada", "a: b", "10.0.0.1:1"),
                      anyone = base::client_actor("", "a", "::1:2");
    write(ada, "k", 3);
    write(ada, "k", 2);
    write(anyone, "k", 1);
    write(base::server_actor(), "of the server", 1);
    write(ada, "large", ~std::uint64_t{0});
    write(ada, "large", 7);
    write(ada, "k", 9);
    ASSERT_TRUE((*file)->commit());

    const auto listed = [&](std::uint64_t last, std::size_t keys_max) {
        std::string text;
        for (const UsedKey& key : *(*file)->journal().used_keys(last, keys_max)) {
            const bool is_client = key.by.kind == base::Actor::Kind::Client;
            text += (is_client ? key.by.user + "/" : "server/") + key.by.address + "/" + key.client_key + "/" +
                    std::to_string(key.highest_id) + " ";
        }
        return text;
    };
    EXPECT_EQ(listed(6, 9), "ada//k/3 /::1:2/k/1 server//of the server/1 ada//large/18446744073709551615 ");
    EXPECT_EQ(listed(7, 2), "ada//large/18446744073709551615 ada//k/9 ") << "the two used last";
    EXPECT_EQ(listed(2, 9), "ada//k/3 ");
    EXPECT_EQ(listed(0, 9), "");
}

TEST_F(RunFileTest, OtherFormatsAreRefused) {
    const std::string path = recorded();
    change(path, "PRAGMA user_version = 6");
    EXPECT_THAT(RunFile::open(path, {}).error().message, HasSubstr("a newer evod: its format is version 6"));
    change(path, "PRAGMA user_version = 4");
    const base::Refusal older = RunFile::open_read_only(path).error();
    EXPECT_THAT(older.message, HasSubstr("an older evod: its format is version 4, this evod reads version 5"));
    EXPECT_EQ(older.code, RefusalCode::FailedPrecondition);
}

/// Recorded by evod 0.2.0 before its tables were declared in rows.h, in format 4: a fork within generation 3 that ran
/// to generation 7. Only the table of the journal and its rows were written again for format 5.
TEST_F(RunFileTest, AStoredFileOfFormat5IsReadAndContinued) {
    const std::string path = folder.path() + "/stored.evod";
    std::filesystem::copy_file(std::filesystem::path{EVOD_SOURCE_FOLDER} / "tests/unit/run_file/format_5.evod", path);
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    {
        const auto file = RunFile::open_read_only(path);
        ASSERT_TRUE(file) << to_text(file.error());
        const auto checked = check(**file);
        EXPECT_TRUE(checked) << to_text(checked.error());
        EXPECT_EQ((*file)->identity().first_tick, 290u);
        EXPECT_EQ((*file)->journal().read()->size(), 7u);
        EXPECT_EQ((*file)->checkpoints().read(0, 1000)->size(), 1u);
        EXPECT_EQ((*file)->generations().history(7, 100)->size(), 6u);
        base::InlineExecutor executor;
        if (!(*file)->other_model()) {
            const auto verified = replay::verify(**file, executor, [](const replay::VerifyProgress&) {});
            ASSERT_TRUE(verified) << to_text(verified.error());
            EXPECT_FALSE(verified->difference);
        }
    }
    const auto file = RunFile::open(path, {});
    ASSERT_TRUE(file) << to_text(file.error());
    (*file)->begin();
    (*file)->write(EndMark{.tick = (*file)->last_tick()});
    ASSERT_TRUE((*file)->commit());
    EXPECT_TRUE(check(**file));
}

TEST_F(RunFileTest, ANewFileHasTheSchemaOfAStoredOne) {
    const auto schema_of = [](const std::string& path) {
        Database database{path, Database::Mode::ReadAtRest};
        std::string schema;
        for (Statement rows{database, "SELECT type || name || rootpage || sql FROM sqlite_schema"}; rows.row();) {
            schema += rows.text(0) + "\n";
        }
        return schema;
    };
    const std::string stored =
        (std::filesystem::path{EVOD_SOURCE_FOLDER} / "tests/unit/run_file/format_5.evod").string();
    const std::string path = folder.path() + "/new.evod";
    ASSERT_TRUE(RunFile::create(path, {.name = "w", .run_id = {}, .seed = {}, .parameters = {}}, {}));
    EXPECT_EQ(schema_of(path), schema_of(stored));
}

TEST_F(RunFileTest, AFileMayLackItsBuild) {
    const std::string path = recorded();
    change(path, "DELETE FROM run WHERE key = 'build'");
    const auto file = RunFile::open_read_only(path);
    ASSERT_TRUE(file) << to_text(file.error());
    EXPECT_EQ((*file)->identity().build, "");
}

TEST_F(RunFileTest, AnExistingFileIsNotOverwritten) {
    const std::string path = recorded();
    EXPECT_EQ(RunFile::create(path, {.name = "w", .run_id = {}, .seed = {}, .parameters = {}}, {}).error().code,
              RefusalCode::AlreadyExists);
}

} // namespace
} // namespace evod::run_file
