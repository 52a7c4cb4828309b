#include "server/run_file/data_folder.h"

#include "server/replay/archive.h"
#include "server/replay/stored_run.h"
#include "server/run_file/check.h"
#include "tests/support/waiting.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <iterator>
#include <thread>

namespace evod::run_file {
namespace {

using namespace recording;
using namespace replay;

using testing::HasSubstr;

TEST(DataFolder, ASecondServerIsRefused) {
    TemporaryFolder folder;
    {
        const auto first = DataFolder::open(folder.path() + "/new/folder");
        ASSERT_TRUE(first) << to_text(first.error());
        const auto second = DataFolder::open(folder.path() + "/new/folder");
        ASSERT_FALSE(second);
        EXPECT_THAT(second.error().message, HasSubstr("another server is using it"));
    }
    EXPECT_TRUE(DataFolder::open(folder.path() + "/new/folder"));
}

TEST(DataFolder, AnImpossibleFolderIsRefused) {
    TemporaryFolder folder;
    std::ofstream{folder.path() + "/file"} << "text";
    EXPECT_THAT(DataFolder::open(folder.path() + "/file").error().message, HasSubstr(folder.path() + "/file"));
}

TEST(DataFolder, DistinguishesLiveRunsFromEndedOnes) {
    TemporaryFolder folder;
    const auto data = DataFolder::open(folder.path());
    const std::string ended = data->ended_file_of("b", {0xabc, 1});
    for (const std::string& path : {data->file_of("b"), data->file_of("a"), ended, folder.path() + "/notes.txt",
                                    folder.path() + "/no name.evod", data->file_of("a") + "-wal"}) {
        std::ofstream{path} << "text";
    }
    const auto files = data->files();
    ASSERT_TRUE(files);
    EXPECT_THAT(files->of_worlds, testing::ElementsAre(data->file_of("a"), data->file_of("b")));
    EXPECT_THAT(files->ended, testing::ElementsAre(ended));
    EXPECT_THAT(files->strange, testing::ElementsAre(folder.path() + "/no name.evod"));
}

class ArchiveTest : public testing::Test {
  protected:
    void record(std::uint64_t ticks) {
        auto data = DataFolder::open(folder.path());
        StorageThread thread{{}};
        RecordedRun run{*data, thread};
        run.command(set_parameter("food_health", 2.0));
        run.advance(ticks);
        hash = run.world().hash();
        run.recorder().close_all(run.laboratory());
    }
    auto open() { return Archive::open(folder.path(), {}, executor); }
    /// Opens the folder and returns why its world is damaged; an empty text if no world is.
    std::string reason() {
        const auto archive = open();
        EXPECT_TRUE(archive) << to_text(archive.error());
        const simulation::Laboratory laboratory = (*archive)->take_laboratory();
        return laboratory.damaged().empty() ? "" : laboratory.damaged().front().reason;
    }
    /// Expects that the file that `make` creates is refused, with these words after its path, and this remedy.
    void expect_damaged(const std::string& why, const std::string& remedy, const std::function<void()>& make) {
        const std::string path = folder.path() + "/w.evod";
        std::filesystem::remove(path);
        make();
        const std::string said = reason();
        EXPECT_THAT(said, testing::StartsWith(path + why));
        EXPECT_THAT(said, HasSubstr(remedy));
        EXPECT_THAT(said, testing::EndsWith("; deleting the world moves the file away"));
    }

    TemporaryFolder folder;
    base::InlineExecutor executor;
    base::StateHash hash;
};

TEST_F(ArchiveTest, RecoversAWorldAndContinuesItsFile) {
    record(100);
    for (const std::uint64_t tick : {100u, 190u, 280u}) { // the last moment of each time
        const auto archive = open();
        ASSERT_TRUE(archive) << to_text(archive.error());
        EXPECT_EQ((*archive)->take_answers().at(0).answer, "answer 1");
        simulation::Laboratory laboratory = (*archive)->take_laboratory();
        simulation::Entry& entry = **laboratory.find("w");
        EXPECT_EQ(entry.run_id, (simulation::RunId{1, 2}));
        EXPECT_EQ(entry.world.moment().tick, tick);
        EXPECT_EQ(entry.world.hash(), hash);
        for (int i = 0; i < 90; ++i) {
            laboratory.advance(entry, executor);
            (*archive)->recorder().of("w")->follow(entry.world);
        }
        hash = entry.world.hash();
        (*archive)->recorder().close_all(laboratory);
        (*archive)->close();
        const auto file = RunFile::open_read_only(folder.path() + "/w.evod");
        const auto checked = check(**file);
        EXPECT_TRUE(checked) << to_text(checked.error());
    }
}

TEST_F(ArchiveTest, ADamagedFileStopsItsWorldAlone) {
    record(200);
    std::filesystem::copy_file(folder.path() + "/w.evod", folder.path() + "/sound.evod");
    {
        Database database{folder.path() + "/w.evod", Database::Mode::Write};
        database.run("UPDATE journal SET tick = 1");
    }
    const auto archive = open();
    ASSERT_TRUE(archive) << to_text(archive.error());
    EXPECT_THAT((*archive)->world_names(), testing::ElementsAre("sound", "w"));
    EXPECT_TRUE((*archive)->is_damaged("w"));
    EXPECT_FALSE((*archive)->is_damaged("sound"));
    EXPECT_EQ((*archive)->identity_of("w"), nullptr);
    const simulation::Laboratory laboratory = (*archive)->take_laboratory();
    EXPECT_TRUE(laboratory.find("sound"));
    ASSERT_EQ(laboratory.damaged().size(), 1u);
    const simulation::DamagedWorld& world = laboratory.damaged().front();
    EXPECT_EQ(world.name, "w");
    EXPECT_EQ(world.run_id, (simulation::RunId{1, 2}));
    EXPECT_THAT(world.reason, HasSubstr("w.evod is damaged: the row 1 of its table journal"));
    EXPECT_THAT(world.reason, HasSubstr("restore a copy"));
}

TEST_F(ArchiveTest, ADamagedFileIsNotWritten) {
    record(200);
    const std::string path = folder.path() + "/w.evod";
    Database killed{path, Database::Mode::Write}; // keeps the log, as a killed server does
    killed.run("UPDATE journal SET tick = 1");
    ASSERT_GT(std::filesystem::file_size(path + "-wal"), 0u);
    std::filesystem::create_directory(folder.path() + "/data");
    for (const char* suffix : {"", "-wal"}) {
        std::filesystem::copy_file(path + suffix, folder.path() + "/data/w.evod" + suffix);
    }
    const auto bytes_of = [](const std::string& file) {
        std::ifstream stream{file, std::ios::binary};
        return std::string{std::istreambuf_iterator<char>{stream}, {}};
    };
    {
        const auto archive = Archive::open(folder.path() + "/data", {}, executor);
        ASSERT_TRUE(archive) << to_text(archive.error());
        EXPECT_TRUE((*archive)->is_damaged("w"));
    }
    for (const char* suffix : {"", "-wal"}) {
        EXPECT_EQ(bytes_of(folder.path() + "/data/w.evod" + suffix), bytes_of(path + suffix)) << suffix;
    }
}

TEST_F(ArchiveTest, AForeignFileIsDamagedWithARemedy) {
    const std::string path = folder.path() + "/w.evod";
    expect_damaged(" is damaged or is not a run file: ", "evod verify",
                   [&] { std::ofstream{path} << std::string(5000, 'x'); });
    expect_damaged(" is not a run file of evod; deleting the world moves the file away", "", [&] {
        Database{path, Database::Mode::Create}.run("CREATE TABLE songs (title TEXT)");
    });
    expect_damaged(" was written by a newer evod", "start the version of evod that wrote the file", [&] {
        record(10);
        Database{path, Database::Mode::Write}.run("PRAGMA user_version = 9");
    });
    expect_damaged(" was created by evod 0.0.1", "evod export", [&] {
        ASSERT_TRUE(RunFile::create(
            path,
            {.name = "w", .run_id = {}, .seed = {}, .parameters = {}, .evod_version = "0.0.1", .model_version = 1},
            {}));
    });
    expect_damaged(": this is a folder, not a run file", "", [&] { std::filesystem::create_directory(path); });
    expect_damaged(" is damaged: the file is empty", "restore a copy", [&] { std::ofstream{path}; });
}

TEST_F(ArchiveTest, ADamagedWorldIsMovedAsideWithItsFiles) {
    record(10);
    std::ofstream{folder.path() + "/w.damaged-1.evod"} << "of an earlier time";
    std::ofstream{folder.path() + "/w.evod-wal"} << "log";
    std::ofstream{folder.path() + "/w.evod-next"} << "next";
    const auto data = DataFolder::open(folder.path());
    ASSERT_TRUE(data->move_aside("w"));
    ASSERT_TRUE(data->move_aside("w")) << "there is nothing left to move";
    std::vector<std::string> names;
    for (const auto& file : std::filesystem::directory_iterator{folder.path()}) {
        names.push_back(file.path().filename());
    }
    EXPECT_THAT(names, testing::UnorderedElementsAre("lock", "w.damaged-1.evod", "w.damaged-2.evod",
                                                     "w.damaged-2.evod-wal", "w.damaged-2.evod-next"));
    const auto files = data->files();
    EXPECT_TRUE(files->of_worlds.empty() && files->ended.empty() && files->replaced.empty() && files->strange.empty());
}

TEST_F(ArchiveTest, AFileWithTwoNamesIsDamagedUnderBoth) {
    namespace fs = std::filesystem;
    record(60);
    const std::string path = folder.path() + "/w.evod", elsewhere = folder.path() + "/elsewhere.of";
    fs::create_hard_link(path, elsewhere);
    EXPECT_THAT(reason(), HasSubstr(path + " has a second name, a hard link"));
    fs::remove(path);
    fs::create_symlink(elsewhere, path);
    EXPECT_THAT(reason(), HasSubstr(path + " is a symbolic link"));
    EXPECT_TRUE(RunFile::open_read_only(path)) << "it may be read";
    fs::remove(path);
    fs::rename(elsewhere, path);
    EXPECT_EQ(reason(), "");
}

TEST_F(ArchiveTest, AFileThatLostItsFirstStatisticsIsNamed) {
    record(400);
    Database database{folder.path() + "/w.evod", Database::Mode::Write};
    ASSERT_GT(database.number("SELECT count(*) FROM statistics"), 1);
    database.run("DELETE FROM statistics WHERE generation = 1");
    EXPECT_THAT(reason(), HasSubstr("is damaged: the row 1 of its table statistics"));
}

TEST_F(ArchiveTest, AReplayReportsAFileThatLostItsEnd) {
    record(400);
    const std::string path = folder.path() + "/w.evod";
    ASSERT_TRUE(StoredRun::of_file(path));
    Database{path, Database::Mode::Write}.run(
        "DELETE FROM generation WHERE generation = (SELECT max(generation) FROM generation)");
    EXPECT_THAT(StoredRun::of_file(path).error().message, HasSubstr("end mark"));
}

TEST_F(ArchiveTest, AnUnfinishedNewFileIsDeleted) {
    const std::string next = DataFolder::next_file_of(folder.path() + "/w.evod");
    { // as it is before the first commit
        const auto begun = RunFile::begin_new(next, {.name = "w", .run_id = {}, .seed = {}, .parameters = {}}, {});
        ASSERT_TRUE(begun);
        std::filesystem::copy_file(next, folder.path() + "/begun.evod-next");
    }
    for (const char* name : {"empty", "byte"}) {
        std::ofstream{folder.path() + "/" + name + ".evod-next"} << (name == std::string{"byte"} ? "x" : "");
    }
    const auto archive = open();
    ASSERT_TRUE(archive) << to_text(archive.error());
    EXPECT_TRUE((*archive)->world_names().empty());
    EXPECT_EQ((*archive)->identity_of("w"), nullptr);
    for (const auto& file : std::filesystem::directory_iterator{folder.path()}) {
        EXPECT_EQ(file.path().filename(), "lock");
    }
}

TEST_F(ArchiveTest, ATakenNameLeavesNoPartOfANewWorld) {
    const std::string path = folder.path() + "/w.evod";
    std::ofstream{path};
    EXPECT_EQ(RunFile::create(path, {.name = "w", .run_id = {}, .seed = {}, .parameters = {}}, {}).error().code,
              base::RefusalCode::AlreadyExists);
    EXPECT_EQ(std::filesystem::file_size(path), 0u);
    {
        auto data = DataFolder::open(folder.path());
        StorageThread thread{{}, std::chrono::hours{1}};
        const RecordedRun run{*data, thread};
        ASSERT_TRUE(wait_until([&] { return !thread.disk().faults().empty(); }));
        EXPECT_THAT(thread.disk().faults().begin()->second.why.message, HasSubstr(path + " exists already"));
    }
    EXPECT_EQ(std::filesystem::file_size(path), 0u);
}

TEST_F(ArchiveTest, AFileOfAnEndedRunIsRenamed) {
    record(100);
    {
        const auto file = RunFile::open(folder.path() + "/w.evod", {});
        (*file)->begin();
        EndMark mark = (*file)->contents();
        mark.ended = true;
        (*file)->write(mark);
        ASSERT_TRUE((*file)->commit());
    }
    const auto archive = open();
    ASSERT_TRUE(archive) << to_text(archive.error());
    EXPECT_TRUE((*archive)->world_names().empty());
    EXPECT_TRUE(std::filesystem::exists(folder.path() + "/w." + to_text(simulation::RunId{1, 2}) + ".evod"));
    const auto answers = (*archive)->take_answers();
    ASSERT_EQ(answers.size(), 1u) << "its commands are not carried out again";
    EXPECT_EQ(answers[0].answer, "answer 1");
}

TEST_F(ArchiveTest, TheAnswersOfAResetRunAreKept) {
    {
        auto data = DataFolder::open(folder.path());
        StorageThread thread{{}};
        RecordedRun run{*data, thread};
        for (std::uint64_t reset = 1; reset <= 3; ++reset) {
            run.command(set_parameter("food_health", 2.0));
            run.command(set_parameter("food_health", 3.0));
            run.reset({9}, {3, reset});
        }
        run.recorder().close_all(run.laboratory());
    }
    const auto archive = open();
    ASSERT_TRUE(archive) << to_text(archive.error());
    std::vector<std::uint64_t> remembered;
    for (const JournalEntry& entry : (*archive)->take_answers()) {
        remembered.push_back(entry.origin.request_id);
    }
    EXPECT_THAT(remembered, testing::UnorderedElementsAre(1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u, 9u));
    EXPECT_EQ(remembered.back(), 9u); // of the run that continues
}

TEST_F(ArchiveTest, TheKeysOfOldCommandsAreKept) {
    {
        auto data = DataFolder::open(folder.path());
        StorageThread thread{{}};
        RecordedRun run{*data, thread};
        for (std::uint32_t i = 0; i < Archive::answers_kept_of_ended + 4; ++i) {
            run.command(set_parameter("food_health", 2.0 + i % 2));
        }
        run.reset({9}, {3, 1});
        run.recorder().close_all(run.laboratory());
    }
    const auto archive = open();
    ASSERT_TRUE(archive) << to_text(archive.error());
    const auto answers = (*archive)->take_answers();
    const auto keys = (*archive)->take_used_keys();
    ASSERT_GE(answers.size(), Archive::answers_kept_of_ended);
    ASSERT_EQ(keys.size(), 1u);
    EXPECT_EQ(keys[0].by.user, "alice");
    EXPECT_EQ(keys[0].client_key, "test");
    EXPECT_EQ(keys[0].highest_id + 1, answers[0].origin.request_id);
}

TEST_F(ArchiveTest, TheKeysOfADamagedWorldAreKept) {
    record(200);
    change(folder.path() + "/w.evod", "UPDATE population SET chromosomes = x'00'");
    const auto archive = open();
    ASSERT_TRUE(archive) << to_text(archive.error());
    ASSERT_TRUE((*archive)->is_damaged("w"));
    EXPECT_TRUE((*archive)->take_answers().empty());
    const auto keys = (*archive)->take_used_keys();
    ASSERT_EQ(keys.size(), 1u);
    EXPECT_EQ(keys[0].highest_id, 1u);
}

/// The files of a reset world, as a crash can leave them.
class Replacing : public ArchiveTest {
  protected:
    Replacing() : path{folder.path() + "/w.evod"}, next{DataFolder::next_file_of(path)} {
        auto data = DataFolder::open(folder.path());
        StorageThread thread{{}};
        RecordedRun run{*data, thread};
        run.advance(60); // the last tick before its end mark
        old_hash = run.world().hash();
        run.reset({9}, {3, 4});
        run.advance(50);
        hash = run.world().hash();
        ended = data->ended_file_of("w", {1, 2});
        run.recorder().close_all(run.laboratory());
    }
    void expect_world(const base::StateHash& as) {
        const auto archive = open();
        ASSERT_TRUE(archive) << to_text(archive.error());
        const simulation::Laboratory laboratory = (*archive)->take_laboratory();
        ASSERT_EQ(laboratory.entries().size(), 1u);
        EXPECT_EQ(laboratory.entries()[0]->world.hash(), as);
        EXPECT_FALSE(std::filesystem::exists(next));
    }
    std::string path, next, ended;
    base::StateHash old_hash;
};

TEST_F(Replacing, TheReplacementIsComplete) {
    expect_world(hash);
    EXPECT_TRUE(std::filesystem::exists(ended));
}

TEST_F(Replacing, TheNewRunHasNoNameYet) {
    std::filesystem::rename(path, next);
    expect_world(hash);
    EXPECT_TRUE(std::filesystem::exists(ended));
}

TEST_F(Replacing, TheOldRunHasAnEndMarkAndStillItsName) {
    std::filesystem::rename(path, next);
    std::filesystem::rename(ended, path);
    expect_world(hash);
    EXPECT_TRUE(std::filesystem::exists(ended));
}

TEST_F(Replacing, TheOldRunContinuesWithoutAnEndMark) {
    std::filesystem::rename(path, next);
    std::filesystem::rename(ended, path);
    {
        Database database{path, Database::Mode::Write};
        database.run("DELETE FROM end_mark");
    }
    expect_world(old_hash);
    EXPECT_FALSE(std::filesystem::exists(ended));
}

TEST_F(Replacing, AnIncompleteNewRunIsDeleted) {
    std::filesystem::remove(path);
    std::filesystem::rename(ended, path);
    {
        Database database{path, Database::Mode::Write};
        database.run("DELETE FROM end_mark");
    }
    std::ofstream{next} << "half a file";
    expect_world(old_hash);
}

} // namespace
} // namespace evod::run_file
