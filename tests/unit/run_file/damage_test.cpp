// Damaged run files: flips bits and truncates files that a server closed, and files with a write-ahead log that a
// killed server left. FLIPS and CUTS are the numbers of cases for each kind of file.
//
// The result is never a wrong world. Damage is reported; or it hit unused bytes; or, if there is a log, the file is
// read as of an earlier moment, with everything up to there and nothing after it.
#include "server/replay/archive.h"
#include "server/replay/rerun.h"
#include "server/replay/verify.h"
#include "server/run_file/check.h"
#include "tests/support/everyday.h"
#include "tests/unit/recording/recorded_run.h"

#include <fstream>
#include <random>
#include <set>
#include <sstream>

namespace evod::run_file {
namespace {

using namespace recording;
using namespace replay;

/// A run file and its write-ahead log, byte by byte.
struct Content {
    std::string file, log;
};

std::string read_bytes(const std::string& path) {
    std::ifstream file{path, std::ios::binary};
    std::ostringstream bytes;
    bytes << file.rdbuf();
    return bytes.str();
}

void write_bytes(const std::string& path, std::string_view bytes) {
    std::ofstream{path, std::ios::binary}.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

Content read_content(const std::string& path) {
    return {read_bytes(path), read_bytes(path + "-wal")};
}

void write_content(const std::string& path, const Content& content) {
    std::filesystem::remove(path + "-shm");
    std::filesystem::remove(path + "-wal");
    write_bytes(path, content.file);
    if (!content.log.empty()) {
        write_bytes(path + "-wal", content.log);
    }
}

/// The contents of a sound file, as one text.
std::string contents_of(RunFile& file) {
    std::ostringstream text;
    text << file.identity().name << ' ' << to_text(file.identity().run_id) << ' ' << file.identity().seed.value << '\n';
    for (const JournalEntry& entry : *file.journal().read()) {
        text << entry.number << ' ' << entry.tick << ' ' << to_text(entry.origin.by) << ' ' << entry.origin.client_key
             << ' ' << entry.origin.request_id << ' ' << entry.origin.request << ' ' << entry.answer << '\n';
    }
    for (std::uint64_t generation = 1; generation <= file.generations().last(); ++generation) {
        const auto begun = *file.generations().beginning_of(generation);
        text << generation << ' ' << begun->opening.moment.tick << ' ' << begun->opening.parameters.revision << '\n';
        for (const evolution::NextGeneration& born : begun->born) {
            text << born.genes << '\n';
            for (const auto& [first, second] : born.parents) {
                text << first << ' ' << second << ' ';
            }
        }
        if (const auto ended = *file.generations().outcome_of(generation)) {
            for (const IslandOutcome& outcome : ended->outcomes) {
                for (std::size_t i = 0; i < outcome.fitness.size(); ++i) {
                    text << outcome.fitness[i] << ' ' << outcome.lived_ticks[i] << ' ' << name_of(outcome.cause[i])
                         << ' ';
                }
            }
        }
        if (generation < file.generations().last()) {
            for (const simulation::GenerationStatistics& statistics : *file.generations().statistics_of(generation)) {
                simulation::for_each_number(statistics, [&](const std::string&, auto value) { text << value << ' '; });
            }
        }
    }
    for (const HashRecord& link : *file.hashes(0, file.contents().tick)) {
        text << link.tick << ' ' << to_text(link.hash) << '\n';
    }
    for (const StoredCheckpoint& checkpoint : *file.checkpoints().read(0, file.contents().tick)) {
        text << checkpoint.moment.tick << ' ' << to_text(checkpoint.hash) << ' ' << checkpoint.state << '\n';
    }
    return text.str();
}

enum class Left {
    Closed,     // by a server
    Killed,     // everything since the creation of the file is in the log alone
    Restarted,  // SQLite restarted the log over its earlier frames; no command came after that
    HalfCopied, // a part of the log has been copied into the file
};

class DamageTest : public testing::TestWithParam<Left> {
  protected:
    /// Four generations and a half with a command every 13 ticks and a checkpoint every 90, of which three are kept.
    DamageTest() {
        auto data = DataFolder::open(folder.path());
        StorageThread thread{{.part_bytes = 600}}; // so that checkpoints have several parts
        RecordedRun run{*data, thread, {7}};
        const std::string path = data->file_of("w");
        std::unique_ptr<RunFile> reading;
        const auto write_out = [&] {
            while (!thread.idle()) {
            }
        };
        const auto command = [&](const char* name, double value) {
            if (GetParam() == Left::Restarted && run.world().moment().tick > middle) {
                return;
            }
            run.command(set_parameter(name, value));
            commands.push_back(run.world().moment().tick);
            write_out();
        };
        for (std::uint64_t tick = 0; tick < last_tick; ++tick) {
            if (tick % 26 == 0) {
                command("mutation_chance", 0.001 * static_cast<double>(tick));
            } else if (tick % 13 == 0) {
                command("food_health", 0.1 * static_cast<double>(tick));
            }
            if (tick == middle && GetParam() == Left::HalfCopied) {
                reading = *RunFile::open_read_only(path);
                EXPECT_TRUE(reading->pin_snapshot());
                EXPECT_EQ(reading->generations().last(), 3u);
            }
            if (tick == middle && GetParam() == Left::Restarted) {
                copy_log(path);
            }
            if (tick % 60 == 1 && tick > middle) {
                write_out();
            }
            hashes.push_back(run.world().hash());
            histories.push_back(run.world().history().size());
            run.advance(1);
            if (run.world().moment().tick % 90 == 50) {
                run.checkpoint();
            }
        }
        hashes.push_back(run.world().hash());
        histories.push_back(run.world().history().size());
        command("food_health", 7);
        write_out();
        if (GetParam() == Left::HalfCopied) {
            copy_log(path);
        }
        if (GetParam() == Left::Closed) {
            run.recorder().close_all(run.laboratory());
        }
        write_out();
        sound = read_content(path);
        place = folder.path() + "/copy.evod";
    }

    /// Copies the log into the file, as SQLite does with a long log.
    static void copy_log(const std::string& path) {
        Database database{path, Database::Mode::Write};
        database.run("PRAGMA wal_checkpoint(PASSIVE)");
        ASSERT_FALSE(database.failed()) << database.error();
    }

    /// Whether these are the run's first commands, all up to `tick`; those at `tick` may be there or not.
    void expect_first_commands(const std::vector<JournalEntry>& journal, std::uint64_t tick) const {
        const auto before = static_cast<std::size_t>(std::ranges::lower_bound(commands, tick) - commands.begin());
        const auto by_then = static_cast<std::size_t>(std::ranges::upper_bound(commands, tick) - commands.begin());
        EXPECT_GE(journal.size(), before);
        EXPECT_LE(journal.size(), by_then);
        for (std::size_t i = 0; i < std::min(journal.size(), by_then); ++i) {
            EXPECT_EQ(journal[i].tick, commands[i]);
            EXPECT_EQ(journal[i].origin.request_id, i + 1);
        }
    }

    /// Whether a server recovers the run, or refuses the file.
    void expect_no_other_world(const Content& damaged) {
        write_content(place, damaged);
        const auto file = RunFile::open(place, {});
        if (!file) {
            return;
        }
        const auto recovered = recover(**file, executor);
        if (!recovered) {
            return;
        }
        const std::uint64_t tick = recovered->world.moment().tick;
        ASSERT_LT(tick, hashes.size());
        EXPECT_EQ(recovered->world.hash(), hashes[tick]) << "tick " << tick;
        EXPECT_EQ(recovered->world.history().size(), histories[tick]) << "generations that are over";
        expect_first_commands(recovered->journal, tick);
        if (sound.log.empty()) {
            EXPECT_EQ(recovered->journal.size(), commands.size());
        }
    }

    /// Whether a reader finds the run's records, or an error.
    void expect_nothing_wrong_read(const Content& damaged) {
        write_content(place, damaged);
        const auto file = RunFile::open_read_only(place);
        if (!file || !check(**file)) {
            ++named;
            return;
        }
        const std::string contents = contents_of(**file);
        ++(contents == whole ? unread : earlier);
        if (!known.insert(contents).second) {
            return;
        }
        ASSERT_FALSE(sound.log.empty());
        const std::uint64_t tick = (*file)->contents().tick;
        expect_first_commands(*(*file)->journal().read(), tick);
        for (const HashRecord& link : *(*file)->hashes(0, tick)) {
            EXPECT_EQ(link.hash, hashes.at(link.tick));
        }
        const auto verified = verify(**file, executor, [](const VerifyProgress&) {});
        ASSERT_TRUE(verified) << to_text(verified.error());
        EXPECT_FALSE(verified->difference) << verified->difference->part;
        EXPECT_EQ(verified->ticks, tick);
    }

    void expect_never_wrong(const Content& damaged) {
        expect_nothing_wrong_read(damaged);
        expect_no_other_world(damaged);
    }

    void SetUp() override {
        write_content(place, sound);
        const auto file = RunFile::open_read_only(place);
        ASSERT_TRUE(file) << to_text(file.error());
        const auto checked = check(**file);
        ASSERT_TRUE(checked) << to_text(checked.error());
        EXPECT_EQ((*file)->checkpoints().read(0, last_tick)->size(), 3u);
        whole = contents_of(**file);
        known.insert(whole);
        ASSERT_EQ(sound.log.empty(), GetParam() == Left::Closed);
    }

    static constexpr std::uint64_t middle = 260, last_tick = 545;
    // In memory if possible: each flip needs two syncs, which are slow on a disk.
    TemporaryFolder folder{std::filesystem::exists("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path()};
    base::InlineExecutor executor;
    std::vector<base::StateHash> hashes; // by tick
    std::vector<std::size_t> histories;  // how many generations were over, by tick
    std::vector<std::uint64_t> commands; // the tick of each
    Content sound;
    std::string place, whole;
    std::set<std::string> known; // contents that have been checked
    int named = 0, unread = 0, earlier = 0;
};

/// Bytes that determine how the others are read: the first of them, and the distance from one to the
/// next.
struct Heads {
    std::size_t first, bytes, distance;
};

TEST_P(DamageTest, AFlippedBitIsReportedOrHarmless) {
    std::mt19937 random{5};
    const auto flip = [&](std::string& bytes, std::size_t byte) {
        bytes[byte] = static_cast<char>(bytes[byte] ^ (1 << random() % 8));
    };
    const auto in_heads = [&](const std::string& bytes, const Heads& heads) {
        const std::size_t count = (bytes.size() - heads.first) / heads.distance;
        return random() % (count + 1) == 0 ? random() % std::min<std::size_t>(100, bytes.size())
                                           : heads.first + random() % count * heads.distance + random() % heads.bytes;
    };
    constexpr std::size_t page = 4096, frame_head = 24, log_head = 32;
    for (std::uint64_t i = 0, flips = everyday_size("FLIPS", 200); i < flips; ++i) {
        Content flipped = sound;
        std::string& bytes = i % 2 == 0 || sound.log.empty() ? flipped.file : flipped.log;
        const bool head = i % 4 >= 2;
        const std::size_t byte =
            !head ? random() % bytes.size()
            : &bytes == &flipped.file
                ? in_heads(bytes, {.first = 0, .bytes = 12, .distance = page})
                : in_heads(bytes, {.first = log_head, .bytes = frame_head, .distance = frame_head + page});
        SCOPED_TRACE((&bytes == &flipped.file ? "byte of the file: " : "byte of the log: ") + std::to_string(byte));
        flip(bytes, byte);
        expect_never_wrong(flipped);
        if (HasFailure()) {
            return;
        }
    }
    EXPECT_GT(named, 0);
    EXPECT_GT(unread, 0);
    EXPECT_EQ(earlier > 0, GetParam() != Left::Closed);
}

TEST_P(DamageTest, APageThatHidesItsLastRowIsNamed) {
    constexpr std::size_t page_bytes = 4096;
    for (std::size_t page = 0; page < sound.file.size(); page += page_bytes) {
        const std::size_t head = page == 0 ? 100 : page; // the first page begins with the file header
        const char kind = sound.file[head];
        if ((kind != 0x0a && kind != 0x0d) || sound.file[head + 4] == 0) { // leaves of SQLite's trees, and their rows
            continue;
        }
        Content hiding = sound;
        --hiding.file[head + 4];
        SCOPED_TRACE("page at byte " + std::to_string(page));
        expect_never_wrong(hiding);
        if (HasFailure()) {
            return;
        }
    }
}

TEST_P(DamageTest, ACutIsNamedOrLeavesTheBeginning) {
    std::mt19937 random{6};
    for (std::uint64_t i = 0, cuts = everyday_size("CUTS", 100); i < cuts; ++i) {
        Content cut = sound;
        std::string& bytes = i % 4 == 0 || sound.log.empty() ? cut.file : cut.log;
        bytes.resize(i == 1 ? 0 : random() % bytes.size()); // all of the log, too
        SCOPED_TRACE((&bytes == &cut.file ? "bytes of the file: " : "bytes of the log: ") +
                     std::to_string(bytes.size()));
        expect_never_wrong(cut);
        if (HasFailure()) {
            return;
        }
    }
    EXPECT_GT(named, 0);
    EXPECT_EQ(earlier > 0, GetParam() != Left::Closed);
}

TEST_P(DamageTest, AServerLeavesAnEmptiedFileAsItIs) {
    constexpr std::size_t page_bytes = 4096, head_bytes = 100;
    const Content damages[] = {{"", sound.log},
                               {"", ""},
                               {"x", ""}, // of no size to SQLite
                               {sound.file.substr(0, 1), sound.log},
                               {sound.file.substr(0, head_bytes), ""},
                               {sound.file.substr(0, page_bytes), ""}};
    for (const Content& damage : damages) {
        SCOPED_TRACE(std::to_string(damage.file.size()) + " bytes of the file, of the log " +
                     std::to_string(damage.log.size()));
        const TemporaryFolder server;
        const std::string path = server.path() + "/w.evod";
        write_content(path, damage);
        const auto archive = Archive::open(server.path(), {}, executor);
        ASSERT_TRUE(archive) << to_text(archive.error());
        const simulation::Laboratory laboratory = (*archive)->take_laboratory();
        ASSERT_EQ(laboratory.damaged().size(), 1u);
        EXPECT_EQ(laboratory.damaged().front().run_id, std::nullopt);
        EXPECT_NE(laboratory.damaged().front().reason.find(path), std::string::npos);
        EXPECT_EQ(read_bytes(path), damage.file);
        EXPECT_EQ(read_bytes(path + "-wal"), damage.log);
        EXPECT_FALSE(RunFile::open_read_only(path));
    }
}

/// A new file contains its identity without its log, so a file without one is damaged.
TEST_P(DamageTest, AFileIsReadableWithoutItsLog) {
    write_content(place, {sound.file, ""});
    const auto file = RunFile::open_read_only(place);
    ASSERT_TRUE(file) << to_text(file.error());
    EXPECT_EQ((*file)->identity().name, "w");
    EXPECT_GE((*file)->generations().last(), 1u);
}

void PrintTo(Left left, std::ostream* out) {
    constexpr const char* names[] = {"Closed", "Killed", "Restarted", "HalfCopied"};
    *out << names[static_cast<int>(left)];
}

INSTANTIATE_TEST_SUITE_P(All, DamageTest,
                         testing::Values(Left::Closed, Left::Killed, Left::Restarted, Left::HalfCopied),
                         testing::PrintToStringParamName());

} // namespace
} // namespace evod::run_file
