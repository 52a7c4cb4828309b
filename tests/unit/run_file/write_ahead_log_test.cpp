// Write-ahead logs of a killed program: with flipped bits, truncated, and with frames of earlier cycles or of
// rolled-back transactions behind the end.
#include "server/run_file/write_ahead_log.h"

#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <atomic>
#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>

namespace evod::run_file {
namespace {

using namespace recording;

std::string bytes_of_file(const std::string& path) {
    std::ifstream file{path, std::ios::binary};
    std::ostringstream bytes;
    bytes << file.rdbuf();
    return bytes.str();
}

std::optional<std::uint64_t> damage_in(const std::string& log, const std::string& index) {
    const auto reader_of = [](const std::string& content) {
        return [&content](std::uint64_t offset, std::span<std::byte> bytes) {
            if (offset >= content.size()) {
                return std::size_t{0};
            }
            const std::size_t count = std::min<std::size_t>(bytes.size(), content.size() - offset);
            std::memcpy(bytes.data(), content.data() + offset, count);
            return count;
        };
    };
    const auto read_log = reader_of(log), read_index = reader_of(index);
    return damage_of_log(read_log, read_index);
}

constexpr std::size_t log_head_bytes = 32, frame_bytes = 24 + 4096;

std::size_t frame_offset(std::size_t frame) {
    return log_head_bytes + frame * frame_bytes;
}

class WriteAheadLogTest : public testing::Test {
  protected:
    WriteAheadLogTest() {
        run("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; CREATE TABLE t (number INTEGER PRIMARY KEY, x "
            "BLOB)");
    }

    void run(const std::string& sql) {
        database.run(sql.c_str());
        ASSERT_FALSE(database.failed()) << database.error();
    }
    /// A commit of about that many pages.
    void commit(int pages) { run("INSERT INTO t (x) VALUES (randomblob(" + std::to_string(pages * 4000) + "))"); }
    std::string log() const { return bytes_of_file(path + "-wal"); }
    std::string index() const { return bytes_of_file(path + "-shm"); }
    /// The number of frames that SQLite would read.
    std::size_t frames() const { return database.log_pages(); }

    /// Flips bits of every frame up to `end`, each by itself: every bit of its head, and some of its page.
    template <class Expect>
    void flip_each(const std::string& sound, std::size_t begin, std::size_t end, const Expect& expect) {
        std::string flipped = sound;
        for (std::size_t byte = begin; byte < end; ++byte) {
            const std::size_t in_frame = byte < log_head_bytes ? 0 : (byte - log_head_bytes) % frame_bytes;
            const bool in_head = byte < log_head_bytes || in_frame < 24;
            for (int bit = in_head ? 0 : static_cast<int>(byte % 8); bit < (in_head              ? 8
                                                                            : in_frame % 61 == 0 ? 8
                                                                                                 : 0);
                 bit += in_head ? 1 : 8) {
                flipped[byte] = static_cast<char>(sound[byte] ^ (1 << bit));
                expect(flipped, byte);
                flipped[byte] = sound[byte];
                if (HasFailure()) {
                    ADD_FAILURE() << "bit " << bit << " of byte " << byte;
                    return;
                }
            }
        }
    }

    TemporaryFolder folder;
    const std::string path = folder.path() + "/w.evod";
    Database database{path, Database::Mode::Create};
};

TEST_F(WriteAheadLogTest, EveryFlippedBitIsFound) {
    for (const int pages : {1, 3, 2, 1, 2}) {
        commit(pages);
    }
    const std::string sound = log(), known = index();
    ASSERT_EQ(sound.size(), frame_offset(frames()));
    EXPECT_FALSE(damage_in(sound, known));
    flip_each(sound, 0, sound.size(), [&](const std::string& flipped, std::size_t byte) {
        const std::size_t begins = byte < log_head_bytes ? 0 : byte - (byte - log_head_bytes) % frame_bytes;
        EXPECT_EQ(damage_in(flipped, known), begins);
    });
}

TEST_F(WriteAheadLogTest, WithoutItsIndexAllButTheLastCommitIsChecked) {
    for (const int pages : {1, 3, 2, 1}) {
        commit(pages);
    }
    const std::size_t last = frames();
    commit(3);
    const std::string sound = log();
    flip_each(sound, 0, frame_offset(last),
              [&](const std::string& flipped, std::size_t) { EXPECT_TRUE(damage_in(flipped, "")); });
    flip_each(sound, frame_offset(last), sound.size(), [&](const std::string& flipped, std::size_t byte) {
        const std::size_t in_frame = (byte - log_head_bytes) % frame_bytes;
        if (in_frame < 4 || in_frame >= 8) { // a frame that became the end of a commit is found
            EXPECT_FALSE(damage_in(flipped, ""));
        }
    });
}

TEST_F(WriteAheadLogTest, ALogTruncatedAnywhereIsSound) {
    for (const int pages : {1, 3, 2}) {
        commit(pages);
    }
    const std::string sound = log(), known = index();
    for (std::size_t bytes = 0; bytes <= sound.size(); bytes += bytes < 200 ? 1 : 97) {
        EXPECT_FALSE(damage_in(sound.substr(0, bytes), known)) << bytes;
        EXPECT_FALSE(damage_in(sound.substr(0, bytes), "")) << bytes;
    }
}

TEST_F(WriteAheadLogTest, ALastWriteTornOverAnEarlierCycleIsSound) {
    for (const int pages : {2, 3, 2, 3, 4}) {
        commit(pages);
    }
    const std::string cycle_before = log();
    database.copy_log();
    commit(1);
    const std::string known = index();
    commit(3);
    const std::string sound = log();
    ASSERT_EQ(sound.size(), cycle_before.size());
    ASSERT_NE(sound.substr(0, log_head_bytes), cycle_before.substr(0, log_head_bytes));
    EXPECT_FALSE(damage_in(sound, index()));
    const std::size_t end = frame_offset(frames()), last = end - 3 * frame_bytes;
    for (std::size_t bytes = last; bytes <= end; bytes += 97) {
        EXPECT_FALSE(damage_in(sound.substr(0, bytes) + cycle_before.substr(bytes), known)) << bytes;
    }
    flip_each(sound, 0, end,
              [&](const std::string& flipped, std::size_t) { EXPECT_TRUE(damage_in(flipped, index())); });
}

TEST_F(WriteAheadLogTest, FramesOfARolledBackTransactionAreSound) {
    run("PRAGMA cache_size = 5");
    commit(2);
    run("BEGIN");
    for (int i = 0; i < 30; ++i) {
        commit(2);
    }
    run("ROLLBACK");
    const std::size_t spilt = log().size();
    commit(2);
    ASSERT_LT(frame_offset(frames()), spilt) << "nothing was written ahead";
    EXPECT_FALSE(damage_in(log(), index()));
    EXPECT_FALSE(damage_in(log(), ""));
    const std::string sound = log(), known = index();
    flip_each(sound, 0, frame_offset(frames()),
              [&](const std::string& flipped, std::size_t) { EXPECT_TRUE(damage_in(flipped, known)); });
}

TEST_F(WriteAheadLogTest, ALogIsSoundWhileItIsWritten) {
    std::atomic<bool> stop = false;
    std::atomic<int> commits = 0;
    std::jthread writer{[&] {
        while (!stop) {
            database.run("INSERT INTO t (x) VALUES (randomblob(9000))");
            if (++commits % 20 == 0) {
                database.copy_log();
            }
        }
    }};
    for (int checks = 0; checks < 200 || commits < 100; ++checks) {
        const auto sound = check_log(path, LogIndex::Unread);
        EXPECT_TRUE(sound) << to_text(sound.error());
    }
    stop = true;
    writer.join();
    EXPECT_FALSE(database.failed()) << database.error();
}

TEST_F(WriteAheadLogTest, TheRefusalStatesHowToAcceptTheLoss) {
    for (const int pages : {1, 3, 2, 1}) {
        commit(pages);
    }
    const std::string copy = folder.path() + "/copy.evod", sound = log();
    std::string flipped = sound;
    flipped[frame_offset(5) + 1000] ^= 4;
    std::ofstream{copy + "-wal", std::ios::binary} << flipped;
    const auto refused = check_log(copy, LogIndex::Read);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, base::RefusalCode::DataLoss);
    const std::string offset = std::to_string(frame_offset(5));
    EXPECT_THAT(refused.error().message, testing::HasSubstr(copy + "-wal is damaged at byte " + offset));
    EXPECT_THAT(refused.error().message, testing::HasSubstr("truncate -s " + offset + " " + copy + "-wal"));
    std::filesystem::resize_file(copy + "-wal", frame_offset(5));
    EXPECT_TRUE(check_log(copy, LogIndex::Read));
    EXPECT_TRUE(check_log(folder.path() + "/none.evod", LogIndex::Read));
}

} // namespace
} // namespace evod::run_file
