// Fuzz run file: reads, checks and exports any bytes as a run file, or refuses them.
//
// The first byte selects what the others are: the file itself; bytes to change in a sound file; columns to change in
// its rows, which then get right checksums; or the text of a trigger, view or index to add, with which the file must be
// refused. It also selects whether the sound file is of a run from its first generation on, or of a fork.
#include "evod/v1/commands.pb.h"
#include "server/base/inline_executor.h"
#include "server/commands/export.h"
#include "server/run_file/check.h"
#include "server/run_file/row.h"
#include "server/run_file/run_file.h"

#include <sqlite3.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

namespace {

using namespace evod;
using Bytes = std::span<const std::uint8_t>;

void require(bool holds) {
    if (!holds) {
        std::abort();
    }
}

/// The first `count` of `bytes`, which lose them.
Bytes take(Bytes& bytes, std::size_t count) {
    const Bytes taken = bytes.first(std::min(count, bytes.size()));
    bytes = bytes.subspan(taken.size());
    return taken;
}

template <class T>
T take(Bytes& bytes) {
    T value{};
    const Bytes taken = take(bytes, sizeof value);
    std::memcpy(&value, taken.data(), taken.size());
    return value;
}

/// A file in memory, of a run of a few generations; gone with the program.
struct Place {
    Place() {
        std::string name = "/dev/shm/evod_fuzz_XXXXXX";
        require(mkdtemp(name.data()) != nullptr);
        folder = name;
        path = folder + "/run.evod";
        write_sound(true);
        sound[1] = take_away();
        write_sound(false);
        sound[0] = take_away();
        put(sound[0].data(), sound[0].size());
    }
    ~Place() { std::filesystem::remove_all(folder); }
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;

    /// Of three generations, or of what follows on a moment within the third.
    void write_sound(bool fork) const {
        parameters::Parameters parameters;
        parameters.population_size = 4;
        parameters.generation_s = 1;
        parameters.island_count = 2;
        base::InlineExecutor executor;
        simulation::World world{parameters, {3}};
        if (fork) {
            while (world.moment().generation < 3 || world.moment().generation_tick < 10) {
                world.advance_tick(executor);
            }
            world.become_fork();
        }
        run_file::RunBeginning beginning = fork ? run_file::beginning_of_fork(world, "w", {1, 2}, {3, 4}, executor)
                                                : run_file::beginning_of_run(world, "w", {1, 2});
        const run_file::RunIdentity identity = beginning.identity;
        const auto file =
            run_file::RunFile::create(path, identity, {}, run_file::RunFile::records_of(std::move(beginning)));
        require(file.has_value());
        (*file)->begin();
        v1::Request request;
        request.mutable_pause();
        (*file)->write(run_file::JournalEntry{
            .number = 1,
            .tick = identity.first_tick,
            .origin = {base::client_actor("", "client", "::1:5000"), "key", 1, request.SerializeAsString()},
            .answer = "answer",
            .control = {}});
        while (world.moment().generation < identity.first_generation + 2) {
            const std::uint64_t generation = world.moment().generation;
            world.advance_tick(executor);
            if (world.moment().generation != generation) {
                (*file)->write(run_file::beginning_of(world));
            }
            if (world.moment().tick % run_file::ticks_per_hash == 0) {
                (*file)->write(run_file::HashRecord{world.moment().tick, world.hash()});
            }
            if (world.generation_over()) {
                (*file)->write(run_file::end_of(world));
            }
        }
        (*file)->write(run_file::EndMark{.tick = world.moment().tick});
        require((*file)->commit().has_value());
        require(check(**file).has_value());
    }

    std::string take_away() const {
        std::ifstream file{path, std::ios::binary};
        std::string bytes{std::istreambuf_iterator<char>{file}, {}};
        require(!bytes.empty() && std::filesystem::remove(path));
        return bytes;
    }

    /// Puts a file there, and nothing else.
    void put(const char* bytes, std::size_t count) const {
        for (const char* suffix : {"-wal", "-shm", "-journal"}) {
            std::filesystem::remove(path + suffix);
        }
        std::ofstream{path, std::ios::binary}.write(bytes, static_cast<std::streamsize>(count));
    }

    std::string folder, path;
    std::array<std::string, 2> sound; // of a run, of a fork
};

/// One column of one row gets another value, of its kind, and the row its checksum.
void change_row(sqlite3* database, Bytes& bytes) {
    constexpr const char* tables[] = {
        "run",        "journal",  "parameters", "generation", "population",           "outcome",    "statistics",
        "state_hash", "end_mark", "thinned",    "founders",   "inherited_statistics", "checkpoint", "checkpoint_part"};
    const std::string table = tables[take<std::uint8_t>(bytes) % std::size(tables)];
    const int row = take<std::uint8_t>(bytes), wanted = take<std::uint8_t>(bytes);
    if (table == "thinned") {
        sqlite3_exec(database, "INSERT INTO thinned VALUES (1, 2, 1, 60, 0)", nullptr, nullptr, nullptr);
    }
    sqlite3_stmt* read = nullptr;
    // The format before has not all of them.
    if (sqlite3_prepare_v2(database,
                           ("SELECT rowid, * FROM " + table + " LIMIT 1 OFFSET " + std::to_string(row % 16)).c_str(),
                           -1, &read, nullptr) != SQLITE_OK) {
        return;
    }
    if (sqlite3_step(read) == SQLITE_ROW) {
        const int columns = sqlite3_column_count(read) - 2; // without rowid and checksum
        run_file::RowChecksum checksum{table};
        std::string sql = "UPDATE " + table + " SET checksum = ?1, " + sqlite3_column_name(read, 1 + wanted % columns) +
                          " = ?2 WHERE rowid = ?3";
        sqlite3_stmt* write = nullptr;
        require(sqlite3_prepare_v2(database, sql.c_str(), -1, &write, nullptr) == SQLITE_OK);
        for (int i = 1; i <= columns; ++i) {
            const bool changed = i == 1 + wanted % columns;
            switch (sqlite3_column_type(read, i)) {
            case SQLITE_INTEGER: {
                const std::int64_t value = changed ? take<std::int64_t>(bytes) : sqlite3_column_int64(read, i);
                checksum.add(value);
                if (changed) {
                    sqlite3_bind_int64(write, 2, value);
                }
                break;
            }
            case SQLITE_FLOAT: {
                const double value = changed ? take<double>(bytes) : sqlite3_column_double(read, i);
                checksum.add(value);
                if (changed) {
                    sqlite3_bind_double(write, 2, value);
                }
                break;
            }
            case SQLITE_NULL:
                checksum.add_null();
                break;
            default: {
                const bool text = sqlite3_column_type(read, i) == SQLITE_TEXT;
                std::string value{static_cast<const char*>(sqlite3_column_blob(read, i)),
                                  static_cast<std::size_t>(sqlite3_column_bytes(read, i))};
                if (changed) {
                    const std::size_t kept = take<std::uint16_t>(bytes) % (value.size() + 1);
                    const Bytes added = take(bytes, take<std::uint8_t>(bytes));
                    value.resize(kept);
                    value.append(reinterpret_cast<const char*>(added.data()), added.size());
                    text ? sqlite3_bind_text(write, 2, value.data(), static_cast<int>(value.size()), SQLITE_TRANSIENT)
                         : sqlite3_bind_blob(write, 2, value.data(), static_cast<int>(value.size()), SQLITE_TRANSIENT);
                }
                text ? checksum.add_text(value) : checksum.add_bytes(std::as_bytes(std::span{value}));
            }
            }
        }
        sqlite3_bind_int64(write, 1, checksum.finish());
        sqlite3_bind_int64(write, 3, sqlite3_column_int64(read, 0));
        sqlite3_step(write); // may be refused, as the same key twice is
        sqlite3_finalize(write);
    }
    sqlite3_finalize(read);
}

/// Gives the file a trigger, view or index. Returns whether it has one now.
bool add_to_schema(sqlite3* database, Bytes& bytes) {
    const auto count = [&] {
        sqlite3_stmt* rows = nullptr;
        require(sqlite3_prepare_v2(database, "SELECT count(*) FROM main.sqlite_schema", -1, &rows, nullptr) ==
                    SQLITE_OK &&
                sqlite3_step(rows) == SQLITE_ROW);
        const int found = sqlite3_column_int(rows, 0);
        sqlite3_finalize(rows);
        return found;
    };
    const int before = count();
    constexpr const char* kinds[] = {"CREATE TRIGGER ", "CREATE VIEW ", "CREATE INDEX ", "CREATE UNIQUE INDEX "};
    std::string sql = kinds[take<std::uint8_t>(bytes) % std::size(kinds)];
    sql.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    sqlite3_stmt* statement = nullptr; // the first of the text alone
    if (sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr) == SQLITE_OK) {
        sqlite3_step(statement);
    }
    sqlite3_finalize(statement);
    return count() != before;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const Place place;
    std::cerr.rdbuf(nullptr); // refusals are printed there
    Bytes bytes{data, size};
    const auto kind = take<std::uint8_t>(bytes);
    const std::string& sound = place.sound[kind / 3 % place.sound.size()];
    bool foreign = false;
    switch (kind % 3) {
    case 0:
        place.put(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        break;
    case 1: {
        std::string changed = sound;
        while (!bytes.empty()) {
            const std::size_t at = take<std::uint32_t>(bytes) % changed.size();
            changed[at] = static_cast<char>(take<std::uint8_t>(bytes));
        }
        place.put(changed.data(), changed.size());
        break;
    }
    default: {
        place.put(sound.data(), sound.size());
        sqlite3* database = nullptr;
        require(sqlite3_open(place.path.c_str(), &database) == SQLITE_OK);
        if (kind >= 128) {
            foreign = add_to_schema(database, bytes);
        }
        while (!foreign && !bytes.empty()) {
            change_row(database, bytes);
        }
        sqlite3_close(database);
    }
    }
    if (const auto file = run_file::RunFile::open_read_only(place.path)) {
        require(!foreign);
        (void)check(**file);
        (void)(*file)->generations().history((*file)->generations().last() + 1, simulation::history_generations_kept);
        (void)(*file)->journal().read((*file)->contents().journal_entries);
    }
    for (const char* what : {"generations", "organisms", "events"}) {
        (void)commands::export_run({.run = place.path, .what = what, .format = "jsonl", .output = "/dev/null"});
    }
    return 0;
}
