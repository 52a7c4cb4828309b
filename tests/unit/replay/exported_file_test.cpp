#include "server/replay/exported_file.h"

#include "server/base/inline_executor.h"
#include "server/replay/run_tables.h"
#include "server/replay/verify.h"
#include "server/run_file/check.h"
#include "tests/support/waiting.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

namespace evod::replay {
namespace {

using namespace recording;
using testing::HasSubstr;
using testing::Not;

/// A run of three generations with two commands, of which the server is still writing.
class ExportedFileTest : public testing::Test {
  protected:
    ExportedFileTest() {
        run.advance(50);
        run.command(set_parameter("mutation_chance", 0.5));
        while (run.world().moment().generation <= 3) {
            run.advance(1);
        }
        run.command(set_parameter("mutation_chance", 0.25));
        run.once_written();
        run.receipt();
        file = *RunFile::open_read_only(data.file_of("w"));
        EXPECT_TRUE(file->pin_snapshot());
    }
    std::string bytes(bool only_users) {
        std::ostringstream out;
        const auto written = write_exported_file(*file, only_users, {}, out);
        EXPECT_TRUE(written) << to_text(written.error());
        return out.str();
    }
    /// Opens the exported file under a name of its own.
    std::unique_ptr<RunFile> opened(bool only_users) {
        std::ofstream{copy_path, std::ios::binary} << bytes(only_users);
        auto opened = RunFile::open_checked(copy_path);
        EXPECT_TRUE(opened) << to_text(opened.error());
        return *std::move(opened);
    }
    /// Names of files in the folder that are copies.
    int copies() const {
        int count = 0;
        for (const auto& there : std::filesystem::directory_iterator{folder.path()}) {
            count += there.path().filename().string().find(DataFolder::copy_mark) != std::string::npos;
        }
        return count;
    }

    TemporaryFolder folder, other;
    DataFolder data{*DataFolder::open(folder.path())};
    StorageThread thread{RunFile::Options{}};
    RecordedRun run{data, thread};
    base::InlineExecutor executor;
    std::unique_ptr<RunFile> file;
    const std::string copy_path = other.path() + "/copy.evod";
};

TEST_F(ExportedFileTest, TheCopyIsSoundAndCanBeSimulatedAgain) {
    const auto copy = opened(true);
    const auto verified = verify(*copy, executor, [](const VerifyProgress&) {});
    ASSERT_TRUE(verified) << to_text(verified.error());
    EXPECT_FALSE(verified->difference);
    EXPECT_EQ(copy->last_tick(), file->last_tick());
    const auto sound = run_file::check(*copy);
    EXPECT_TRUE(sound) << to_text(sound.error());
    for (const RunTable table : {RunTable::Organisms, RunTable::Generations}) {
        std::ostringstream expected, found;
        EXPECT_TRUE(write_table({*file, executor}, {.table = table}, expected));
        EXPECT_TRUE(write_table({*copy, executor}, {.table = table}, found));
        EXPECT_EQ(found.str(), expected.str());
    }
}

TEST_F(ExportedFileTest, NoByteNamesTheKeysOrForUsersTheAddresses) {
    for (const bool only_users : {false, true}) {
        const auto entries = opened(only_users)->journal().read();
        ASSERT_TRUE(entries);
        ASSERT_EQ(entries->size(), 2u);
        for (const run_file::JournalEntry& entry : *entries) {
            EXPECT_EQ(entry.origin.by.user, "alice");
            EXPECT_EQ(entry.origin.by.address, only_users ? "" : "127.0.0.1:5000");
            EXPECT_EQ(entry.origin.client_key, "exported");
            EXPECT_EQ(entry.answer, "");
        }
        EXPECT_THAT(bytes(only_users), Not(HasSubstr("answer 1")));
    }
    EXPECT_THAT(bytes(true), Not(HasSubstr("127.0.0.1")));
}

TEST_F(ExportedFileTest, NoCopyStays) {
    EXPECT_FALSE(bytes(true).empty());
    EXPECT_EQ(copies(), 0);
    for (int allowed = 0; allowed < 6; ++allowed) {
        int asked = 0;
        std::ostringstream out;
        (void)write_exported_file(*file, true, base::StopCheck{[&] { return ++asked > allowed; }}, out);
        EXPECT_EQ(copies(), 0) << allowed;
    }
    std::ostringstream full;
    full.setstate(std::ios::badbit); // the client is gone
    EXPECT_TRUE(write_exported_file(*file, true, {}, full));
    EXPECT_EQ(copies(), 0);
}

TEST_F(ExportedFileTest, AStoppedCopyIsNotWritten) {
    std::ostringstream out;
    const auto written = write_exported_file(*file, true, base::StopCheck{[] { return true; }}, out);
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, base::RefusalCode::Unavailable);
    EXPECT_EQ(out.str(), "");
}

TEST(DataFolder, OpeningDeletesCopiesOfAKilledServer) {
    TemporaryFolder folder;
    for (const char* name : {"w.evod.copy-a1B2c3", "w.evod.copy-a1B2c3-journal", "w.evod", "w.copy-1.evod"}) {
        std::ofstream{folder.path() + "/" + name} << "text";
    }
    ASSERT_TRUE(DataFolder::open(folder.path()));
    std::set<std::string> left;
    for (const auto& there : std::filesystem::directory_iterator{folder.path()}) {
        left.insert(there.path().filename().string());
    }
    EXPECT_THAT(left, testing::ElementsAre("lock", "w.copy-1.evod", "w.evod"));
}

} // namespace
} // namespace evod::replay
