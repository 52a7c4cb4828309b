#include "server/run_file/run_file.h"

#include "server/files/regular_file.h"
#include "server/parameters/experiment.h"
#include "server/run_file/checkpoint.h"
#include "server/run_file/data_folder.h"
#include "server/run_file/write_ahead_log.h"

#include <sys/stat.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <ranges>
#include <set>
#include <utility>

namespace evod::run_file {
namespace {

using base::Refusal;
using base::RefusalCode;
using base::Result;
using ColumnNames = std::vector<std::string>;

const ColumnNames journal_columns = {"number", "tick",    "client",           "client_key", "request_id", "request",
                                     "answer", "endless", "until_generation", "until_tick", "paused",     "speed"};
const ColumnNames parameters_columns = {"number", "revision", "active", "requested"};
const ColumnNames generation_columns = {"generation",   "first_tick",        "simulated_s",
                                        "parameters",   "generations_over",  "stagnant",
                                        "best_fitness", "last_best_fitness", "last_died_out"};
const ColumnNames population_columns = {"generation",     "island",        "organism_count", "elite_count",
                                        "survivor_count", "clamped_count", "chromosomes",    "parents"};
const ColumnNames founders_columns = {"generation", "island", "founders"};
const ColumnNames account_columns = [] {
    ColumnNames columns{"generation", "island"};
    evolution::for_each_number(std::nullopt, [&](const std::string& name, auto) { columns.push_back(name); });
    return columns;
}();
const ColumnNames outcome_columns = {"generation", "island", "fitness", "lived_ticks", "cause"};
const ColumnNames link_columns = {"tick", "low", "high"};
const ColumnNames checkpoint_columns = {
    "tick", "generation", "generation_tick", "simulated_s", "parameters", "journal_entries", "low", "high", "state"};
const ColumnNames part_columns = {"tick", "part", "bytes"};
const ColumnNames end_columns = {"number", "how", "tick", "journal_entries", "generations", "links"};
const ColumnNames thinned_columns = {"number", "keep_every", "until_generation", "until_tick"};
const ColumnNames run_columns = {"key", "value"};
const ColumnNames first_population_columns = {"island", "organism_count", "chromosomes"};

ColumnNames statistics_columns() {
    ColumnNames columns;
    simulation::for_each_number(simulation::GenerationStatistics{},
                                [&](const std::string& name, auto) { columns.push_back(name); });
    return columns;
}

constexpr const char* checkpoint_table = R"(
CREATE TABLE checkpoint (tick INTEGER PRIMARY KEY, generation INTEGER NOT NULL, generation_tick INTEGER NOT NULL,
    simulated_s REAL NOT NULL, parameters INTEGER NOT NULL, journal_entries INTEGER NOT NULL, low INTEGER NOT NULL,
    high INTEGER NOT NULL, state BLOB NOT NULL, checksum INTEGER NOT NULL) STRICT;
)";

constexpr const char* part_table = R"(
CREATE TABLE checkpoint_part (tick INTEGER NOT NULL, part INTEGER NOT NULL, bytes BLOB NOT NULL,
    checksum INTEGER NOT NULL, PRIMARY KEY (tick, part)) STRICT;
)";
/// Parts of checkpoints that were not written to their end, or are not there any more.
constexpr const char* belonging_to_none = "tick NOT IN (SELECT tick FROM checkpoint)";

constexpr const char* founders_table = R"(
CREATE TABLE founders (generation INTEGER NOT NULL, island INTEGER NOT NULL, founders BLOB NOT NULL,
    checksum INTEGER NOT NULL, PRIMARY KEY (generation, island)) STRICT;
)";

constexpr const char* account_table = "selection_account";

std::string account_table_ddl() {
    std::string sql = "CREATE TABLE " + std::string{account_table} +
                      " (generation INTEGER NOT NULL, "
                      "island INTEGER NOT NULL, ";
    evolution::for_each_number(std::nullopt, [&](const std::string& name, auto) { sql += name + " REAL, "; });
    return sql + "checksum INTEGER NOT NULL, PRIMARY KEY (generation, island)) STRICT;";
}

constexpr const char* inherited_statistics = "inherited_statistics"; // the table

/// Of a generation that is not held any more, these have no rows.
constexpr const char* tables_of_held_generations[] = {"population", "founders", "outcome", "checkpoint"};

/// The DDL of a table whose columns have the types of an SQLite "STRICT" table.
std::string statistics_table(const char* table) {
    std::string sql = "CREATE TABLE " + std::string{table} + " (";
    simulation::for_each_number(simulation::GenerationStatistics{}, [&](const std::string& name, auto value) {
        sql += name + (std::is_floating_point_v<decltype(value)> ? " REAL" : " INTEGER") + " NOT NULL, ";
    });
    return sql + "checksum INTEGER NOT NULL, PRIMARY KEY (generation, island)) STRICT;";
}

/// Every table of the present format.
void create_all_tables(Database& database) {
    database.run(R"(
CREATE TABLE run (key TEXT PRIMARY KEY, value TEXT NOT NULL, checksum INTEGER NOT NULL) STRICT;
CREATE TABLE first_population (island INTEGER PRIMARY KEY, organism_count INTEGER NOT NULL, chromosomes BLOB NOT NULL,
    checksum INTEGER NOT NULL) STRICT;
CREATE TABLE parameters (number INTEGER PRIMARY KEY, revision INTEGER NOT NULL, active TEXT NOT NULL,
    requested TEXT NOT NULL, checksum INTEGER NOT NULL) STRICT;
CREATE TABLE journal (number INTEGER PRIMARY KEY, tick INTEGER NOT NULL, client TEXT NOT NULL,
    client_key TEXT NOT NULL, request_id INTEGER NOT NULL, request BLOB NOT NULL, answer BLOB NOT NULL,
    endless INTEGER NOT NULL, until_generation INTEGER, until_tick INTEGER, paused INTEGER NOT NULL, speed REAL,
    checksum INTEGER NOT NULL) STRICT;
CREATE TABLE generation (generation INTEGER PRIMARY KEY, first_tick INTEGER NOT NULL, simulated_s REAL NOT NULL,
    parameters INTEGER NOT NULL, generations_over INTEGER NOT NULL, stagnant INTEGER NOT NULL,
    best_fitness REAL NOT NULL, last_best_fitness REAL NOT NULL, last_died_out INTEGER NOT NULL,
    checksum INTEGER NOT NULL) STRICT;
CREATE TABLE population (generation INTEGER NOT NULL, island INTEGER NOT NULL, organism_count INTEGER NOT NULL,
    elite_count INTEGER NOT NULL, survivor_count INTEGER NOT NULL, clamped_count INTEGER NOT NULL,
    chromosomes BLOB NOT NULL, parents BLOB NOT NULL, checksum INTEGER NOT NULL,
    PRIMARY KEY (generation, island)) STRICT;
CREATE TABLE outcome (generation INTEGER NOT NULL, island INTEGER NOT NULL, fitness BLOB NOT NULL,
    lived_ticks BLOB NOT NULL, cause BLOB NOT NULL, checksum INTEGER NOT NULL,
    PRIMARY KEY (generation, island)) STRICT;
CREATE TABLE state_hash (tick INTEGER PRIMARY KEY, low INTEGER NOT NULL, high INTEGER NOT NULL,
    checksum INTEGER NOT NULL) STRICT;
CREATE TABLE thinned (number INTEGER PRIMARY KEY, keep_every INTEGER NOT NULL, until_generation INTEGER NOT NULL,
    until_tick INTEGER NOT NULL, checksum INTEGER NOT NULL) STRICT;
CREATE TABLE end_mark (number INTEGER PRIMARY KEY, how TEXT NOT NULL, tick INTEGER NOT NULL,
    journal_entries INTEGER NOT NULL, generations INTEGER NOT NULL, links INTEGER NOT NULL,
    checksum INTEGER NOT NULL) STRICT;
)");
    database.run(statistics_table("statistics").c_str());
    database.run(statistics_table(inherited_statistics).c_str());
    database.run(checkpoint_table);
    database.run(part_table);
    database.run(founders_table);
    database.run(account_table_ddl().c_str());
}

/// A row of SQLite's table sqlite_schema.
struct SchemaRow {
    std::string type, name, table, sql;
    friend auto operator<=>(const SchemaRow&, const SchemaRow&) = default;
};
using Schema = std::set<SchemaRow>;

constexpr const char* all_of_schema = "SELECT type, name, tbl_name, sql FROM sqlite_schema";

SchemaRow read_schema_row(const Statement& row) {
    return {.type = row.text(0), .name = row.text(1), .table = row.text(2), .sql = row.text(3)};
}

/// Files from before a world could be given its first population do not have this table.
constexpr std::string_view optional_table = "first_population";

/// What a file of that format has in sqlite_schema. The text of every table has been the same in all formats that had
/// it.
Schema schema_of_format(std::int64_t format) {
    static const Schema present = [] {
        Database database{":memory:", Database::Mode::Write};
        create_all_tables(database);
        Schema schema;
        for (Statement rows{database, all_of_schema}; rows.row();) {
            schema.insert(read_schema_row(rows));
        }
        return schema;
    }();
    const auto first_format_of = [](const std::string& table) {
        return table == "checkpoint_part" || table == account_table   ? 4
               : table == "founders" || table == inherited_statistics ? 3
               : table == "checkpoint"                                ? 2
                                                                      : 1;
    };
    Schema schema = present;
    std::erase_if(schema, [&](const SchemaRow& row) { return first_format_of(row.table) > format; });
    return schema;
}

/// As a message names it: the table "run". The name may come from an untrusted file.
std::string described(const SchemaRow& row) {
    constexpr std::size_t name_bytes_max = 64;
    std::string text = "the " + row.type.substr(0, name_bytes_max) + " \"" + row.name.substr(0, name_bytes_max) + '"';
    std::ranges::replace_if(
        text, [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
    return text;
}

template <class T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
    return std::as_bytes(std::span{values});
}

/// false if the bytes are no whole number of T.
template <class T>
bool read_into(std::vector<T>& values, const std::string& bytes) {
    if (bytes.size() % sizeof(T) != 0) {
        return false;
    }
    values.resize(bytes.size() / sizeof(T));
    if (!bytes.empty()) {
        std::memcpy(values.data(), bytes.data(), bytes.size());
    }
    return true;
}

std::span<const std::byte> bytes_of(const evolution::GeneMatrix& genes) {
    return std::as_bytes(std::span{genes.data(), static_cast<std::size_t>(genes.size())});
}

/// false if the bytes are not those of so many chromosomes.
bool read_into(evolution::GeneMatrix& genes, std::uint64_t organisms, const std::string& bytes) {
    if (bytes.size() != organisms * evolution::gene_count * sizeof(float)) {
        return false;
    }
    genes.resize(evolution::gene_count, static_cast<Eigen::Index>(organisms));
    std::memcpy(genes.data(), bytes.data(), bytes.size());
    return true;
}

template <class T>
std::optional<T> number_from(const std::string& text, int base = 10) {
    T value{};
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value, base);
    return read.ec == std::errc{} && read.ptr == text.data() + text.size() ? std::optional{value} : std::nullopt;
}

std::optional<simulation::RunId> run_id_from(const std::string& text) {
    if (text.size() != 32) {
        return std::nullopt;
    }
    const auto high = number_from<std::uint64_t>(text.substr(0, 16), 16);
    const auto low = number_from<std::uint64_t>(text.substr(16), 16);
    return high && low ? std::optional{simulation::RunId{*high, *low}} : std::nullopt;
}

std::optional<std::int64_t> as_stored(const std::optional<std::uint64_t>& value) {
    return value ? std::optional{static_cast<std::int64_t>(*value)} : std::nullopt;
}

std::optional<std::uint64_t> as_read(const std::optional<std::int64_t>& value) {
    return value ? std::optional{static_cast<std::uint64_t>(*value)} : std::nullopt;
}

void write_statistics(RowWriter& row, const simulation::GenerationStatistics& statistics) {
    simulation::for_each_number(statistics, [&](const std::string&, auto value) {
        if constexpr (std::is_floating_point_v<decltype(value)>) {
            row.real(value);
        } else {
            row.integer(static_cast<std::int64_t>(value));
        }
    });
    row.finish();
}

simulation::GenerationStatistics read_statistics(RowReader& row) {
    simulation::GenerationStatistics statistics;
    simulation::for_each_number(statistics, [&]<class T>(const std::string&, T& value) {
        if constexpr (std::is_floating_point_v<T>) {
            value = row.real();
        } else {
            value = static_cast<T>(row.integer());
        }
    });
    return statistics;
}

void write_account(RowWriter& row, std::int64_t generation, std::int64_t island,
                   const std::optional<evolution::SelectionAccount>& account) {
    row.integer(generation).integer(island);
    evolution::for_each_number(account, [&](const std::string&, std::optional<double> value) { row.real(value); });
    row.finish();
}

Refusal emptied(const std::string& path) {
    return refusal(RefusalCode::DataLoss, path + " is damaged: it holds nothing");
}

/// A file of no more than one byte is an empty database to SQLite, which then throws away the log beside it.
Result<void> expect_bytes(const std::string& path) {
    std::error_code error;
    if (const auto bytes = std::filesystem::file_size(path, error); !error && bytes <= 1) {
        return emptied(path);
    }
    return {};
}

/// A fork may begin with anything; a run of its own, with what its schedule has in generation 1.
bool begins_with_its_schedule(const RunIdentity& identity) {
    return identity.forked_from || std::ranges::all_of(identity.schedule.at(1), [&](const auto& scheduled) {
               return parameters::find_parameter(scheduled.name)->get(identity.parameters) == scheduled.value;
           });
}

std::string accounts_of_generation(std::uint64_t generation) {
    return "the selection accounts of generation " + std::to_string(generation);
}

std::string row_of(const char* table, std::uint64_t key) {
    return std::string{"the row "} + std::to_string(key) + " of its table " + table;
}

} // namespace

struct RunFile::Writers {
    explicit Writers(Database& database)
        : journal{database, "journal", journal_columns}
        , parameters{database, "parameters", parameters_columns}
        , generation{database, "generation", generation_columns}
        , population{database, "population", population_columns}
        , founders{database, "founders", founders_columns}
        , account{database, account_table, account_columns}
        , outcome{database, "outcome", outcome_columns}
        , statistics{database, "statistics", statistics_columns()}
        , link{database, "state_hash", link_columns}
        , checkpoint{database, "checkpoint", checkpoint_columns}
        , part{database, "checkpoint_part", part_columns}
        , end{database, "end_mark", end_columns}
        , thinned{database, "thinned", thinned_columns} {}

    RowWriter journal, parameters, generation, population, founders, account, outcome, statistics, link, checkpoint,
        part, end, thinned;
};

RunFile::RunFile(const std::string& path, Database::Mode mode, const Options& options)
    : path_{path}, database_{path, mode, options.vfs}, options_{options} {
    if (mode == Database::Mode::Read || mode == Database::Mode::ReadAtRest) {
        return;
    }
    database_.run("PRAGMA journal_mode = WAL");
    database_.run("PRAGMA journal_size_limit = 16777216"); // it is cut back to so much once it begins anew
    database_.run(options.durability == Durability::Full ? "PRAGMA synchronous = FULL" : "PRAGMA synchronous = NORMAL");
}

RunFile::~RunFile() = default;

Refusal RunFile::failure() const {
    if (database_.damaged()) {
        return refusal(RefusalCode::DataLoss, path_ + " is damaged, or no run file: " + database_.error());
    }
    return refusal(RefusalCode::Unavailable, path_ + ": " + database_.error());
}

Refusal RunFile::damaged(const std::string& what) const {
    if (database_.failed()) {
        return failure();
    }
    return refusal(RefusalCode::DataLoss, path_ + " is damaged: " + what + " is not as it was written");
}

Result<std::unique_ptr<RunFile>> RunFile::begin_new(const std::string& path, const RunIdentity& identity,
                                                    const Options& options) {
    std::unique_ptr<RunFile> file{new RunFile{path, Database::Mode::Create, options}};
    file->keep_every_ = options.keep_every;
    if (file->database_.number("SELECT count(*) FROM sqlite_schema") != 0) {
        return refusal(RefusalCode::AlreadyExists, path + " is there already");
    }
    file->identity_ = identity;
    file->begin();
    file->create_tables();
    file->write_identity(identity);
    return file;
}

Result<std::unique_ptr<RunFile>> RunFile::create(const std::string& path, const RunIdentity& identity,
                                                 const Options& options, const GenerationBegun* beginning,
                                                 const Checkpoint* checkpoint, const Inherited* inherited) {
    std::error_code error;
    if (std::filesystem::exists(path, error)) {
        return refusal(RefusalCode::AlreadyExists, path + " is there already");
    }
    const std::string next = DataFolder::next_file_of(path);
    if (auto swept = remove(next); !swept) { // what somebody left who did not come to the end of it
        return swept.error();
    }
    auto file = begin_new(next, identity, options);
    if (!file) {
        return file.error();
    }
    if (beginning != nullptr) {
        (*file)->write(*beginning);
    }
    if (checkpoint != nullptr) {
        (*file)->write(*checkpoint);
    }
    if (inherited != nullptr) {
        (*file)->write(*inherited);
    }
    if (auto committed = (*file)->commit(); !committed) {
        return committed.error();
    }
    if (auto settled = (*file)->settle(); !settled) {
        return settled.error();
    }
    file->reset();
    if (auto named = rename(next, path); !named) {
        return named.error();
    }
    return open(path, options);
}

void RunFile::copy_log(const std::string& path, const Options& options) {
    Database file{path, Database::Mode::Write, options.vfs};
    (void)file.number("SELECT count(*) FROM sqlite_schema"); // before which it does not look for a log
    file.copy_log();
}

Result<void> RunFile::settle() {
    if (database_.number("PRAGMA wal_checkpoint(TRUNCATE)") != 0) {
        return refusal(RefusalCode::Unavailable, path_ + " is being read by somebody");
    }
    if (database_.failed()) {
        return failure();
    }
    return {};
}

bool RunFile::holds_nothing() {
    return database_.number("PRAGMA application_id") == 0 &&
           database_.number("SELECT count(*) FROM sqlite_schema") == 0 && !database_.failed();
}

Result<bool> RunFile::holds_nothing(const std::string& path) {
    RunFile file{path, Database::Mode::Write, {}};
    const bool nothing = file.holds_nothing();
    if (file.database_.failed()) {
        return file.failure();
    }
    return nothing;
}

namespace {

/// A file, with one name: two servers might write to one that has two, for neither sees the other's lock, and each has
/// a log of its own.
Result<void> expect_file_with_one_name(const std::string& path) {
    struct stat status {};
    if (::lstat(path.c_str(), &status) != 0) {
        return {}; // opening it says why
    }
    if (S_ISDIR(status.st_mode)) {
        return refusal(RefusalCode::InvalidArgument, path + ": this is a folder, not a run file; move it out of " +
                                                         std::filesystem::path{path}.parent_path().string() +
                                                         " to start without its world");
    }
    if (S_ISLNK(status.st_mode)) {
        return refusal(RefusalCode::FailedPrecondition,
                       path + " is a link, and what it leads to may be another server's: put a copy in its place, or "
                              "name the folder of the file itself with --data");
    }
    if (!S_ISREG(status.st_mode)) {
        return refusal(RefusalCode::InvalidArgument,
                       path + ": this is " + std::string{files::other_than_file(status.st_mode)} + ", not a run file");
    }
    if (status.st_nlink > 1) {
        return refusal(RefusalCode::FailedPrecondition,
                       path + " has another name, a hard link, under which another server may write to it: remove "
                              "that name, or put a copy in the place of this one");
    }
    return {};
}

} // namespace

Result<std::unique_ptr<RunFile>> RunFile::open(const std::string& path, const Options& options) {
    if (auto there = expect_bytes(path); !there) {
        return there.error();
    }
    if (auto one = expect_file_with_one_name(path); !one) {
        return one.error();
    }
    if (auto sound = check_log(path, LogIndex::Unread); !sound) { // past a damaged frame SQLite would read nothing
        return sound.error();
    }
    std::unique_ptr<RunFile> file{new RunFile{path, Database::Mode::Write, options}};
    if (auto read = file->read_identity(); !read) {
        return read.error();
    }
    file->marked_ = true;
    if (file->thinning_.until_generation > 0) { // perhaps not to its end
        file->sweep_ = Sweep{};
    }
    return file;
}

Result<void> RunFile::rename(const std::string& from, const std::string& to) {
    namespace fs = std::filesystem;
    std::error_code error, ignored;
    // While somebody reads, what was committed last may be in the log alone. So the file has it beside it under both
    // names in between, where links can be made.
    struct Companion {
        const char* suffix;
        bool there = false, linked = false;
    };
    Companion companions[] = {{"-wal"}, {"-shm"}};
    for (Companion& companion : companions) {
        fs::remove(to + companion.suffix, ignored);
        companion.there = fs::exists(from + companion.suffix, ignored);
        fs::create_hard_link(from + companion.suffix, to + companion.suffix, error);
        companion.linked = !error;
    }
    fs::rename(from, to, error);
    if (error) {
        for (const Companion& companion : companions) {
            fs::remove(to + companion.suffix, ignored);
        }
        return refusal(RefusalCode::Unavailable, from + " cannot be renamed to " + to + ": " + error.message());
    }
    for (const Companion& companion : companions) {
        if (companion.there && !companion.linked) {
            fs::rename(from + companion.suffix, to + companion.suffix, ignored);
        } else {
            fs::remove(from + companion.suffix, ignored);
        }
    }
    return {};
}

Result<void> RunFile::remove(const std::string& path) {
    std::error_code error, ignored;
    std::filesystem::remove(path, error);
    if (error) {
        return refusal(RefusalCode::Unavailable, path + " cannot be removed: " + error.message());
    }
    for (const char* suffix : {"-wal", "-shm", "-journal"}) {
        std::filesystem::remove(path + suffix, ignored);
    }
    return {};
}

Result<std::unique_ptr<RunFile>> RunFile::open_read_only(const std::string& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!exists(status)) {
        return refusal(RefusalCode::NotFound, path + ": there is no such file");
    }
    struct stat about {};
    if (::stat(path.c_str(), &about) == 0 && !S_ISREG(about.st_mode)) {
        return refusal(RefusalCode::InvalidArgument,
                       path + ": this is " + std::string{files::other_than_file(about.st_mode)} + ", not a run file");
    }
    if (auto there = expect_bytes(path); !there) {
        return there.error();
    }
    std::unique_ptr<RunFile> file{new RunFile{path, Database::Mode::Read, {}}};
    auto read = file->read_identity();
    // Whoever reads takes part in the log beside the file, so SQLite has to write there. Where that cannot be, a file
    // with nothing in its log is read by itself.
    const auto log_bytes = std::filesystem::file_size(path + "-wal", error);
    if (!read && read.error().code == RefusalCode::Unavailable && (error || log_bytes == 0)) {
        file.reset(new RunFile{path, Database::Mode::ReadAtRest, {}});
        read = file->read_identity();
    }
    if (!read) {
        return read.error();
    }
    return file;
}

Result<std::unique_ptr<RunFile>> RunFile::open_checked(const std::string& path) {
    if (auto sound = check_log(path, LogIndex::Read); !sound) {
        return sound.error();
    }
    return open_read_only(path);
}

void RunFile::create_tables() {
    database_.run(("PRAGMA application_id = " + std::to_string(application_id)).c_str());
    database_.run(("PRAGMA user_version = " + std::to_string(format_version)).c_str());
    create_all_tables(database_);
}

Result<void> RunFile::check_schema() {
    const Schema expected = schema_of_format(format_);
    Schema found;
    for (Statement rows{database_, all_of_schema}; rows.row();) {
        SchemaRow row = read_schema_row(rows);
        if (!expected.contains(row)) {
            return refusal(RefusalCode::DataLoss, path_ + " is not as evod wrote it: " + described(row) +
                                                      " is none of a run file's, and could change what is read");
        }
        found.insert(std::move(row));
    }
    if (database_.failed()) {
        return failure();
    }
    for (auto row = expected.rbegin(); row != expected.rend(); ++row) { // a table before its indices
        if (!found.contains(*row) && row->table != optional_table) {
            return refusal(RefusalCode::DataLoss, path_ + " is damaged: it lacks " + described(*row));
        }
    }
    return {};
}

void RunFile::bring_up_to_date() {
    if (format_ == format_version) {
        return;
    }
    if (format_ < 3) {
        bring_up_to_format_3();
    }
    bring_up_to_format_4();
    database_.run(("PRAGMA user_version = " + std::to_string(format_version)).c_str());
    format_ = format_version;
}

void RunFile::bring_up_to_format_3() {
    RowWriter run{database_, "run", run_columns};
    if (format_ < 2) {
        database_.run(checkpoint_table);
        run.text("first_tick").text(std::to_string(identity_.first_tick)).finish();
    }
    database_.run(statistics_table(inherited_statistics).c_str());
    run.text("inherited_generations").text("0").finish();
    database_.run(founders_table);
    RowWriter founders{database_, "founders", founders_columns};
    for (Statement born{database_, "SELECT generation, island FROM population"}; born.row();) {
        founders.integer(born.integer(0)).integer(born.integer(1)).bytes({}).finish(); // nobody knows
    }
}

void RunFile::bring_up_to_format_4() {
    RowWriter{database_, "run", run_columns}.text("schedule").text(parameters::to_schedule_text({})).finish();
    database_.run(part_table);
    database_.run(account_table_ddl().c_str());
    RowWriter accounts{database_, account_table, account_columns};
    for (Statement known{database_, "SELECT generation, island FROM population "
                                    "UNION SELECT generation, island FROM statistics "
                                    "UNION SELECT generation, island FROM inherited_statistics"};
         known.row();) {
        write_account(accounts, known.integer(0), known.integer(1), std::nullopt); // nobody knows
    }
}

void RunFile::write_identity(const RunIdentity& identity) {
    RowWriter run{database_, "run", run_columns};
    const auto put = [&](std::string_view key, const std::string& value) { run.text(key).text(value).finish(); };
    put("name", identity.name);
    put("run_id", to_text(identity.run_id));
    put("seed", std::to_string(identity.seed.value));
    put("parameters", to_experiment_text(identity.parameters, parameters::Written::Everything));
    put("evod_version", identity.evod_version);
    put("build", identity.build);
    put("model_version", std::to_string(identity.model_version));
    put("began_unix_ms", std::to_string(identity.began_unix_ms));
    put("first_generation", std::to_string(identity.first_generation));
    put("first_tick", std::to_string(identity.first_tick));
    put("forked_from", identity.forked_from ? to_text(*identity.forked_from) : "");
    put("inherited_generations", std::to_string(identity.inherited_generations));
    put("schedule", to_schedule_text(identity.schedule));
    put("keep_every", std::to_string(keep_every_));
    if (!identity.first_population) {
        return;
    }
    RowWriter first_population{database_, "first_population", first_population_columns};
    for (std::size_t island = 0; island < identity.first_population->size(); ++island) {
        const evolution::GeneMatrix& genes = (*identity.first_population)[island];
        first_population.natural(island).integer(genes.cols()).bytes(bytes_of(genes)).finish();
    }
}

Result<void> RunFile::read_identity() {
    database_.run("BEGIN"); // a server may bring the file to another format meanwhile
    const std::int64_t application = database_.number("PRAGMA application_id");
    const std::int64_t format = format_ = database_.number("PRAGMA user_version");
    if (database_.failed()) {
        return failure();
    }
    if (holds_nothing()) {
        return emptied(path_);
    }
    if (application != application_id) {
        return refusal(RefusalCode::InvalidArgument, path_ + " is not a run file of evod");
    }
    if (format > format_version) {
        return refusal(RefusalCode::FailedPrecondition, path_ + " was written by a newer evod: its format is version " +
                                                            std::to_string(format) + ", this evod reads up to " +
                                                            std::to_string(format_version));
    }
    // Before anything else is read: a view or a trigger may have the name of a table, or hang on one.
    if (auto sound = check_schema(); !sound) {
        return sound;
    }
    // SQLite takes a last page that has been cut for one that ends in zeros. Where there is a write-ahead log, the page
    // may be whole there.
    const auto size_of = [](const std::string& path) {
        std::error_code error;
        const auto size = std::filesystem::file_size(path, error);
        return error ? 0 : static_cast<std::int64_t>(size);
    };
    const std::int64_t page_size = database_.number("PRAGMA page_size");
    if (page_size > 0 && size_of(path_) % page_size != 0 && size_of(path_ + "-wal") == 0) {
        return damaged("its last page");
    }
    RowReader run{database_, "run", run_columns};
    identity_.build.clear(); // older files do not tell
    std::size_t known = 0;
    while (run.next()) {
        const std::string key = run.text(), value = run.text();
        if (!run.sound()) {
            return damaged("the row \"" + key + "\" of its table run");
        }
        bool good = true;
        const auto take = [&]<class T>(std::optional<T> read, T& to) {
            good = read.has_value();
            to = read.value_or(T{});
        };
        if (key == "name") {
            identity_.name = value;
        } else if (key == "run_id") {
            take(run_id_from(value), identity_.run_id);
        } else if (key == "forked_from") {
            identity_.forked_from = run_id_from(value);
            good = value.empty() || identity_.forked_from;
        } else if (key == "first_generation") {
            take(number_from<std::uint64_t>(value), identity_.first_generation);
        } else if (key == "first_tick") {
            take(number_from<std::uint64_t>(value), identity_.first_tick);
        } else if (key == "inherited_generations") {
            take(number_from<std::uint64_t>(value), identity_.inherited_generations);
        } else if (key == "seed") {
            take(number_from<std::uint64_t>(value), identity_.seed.value);
        } else if (key == "parameters") {
            const auto experiment = parameters::parse_experiment(value);
            good = experiment.has_value();
            if (good) {
                identity_.parameters = experiment->parameters;
            }
        } else if (key == "schedule") {
            const auto schedule = parameters::parse_schedule(value);
            good = schedule.has_value();
            if (good) {
                identity_.schedule = *schedule;
            }
        } else if (key == "evod_version") {
            identity_.evod_version = value;
        } else if (key == "build") {
            identity_.build = value;
            continue;
        } else if (key == "model_version") {
            take(number_from<std::uint32_t>(value), identity_.model_version);
        } else if (key == "began_unix_ms") {
            take(number_from<std::int64_t>(value), identity_.began_unix_ms);
        } else if (key == "keep_every") { // not in files of before there was a choice
            take(number_from<std::uint64_t>(value), keep_every_);
            if (!good || keep_every_ == 0) {
                return damaged("the row \"" + key + "\" of its table run");
            }
            continue;
        } else {
            continue;
        }
        ++known;
        if (!good) {
            return damaged("the row \"" + key + "\" of its table run");
        }
    }
    if (database_.failed()) {
        return failure();
    }
    const std::size_t keys = format < 2 ? 9 : format < 3 ? 10 : format < 4 ? 11 : 12;
    if (known != keys || !begins_with_its_schedule(identity_) ||
        identity_.inherited_generations >= std::max<std::uint64_t>(identity_.first_generation, 1)) {
        return damaged("its table run");
    }
    if (format < 2) {
        identity_.first_tick = static_cast<std::uint64_t>(database_.number(
            ("SELECT first_tick FROM generation WHERE generation = " + std::to_string(identity_.first_generation))
                .c_str()));
    }
    if (auto read = read_first_population(); !read) {
        return read;
    }
    if (auto read = read_thinning(); !read) {
        return read;
    }
    database_.run("COMMIT");
    if (database_.failed()) {
        return failure();
    }
    return {};
}

Result<void> RunFile::read_first_population() {
    if (database_.number("SELECT count(*) FROM sqlite_schema WHERE name = 'first_population'") == 0) {
        return {};
    }
    std::vector<evolution::GeneMatrix> islands;
    RowReader rows{database_, "first_population", first_population_columns, "1 ORDER BY island"};
    while (rows.next()) {
        const std::uint64_t island = rows.natural(), organisms = rows.natural();
        const std::string chromosomes = rows.bytes();
        if (!rows.sound() || island != islands.size() || !read_into(islands.emplace_back(), organisms, chromosomes)) {
            return damaged(row_of("first_population", island));
        }
    }
    if (database_.failed()) {
        return failure();
    }
    if (islands.empty()) {
        return {};
    }
    identity_.first_population = std::make_shared<const std::vector<evolution::GeneMatrix>>(std::move(islands));
    // A fork does not begin with it.
    if (identity_.first_generation == 1 &&
        !simulation::faults_of(identity_.first_population, identity_.parameters, "first_population").empty()) {
        return damaged("its table first_population");
    }
    return {};
}

Result<void> RunFile::read_thinning() {
    RowReader thinned{database_, "thinned", thinned_columns, "1 ORDER BY number"};
    for (std::uint64_t number = 1; thinned.next(); ++number) {
        const bool in_order = thinned.natural() == number;
        thinning_ = {
            .keep_every = thinned.natural(), .until_generation = thinned.natural(), .until_tick = thinned.natural()};
        constexpr std::uint64_t keep_every_max = std::uint64_t{1} << 40; // more than doublings can come to
        if (!thinned.sound() || !in_order || thinning_.keep_every == 0 || thinning_.keep_every > keep_every_max) {
            return damaged(row_of("thinned", number));
        }
    }
    if (database_.failed()) {
        return failure();
    }
    return {};
}

bool RunFile::is_held(std::uint64_t generation) {
    const std::uint64_t place = generation - identity_.first_generation;
    if (generation <= thinning_.until_generation) {
        return place % thinning_.keep_every == 0;
    }
    return place % keep_every_ == 0 || generation >= last_generation();
}

bool RunFile::is_link_held(std::uint64_t tick) const {
    return tick > thinning_.until_tick || tick / ticks_per_link % thinning_.keep_every == 0;
}

std::uint64_t RunFile::next_link_held(std::uint64_t after) const {
    const std::uint64_t next = after / ticks_per_link + 1, keep_every = thinning_.keep_every;
    const std::uint64_t kept = (next + keep_every - 1) / keep_every * keep_every;
    const std::uint64_t thinned = thinning_.until_tick / ticks_per_link;
    return (kept <= thinned ? kept : std::max(next, thinned + 1)) * ticks_per_link;
}

std::uint64_t RunFile::held_at_or_before(std::uint64_t generation) {
    if (is_held(generation)) {
        return generation;
    }
    const auto step_back = [&](std::uint64_t keep_every) {
        generation -= (generation - identity_.first_generation) % keep_every;
    };
    step_back(keep_every_);
    if (generation <= thinning_.until_generation) {
        step_back(thinning_.keep_every);
    }
    return generation;
}

std::uint64_t RunFile::held_at_or_after(std::uint64_t generation) {
    const std::uint64_t first = identity_.first_generation, until = thinning_.until_generation;
    const auto step_on = [first](std::uint64_t from, std::uint64_t keep_every) {
        return first + (from - first + keep_every - 1) / keep_every * keep_every;
    };
    std::uint64_t held = generation <= until ? step_on(generation, thinning_.keep_every) : generation;
    if (held > until) {
        held = step_on(std::max(generation, until + 1), keep_every_);
    }
    return std::min(held, last_generation());
}

std::optional<Refusal> RunFile::other_model() const {
    if (identity_.model_version == simulation::model_version) {
        return std::nullopt;
    }
    return refusal(RefusalCode::FailedPrecondition,
                   path_ + " was made with evod " + identity_.evod_version + ", which followed version " +
                       std::to_string(identity_.model_version) + " of the model; this evod " + EVOD_VERSION +
                       " follows version " + std::to_string(simulation::model_version) +
                       ", so it can read the file (`evod export`) but not simulate the run again");
}

Result<std::optional<EndMark>> RunFile::end_mark() {
    RowReader end{database_, "end_mark", end_columns};
    std::optional<EndMark> mark;
    if (end.next()) {
        (void)end.integer();
        mark.emplace();
        mark->ended = end.text() == "ended";
        mark->tick = end.natural();
        mark->journal_entries = end.natural();
        mark->generations = end.natural();
        mark->links = end.natural();
        if (!end.sound()) {
            return damaged("its end mark");
        }
    }
    if (database_.failed()) {
        return failure();
    }
    return mark;
}

Result<void> RunFile::check_tree(const std::string& of) {
    Statement integrity{database_, "PRAGMA integrity_check(" + of + ")"};
    if (integrity.row()) {
        if (const std::string verdict = integrity.text(0); verdict != "ok") {
            return refusal(RefusalCode::DataLoss, path_ + " is damaged: " + verdict);
        }
    }
    return {};
}

Result<void> RunFile::check_end_mark() {
    const auto mark = end_mark();
    if (!mark) {
        return mark.error();
    }
    const EndMark found = contents();
    if (*mark && ((*mark)->tick != found.tick || (*mark)->generations != found.generations ||
                  (*mark)->links != found.links || (*mark)->journal_entries != found.journal_entries)) {
        return damaged("what stands before its end mark");
    }
    if (database_.failed()) {
        return failure();
    }
    return {};
}

Result<std::vector<JournalEntry>> RunFile::journal(std::uint64_t first, std::uint32_t count) {
    // That the last entries are gone, no other row tells.
    if (first == 1) {
        if (auto sound = check_tree("journal"); !sound) {
            return sound.error();
        }
    }
    std::vector<JournalEntry> entries;
    RowReader reader{database_,
                     "journal",
                     journal_columns,
                     "number >= ? ORDER BY number LIMIT ?",
                     {static_cast<std::int64_t>(first), count}};
    while (reader.next()) {
        JournalEntry entry;
        entry.number = reader.natural();
        entry.tick = reader.natural();
        entry.origin.client = reader.text();
        entry.origin.client_key = reader.text();
        entry.origin.request_id = reader.natural();
        entry.origin.request = reader.bytes();
        entry.answer = reader.bytes();
        entry.control.endless = reader.integer() != 0;
        entry.control.until_generation = as_read(reader.optional_integer());
        entry.control.until_tick = as_read(reader.optional_integer());
        const std::int64_t paused = reader.integer();
        entry.control.paused = paused != 0;
        entry.control.leased = paused == 2;
        entry.control.speed = reader.optional_real();
        if (!reader.sound() || entry.number != first + entries.size()) {
            return damaged(row_of("journal", first + entries.size()));
        }
        entries.push_back(std::move(entry));
    }
    if (database_.failed()) {
        return failure();
    }
    return entries;
}

Result<void> RunFile::hold_still() {
    database_.run("BEGIN");
    return read_thinning(); // what holds now
}

std::uint64_t RunFile::last_journal_entry() {
    return static_cast<std::uint64_t>(database_.number("SELECT max(number) FROM journal"));
}

Result<void> RunFile::copy_to(const std::string& path) {
    database_.copy_to(path);
    if (database_.failed()) {
        return failure();
    }
    return {};
}

std::uint64_t RunFile::last_generation() {
    return static_cast<std::uint64_t>(database_.number("SELECT max(generation) FROM generation"));
}

std::uint64_t RunFile::generation_at(std::uint64_t tick) {
    const std::string sql = "SELECT max(generation) FROM generation WHERE first_tick < " + std::to_string(tick);
    return std::max(identity_.first_generation, static_cast<std::uint64_t>(database_.number(sql.c_str())));
}

Result<parameters::ParameterSet> RunFile::parameter_set(std::int64_t number) {
    // Most generations have those of the one before.
    if (read_parameters_ && read_parameters_number_ == number) {
        return *read_parameters_;
    }
    RowReader reader{database_, "parameters", parameters_columns, "number = ?", {number}};
    const auto bad = [&] { return damaged(row_of("parameters", static_cast<std::uint64_t>(number))); };
    if (!reader.next()) {
        return bad();
    }
    (void)reader.integer();
    parameters::ParameterSet set;
    set.revision = reader.natural();
    const auto active = parameters::parse_experiment(reader.text());
    const auto requested = parameters::parse_experiment(reader.text());
    if (!reader.sound() || !active || !requested) {
        return bad();
    }
    set.active = active->parameters;
    set.requested = requested->parameters;
    read_parameters_ = set;
    read_parameters_number_ = number;
    return set;
}

Result<std::optional<simulation::Opening>> RunFile::opening_of(std::uint64_t generation) {
    RowReader reader{
        database_, "generation", generation_columns, "generation = ?", {static_cast<std::int64_t>(generation)}};
    if (!reader.next()) {
        if (database_.failed()) {
            return failure();
        }
        return std::optional<simulation::Opening>{};
    }
    simulation::Opening opening;
    opening.moment.generation = reader.natural();
    opening.moment.tick = reader.natural();
    opening.moment.simulated_s = reader.real();
    const std::int64_t parameters = reader.integer();
    opening.progress.generations = reader.natural();
    opening.progress.stagnant = reader.natural();
    opening.progress.best_fitness = reader.real();
    opening.progress.last_best_fitness = reader.real();
    opening.progress.last_died_out = reader.integer() != 0;
    if (!reader.sound()) {
        return damaged(row_of("generation", generation));
    }
    const auto set = parameter_set(parameters);
    if (!set) {
        return set.error();
    }
    opening.parameters = *set;
    return opening;
}

Result<std::vector<evolution::NextGeneration>> RunFile::born_in(const simulation::Opening& opening) {
    std::vector<evolution::NextGeneration> islands;
    RowReader rows{database_,
                   "population",
                   population_columns,
                   "generation = ? ORDER BY island",
                   {static_cast<std::int64_t>(opening.moment.generation)}};
    const auto bad = [&] {
        return damaged("the population of generation " + std::to_string(opening.moment.generation) + " on island " +
                       std::to_string(islands.size()));
    };
    while (rows.next()) {
        (void)rows.integer();
        const std::uint64_t island = rows.natural(), organisms = rows.natural();
        evolution::NextGeneration born;
        born.elite_count = static_cast<std::uint32_t>(rows.integer());
        born.survivor_count = static_cast<std::uint32_t>(rows.integer());
        born.clamped_count = rows.natural();
        const std::string genes = rows.bytes(), parents = rows.bytes();
        if (!rows.sound() || island != islands.size() || !read_into(born.genes, organisms, genes) ||
            !read_into(born.parents, parents) ||
            (!born.parents.empty() && born.parents.size() != organisms)) { // the first generation has none
            return bad();
        }
        islands.push_back(std::move(born));
    }
    if (database_.failed()) {
        return failure();
    }
    if (islands.size() != opening.parameters.active.island_count) {
        return bad();
    }
    return islands;
}

Result<simulation::Founders> RunFile::founders_of(const GenerationBegun& begun) {
    simulation::Founders islands;
    if (format_ < 3) {
        return islands;
    }
    const std::uint64_t generation = begun.opening.moment.generation;
    const auto bad = [&] { return damaged("the founders of generation " + std::to_string(generation)); };
    RowReader rows{database_,
                   "founders",
                   founders_columns,
                   "generation = ? ORDER BY island",
                   {static_cast<std::int64_t>(generation)}};
    bool known = true;
    while (rows.next()) {
        (void)rows.integer();
        const std::uint64_t island = rows.natural();
        const std::string founders = rows.bytes();
        if (!rows.sound() || island != islands.size() || island >= begun.born.size() ||
            !read_into(islands.emplace_back(), founders)) {
            return bad();
        }
        known &= islands.back().size() == static_cast<std::size_t>(begun.born[island].genes.cols());
        if (!known && !founders.empty()) {
            return bad();
        }
    }
    if (database_.failed()) {
        return failure();
    }
    if (islands.size() != begun.born.size()) {
        return bad();
    }
    return known ? std::move(islands) : simulation::Founders{};
}

Result<RunFile::Accounts> RunFile::accounts_of(std::uint64_t generation, std::size_t island_count) {
    Accounts islands;
    if (format_ < 4) {
        return Accounts(island_count);
    }
    const auto bad = [&] { return damaged(accounts_of_generation(generation)); };
    RowReader rows{database_,
                   account_table,
                   account_columns,
                   "generation = ? ORDER BY island",
                   {static_cast<std::int64_t>(generation)}};
    while (rows.next()) {
        (void)rows.integer();
        const std::uint64_t island = rows.natural();
        islands.push_back(evolution::account_from([&] { return rows.optional_real(); }));
        if (!rows.sound() || island + 1 != islands.size()) {
            return bad();
        }
    }
    if (database_.failed()) {
        return failure();
    }
    if (islands.size() != island_count) {
        return bad();
    }
    return islands;
}

Result<std::optional<GenerationBegun>> RunFile::beginning_of(std::uint64_t generation) {
    auto opening = opening_of(generation);
    if (!opening) {
        return opening.error();
    }
    if (!*opening || !is_held(generation)) {
        return std::optional<GenerationBegun>{};
    }
    auto born = born_in(**opening);
    if (!born) {
        return born.error();
    }
    GenerationBegun begun{.opening = **opening, .born = *std::move(born)};
    auto founders = founders_of(begun);
    if (!founders) {
        return founders.error();
    }
    begun.founders = *std::move(founders);
    const auto accounts = accounts_of(generation, begun.born.size());
    if (!accounts) {
        return accounts.error();
    }
    for (std::size_t island = 0; island < accounts->size(); ++island) {
        begun.born[island].account = (*accounts)[island];
    }
    return std::optional{std::move(begun)};
}

Result<std::optional<GenerationEnded>> RunFile::outcome_of(std::uint64_t generation) {
    const auto key = static_cast<std::int64_t>(generation);
    GenerationEnded ended{.generation = generation, .outcomes = {}, .statistics = {}};
    const auto bad = [&] { return damaged("the outcome of generation " + std::to_string(generation)); };
    RowReader rows{database_, "outcome", outcome_columns, "generation = ? ORDER BY island", {key}};
    while (rows.next()) {
        (void)rows.integer();
        const std::uint64_t island = rows.natural();
        IslandOutcome outcome;
        const std::string fitness = rows.bytes(), lived = rows.bytes(), cause = rows.bytes();
        if (!rows.sound() || island != ended.outcomes.size() || !read_into(outcome.fitness, fitness) ||
            !read_into(outcome.lived_ticks, lived) || !read_into(outcome.cause, cause) ||
            outcome.lived_ticks.size() != outcome.fitness.size() || outcome.cause.size() != outcome.fitness.size()) {
            return bad();
        }
        ended.outcomes.push_back(std::move(outcome));
    }
    if (database_.failed()) {
        return failure();
    }
    if (ended.outcomes.empty() && !is_held(generation)) {
        return std::optional<GenerationEnded>{};
    }
    auto statistics = statistics_of(generation);
    if (!statistics) {
        return statistics.error();
    }
    ended.statistics = *std::move(statistics);
    if (ended.outcomes.size() != ended.statistics.size()) {
        return bad();
    }
    if (ended.outcomes.empty()) {
        return std::optional<GenerationEnded>{};
    }
    return ended;
}

Result<std::vector<simulation::GenerationStatistics>> RunFile::statistics_of(std::uint64_t generation) {
    std::vector<simulation::GenerationStatistics> statistics;
    RowReader rows{database_,
                   "statistics",
                   statistics_columns(),
                   "generation = ? ORDER BY island",
                   {static_cast<std::int64_t>(generation)}};
    while (rows.next()) {
        const simulation::GenerationStatistics island = read_statistics(rows);
        if (!rows.sound() || island.island != statistics.size()) {
            return damaged("a row of the statistics of generation " + std::to_string(generation));
        }
        statistics.push_back(island);
    }
    if (database_.failed()) {
        return failure();
    }
    if (statistics.empty()) {
        return statistics;
    }
    const auto accounts = accounts_of(generation, statistics.size());
    if (!accounts) {
        return accounts.error();
    }
    for (std::size_t island = 0; island < statistics.size(); ++island) {
        statistics[island].account = (*accounts)[island];
    }
    return statistics;
}

Result<simulation::World::History> RunFile::history(std::uint64_t before, std::size_t count) {
    simulation::World::History history;
    const std::uint64_t own = identity_.first_generation;
    const std::uint64_t first =
        std::max(own - identity_.inherited_generations, before - std::min<std::uint64_t>(before, count));
    if (first < own) {
        if (auto read = read_history(inherited_statistics, first, std::min(own, before), history); !read) {
            return read.error();
        }
        if (first + history.size() < std::min(own, before)) {
            return damaged(row_of(inherited_statistics, first + history.size()));
        }
    }
    if (auto read = read_history("statistics", std::max(first, own), before, history); !read) {
        return read.error();
    }
    if (first + history.size() < std::min(before, last_generation())) { // all before the last have ended
        return damaged(row_of("statistics", first + history.size()));
    }
    return history;
}

Result<void> RunFile::read_history(const char* table, std::uint64_t first, std::uint64_t end,
                                   simulation::World::History& history) {
    RowReader numbers{database_,
                      table,
                      statistics_columns(),
                      "generation >= ? AND generation < ? ORDER BY generation, island",
                      {static_cast<std::int64_t>(first), static_cast<std::int64_t>(end)}};
    // Beside it, the accounts of the same generations, and of one more if the last has not ended.
    std::optional<RowReader> accounts;
    if (format_ >= 4) {
        accounts.emplace(database_, account_table, account_columns,
                         "generation >= ? AND generation < ? ORDER BY generation, island",
                         std::vector{static_cast<std::int64_t>(first), static_cast<std::int64_t>(end)});
    }
    std::uint64_t expected = first;
    std::vector<simulation::GenerationStatistics> rows; // of that generation
    while (numbers.next()) {
        simulation::GenerationStatistics statistics = read_statistics(numbers);
        if (statistics.island == 0 && !rows.empty()) {
            history.emplace_back(std::exchange(rows, {}));
            ++expected;
        }
        if (!numbers.sound() || statistics.generation != expected || statistics.island != rows.size()) {
            return damaged(row_of(table, expected));
        }
        if (accounts) {
            const bool there =
                accounts->next() && accounts->natural() == expected && accounts->natural() == statistics.island;
            if (there) {
                statistics.account = evolution::account_from([&] { return accounts->optional_real(); });
            }
            if (!there || !accounts->sound()) {
                return damaged(accounts_of_generation(expected));
            }
        }
        rows.push_back(statistics);
    }
    if (!rows.empty()) {
        history.emplace_back(std::move(rows));
    }
    if (database_.failed()) {
        return failure();
    }
    return {};
}

Result<std::vector<HashLink>> RunFile::links(std::uint64_t after, std::uint64_t until) {
    std::vector<HashLink> links;
    RowReader reader{database_,
                     "state_hash",
                     link_columns,
                     "tick > ? AND tick <= ? ORDER BY tick",
                     {static_cast<std::int64_t>(after), static_cast<std::int64_t>(until)}};
    while (reader.next()) {
        HashLink link;
        link.tick = reader.natural();
        link.hash.low = reader.natural();
        link.hash.high = reader.natural();
        if (!reader.sound()) {
            return damaged(row_of("state_hash", link.tick));
        }
        if (is_link_held(link.tick)) { // or it is about to be taken out
            links.push_back(link);
        }
    }
    if (database_.failed()) {
        return failure();
    }
    return links;
}

Result<std::string> RunFile::parts_of(std::uint64_t tick, std::vector<std::int64_t>& checksums) {
    std::string bytes;
    if (format_ < 4) {
        return bytes;
    }
    RowReader parts{
        database_, "checkpoint_part", part_columns, "tick = ? ORDER BY part", {static_cast<std::int64_t>(tick)}};
    while (parts.next()) {
        (void)parts.integer();
        const std::uint64_t part = parts.natural(), expected = checksums.size() + 1;
        bytes += parts.bytes();
        checksums.push_back(parts.checksum());
        if (!parts.sound() || part != expected) {
            return damaged("part " + std::to_string(expected) + " of " + row_of("checkpoint", tick));
        }
    }
    if (database_.failed()) {
        return failure();
    }
    return bytes;
}

Result<std::vector<StoredCheckpoint>> RunFile::checkpoints_where(const std::string& condition,
                                                                 const std::vector<std::int64_t>& where) {
    std::vector<StoredCheckpoint> found;
    if (format_ < 2) {
        return found;
    }
    RowReader reader{database_, "checkpoint", checkpoint_columns, condition, where};
    while (reader.next()) {
        StoredCheckpoint checkpoint;
        checkpoint.moment.tick = reader.natural();
        checkpoint.moment.generation = reader.natural();
        checkpoint.moment.generation_tick = reader.natural();
        checkpoint.moment.simulated_s = reader.real();
        const std::int64_t parameters = reader.integer();
        checkpoint.journal_entries = reader.natural();
        checkpoint.hash.low = reader.natural();
        checkpoint.hash.high = reader.natural();
        // As long as its row is being read, a server takes none of its parts away.
        std::vector<std::int64_t> checksums;
        auto parts = parts_of(checkpoint.moment.tick, checksums);
        if (!parts) {
            return parts.error();
        }
        for (const std::int64_t checksum : checksums) {
            reader.covers(checksum);
        }
        checkpoint.state = *std::move(parts) + reader.bytes();
        if (!reader.sound()) {
            return damaged(row_of("checkpoint", checkpoint.moment.tick));
        }
        const auto set = parameter_set(parameters);
        if (!set) {
            return set.error();
        }
        checkpoint.parameters = *set;
        found.push_back(std::move(checkpoint));
    }
    if (database_.failed()) {
        return failure();
    }
    return found;
}

Result<std::vector<StoredCheckpoint>> RunFile::checkpoints(std::uint64_t after, std::uint64_t until) {
    return checkpoints_where("tick > ? AND tick <= ? ORDER BY tick",
                             {static_cast<std::int64_t>(after), static_cast<std::int64_t>(until)});
}

Result<std::optional<StoredCheckpoint>> RunFile::last_checkpoint(std::uint64_t until) {
    auto found = checkpoints_where("tick <= ? ORDER BY tick DESC LIMIT 1", {static_cast<std::int64_t>(until)});
    if (!found) {
        return found.error();
    }
    return found->empty() ? std::nullopt : std::optional{std::move(found->front())};
}

std::uint64_t RunFile::last_tick() {
    std::int64_t last = 0;
    // A generation that was bred is written down once its first tick is over; the run's first is there before.
    const std::string bred =
        "SELECT max(first_tick + 1) FROM generation WHERE generation > " + std::to_string(identity_.first_generation);
    for (const char* sql : {"SELECT tick FROM journal ORDER BY number DESC LIMIT 1", "SELECT max(tick) FROM state_hash",
                            "SELECT max(first_tick) FROM generation", bred.c_str(),
                            "SELECT max(end_tick) FROM statistics", "SELECT max(tick) FROM end_mark"}) {
        last = std::max(last, database_.number(sql));
    }
    if (format_ >= 2) {
        last = std::max(last, database_.number("SELECT max(tick) FROM checkpoint"));
    }
    return static_cast<std::uint64_t>(last);
}

EndMark RunFile::contents() {
    const auto count = [&](const char* sql) { return static_cast<std::uint64_t>(database_.number(sql)); };
    return {.ended = false,
            .tick = last_tick(),
            .journal_entries = count("SELECT count(*) FROM journal"),
            .generations = last_generation(),
            .links = count("SELECT count(*) FROM state_hash")};
}

std::uint64_t RunFile::last_generation_ended() {
    return static_cast<std::uint64_t>(database_.number("SELECT max(generation) FROM statistics"));
}

Result<void> RunFile::check(base::FunctionRef<void(std::uint64_t)> told) {
    if (auto sound = check_tree("1"); !sound) {
        return sound;
    }
    if (auto entries = journal(); !entries) {
        return entries.error();
    }
    if (auto inherited = history(identity_.first_generation, identity_.inherited_generations); !inherited) {
        return inherited.error();
    }
    const std::uint64_t last = last_generation();
    for (std::uint64_t generation = identity_.first_generation; generation <= last; ++generation) {
        told(generation);
        const auto begun = beginning_of(generation);
        if (!begun) {
            return begun.error();
        }
        const auto ended = outcome_of(generation);
        if (!ended) {
            return ended.error();
        }
        if (is_held(generation)) {
            if (!*begun) {
                return damaged(row_of("generation", generation));
            }
            if (!*ended && generation < last) {
                return damaged("the outcome of generation " + std::to_string(generation));
            }
            continue;
        }
        const auto opening = opening_of(generation);
        if (!opening) {
            return opening.error();
        }
        if (!*opening) {
            return damaged(row_of("generation", generation));
        }
        const auto statistics = statistics_of(generation);
        if (!statistics) {
            return statistics.error();
        }
        if (statistics->size() != (*opening)->parameters.active.island_count) {
            return damaged("the statistics of generation " + std::to_string(generation));
        }
    }
    const EndMark found = contents();
    constexpr std::uint64_t ticks_at_once = 100'000 * ticks_per_link;
    for (std::uint64_t next = next_link_held(identity_.first_tick); next <= found.tick;) {
        const auto chain = links(next - 1, std::min(found.tick, next + ticks_at_once));
        if (!chain) {
            return chain.error();
        }
        if (chain->empty()) {
            if (database_.number("SELECT max(tick) FROM state_hash") >= static_cast<std::int64_t>(next)) {
                return damaged(row_of("state_hash", next));
            }
            break; // whether the last are missing, the end mark tells
        }
        for (const HashLink& link : *chain) {
            if (link.tick != next) {
                return damaged(row_of("state_hash", next));
            }
            next = next_link_held(next);
        }
    }
    if (auto checked = check_checkpoints(found); !checked) {
        return checked;
    }
    return check_end_mark();
}

Result<void> RunFile::check_checkpoints(const EndMark& found) {
    if (format_ < 2) {
        return {};
    }
    bool begins_with_one = false;
    const std::int64_t newest = database_.number("SELECT max(tick) FROM checkpoint");
    for (std::int64_t after = -1; after < newest && !database_.failed();) {
        // One at a time, as they may be large.
        const auto next = checkpoints_where("tick > ? ORDER BY tick LIMIT 1", {after});
        if (!next) {
            return next.error();
        }
        if (next->empty()) {
            break;
        }
        const StoredCheckpoint& checkpoint = next->front();
        after = static_cast<std::int64_t>(checkpoint.moment.tick);
        const auto opening = opening_of(checkpoint.moment.generation);
        if (!opening) {
            return opening.error();
        }
        if (!*opening || !is_held(checkpoint.moment.generation) || checkpoint.moment.tick < identity_.first_tick ||
            (*opening)->moment.tick + checkpoint.moment.generation_tick != checkpoint.moment.tick ||
            checkpoint.moment.generation_tick == 0 || checkpoint.journal_entries > found.journal_entries) {
            return damaged(row_of("checkpoint", checkpoint.moment.tick));
        }
        begins_with_one |= checkpoint.moment.tick == identity_.first_tick;
    }
    const auto first = opening_of(identity_.first_generation);
    if (!first) {
        return first.error();
    }
    if (*first && (*first)->moment.tick < identity_.first_tick && !begins_with_one) {
        return damaged(row_of("checkpoint", identity_.first_tick));
    }
    return {};
}

RunFile::Writers& RunFile::writers() {
    if (!writers_) {
        writers_ = std::make_unique<Writers>(database_);
    }
    return *writers_;
}

void RunFile::begin() {
    database_.run("BEGIN IMMEDIATE");
    if (marked_) {
        database_.run("DELETE FROM end_mark");
    }
    bring_up_to_date();
}

void RunFile::write(const JournalEntry& entry) {
    writers()
        .journal.natural(entry.number)
        .natural(entry.tick)
        .text(entry.origin.client)
        .text(entry.origin.client_key)
        .natural(entry.origin.request_id)
        .bytes(std::as_bytes(std::span{entry.origin.request}))
        .bytes(std::as_bytes(std::span{entry.answer}))
        .integer(std::int64_t{entry.control.endless})
        .integer(as_stored(entry.control.until_generation))
        .integer(as_stored(entry.control.until_tick))
        .integer(std::int64_t{entry.control.paused} + entry.control.leased)
        .real(entry.control.speed)
        .finish();
}

std::int64_t RunFile::number_of(const parameters::ParameterSet& parameters) {
    if (parameter_sets_ == 0) {
        parameter_sets_ = database_.number("SELECT max(number) FROM parameters");
    }
    if (last_parameters_ && last_parameters_->revision == parameters.revision &&
        last_parameters_->active == parameters.active && last_parameters_->requested == parameters.requested) {
        return parameter_sets_;
    }
    using parameters::Written;
    writers()
        .parameters.integer(++parameter_sets_)
        .natural(parameters.revision)
        .text(to_experiment_text(parameters.active, Written::Everything))
        .text(to_experiment_text(parameters.requested, Written::Everything))
        .finish();
    last_parameters_ = parameters;
    return parameter_sets_;
}

void RunFile::write(const Inherited& inherited) {
    RowWriter statistics{database_, inherited_statistics, statistics_columns()};
    for (const simulation::GenerationRows& generation : inherited.history) {
        for (const simulation::GenerationStatistics& island : generation) {
            write_statistics(statistics, island);
            write_account(writers().account, static_cast<std::int64_t>(island.generation), island.island,
                          island.account);
        }
    }
}

void RunFile::write(const GenerationBegun& begun) {
    const simulation::Opening& opening = begun.opening;
    const std::int64_t parameters = number_of(opening.parameters);
    writers()
        .generation.natural(opening.moment.generation)
        .natural(opening.moment.tick)
        .real(opening.moment.simulated_s)
        .integer(parameters)
        .natural(opening.progress.generations)
        .natural(opening.progress.stagnant)
        .real(opening.progress.best_fitness)
        .real(opening.progress.last_best_fitness)
        .integer(std::int64_t{opening.progress.last_died_out})
        .finish();
    for (std::size_t island = 0; island < begun.born.size(); ++island) {
        const evolution::NextGeneration& born = begun.born[island];
        writers()
            .population.natural(opening.moment.generation)
            .natural(island)
            .integer(born.genes.cols())
            .natural(born.elite_count)
            .natural(born.survivor_count)
            .natural(born.clamped_count)
            .bytes(bytes_of(born.genes))
            .bytes(bytes_of(born.parents))
            .finish();
        writers()
            .founders.natural(opening.moment.generation)
            .natural(island)
            .bytes(begun.founders.empty() ? std::span<const std::byte>{} : bytes_of(begun.founders[island]))
            .finish();
        write_account(writers().account, static_cast<std::int64_t>(opening.moment.generation),
                      static_cast<std::int64_t>(island), born.account);
    }
    // The one before is the last no more.
    const std::uint64_t before = opening.moment.generation - 1;
    if (before <= identity_.first_generation || (before - identity_.first_generation) % keep_every_ == 0) {
        return;
    }
    for (const char* table : tables_of_held_generations) {
        database_.run(("DELETE FROM " + std::string{table} + " WHERE generation = " + std::to_string(before)).c_str());
    }
    tidy_ = false;
}

void RunFile::write(const GenerationEnded& ended) {
    for (std::size_t island = 0; island < ended.outcomes.size(); ++island) {
        const IslandOutcome& outcome = ended.outcomes[island];
        writers()
            .outcome.natural(ended.generation)
            .natural(island)
            .bytes(bytes_of(outcome.fitness))
            .bytes(bytes_of(outcome.lived_ticks))
            .bytes(bytes_of(outcome.cause))
            .finish();
    }
    for (const simulation::GenerationStatistics& statistics : ended.statistics) {
        write_statistics(writers().statistics, statistics);
    }
}

void RunFile::write(const HashLink& link) {
    writers().link.natural(link.tick).natural(link.hash.low).natural(link.hash.high).finish();
}

void RunFile::write(const Checkpoint& checkpoint) {
    if (!database_.failed() && is_held(checkpoint.state.moment.generation)) { // or packing would be for nothing
        write(pack(checkpoint));
    }
}

void RunFile::write(const StoredCheckpoint& checkpoint) {
    if (database_.failed() || !is_held(checkpoint.moment.generation)) {
        return;
    }
    HalfWritten half{.tick = checkpoint.moment.tick};
    while (!write_next(checkpoint, half)) {
    }
}

bool RunFile::has_checkpoint(std::uint64_t tick) {
    return database_.number(("SELECT count(*) FROM checkpoint WHERE tick = " + std::to_string(tick)).c_str()) != 0;
}

Result<bool> RunFile::write_part(const StoredCheckpoint& checkpoint) {
    const std::uint64_t tick = checkpoint.moment.tick;
    const bool begun = half_written_ && half_written_->tick == tick;
    // After one tick of a run all that can be there is this one: when it was written it was not known that it had been.
    if (!is_held(checkpoint.moment.generation) || (!begun && format_ >= 2 && has_checkpoint(tick))) {
        half_written_.reset();
        tidy_ = false;
        if (database_.failed()) {
            return failure();
        }
        return true;
    }
    begin();
    if (!begun) {
        half_written_ = HalfWritten{.tick = tick};
    }
    const bool last = write_next(checkpoint, *half_written_);
    if (auto committed = commit(); !committed) {
        return committed.error();
    }
    if (last) {
        half_written_.reset();
    }
    return last;
}

bool RunFile::write_next(const StoredCheckpoint& checkpoint, HalfWritten& half) {
    const simulation::Moment& moment = checkpoint.moment;
    if (half.checksums.empty()) { // what a server left that was killed, or one that is replaced
        database_.run(("DELETE FROM checkpoint_part WHERE tick = " + std::to_string(half.tick)).c_str());
    }
    const std::size_t size = options_.part_bytes;
    const auto left = std::as_bytes(std::span{checkpoint.state}).subspan(half.checksums.size() * size);
    if (left.size() > size) {
        half.checksums.push_back(
            writers().part.natural(half.tick).natural(half.checksums.size() + 1).bytes(left.first(size)).finish());
        return false;
    }
    const std::int64_t parameters = number_of(checkpoint.parameters);
    RowWriter& row = writers().checkpoint;
    row.natural(moment.tick)
        .natural(moment.generation)
        .natural(moment.generation_tick)
        .real(moment.simulated_s)
        .integer(parameters)
        .natural(checkpoint.journal_entries)
        .natural(checkpoint.hash.low)
        .natural(checkpoint.hash.high);
    for (const std::int64_t checksum : half.checksums) {
        row.covers(checksum);
    }
    row.bytes(left).finish();
    database_.run(("DELETE FROM checkpoint WHERE tick != " + std::to_string(identity_.first_tick) +
                   " AND tick NOT IN (SELECT tick FROM checkpoint ORDER BY tick DESC LIMIT " +
                   std::to_string(checkpoints_kept) + ")")
                      .c_str());
    tidy_ = false;
    return true;
}

Result<bool> RunFile::tidy() {
    if (marked_ || (tidy_ && !sweep_)) {
        return false;
    }
    if (tidy_) {
        if (auto swept = sweep(); !swept) {
            return swept.error();
        }
        return true;
    }
    std::string where = belonging_to_none;
    if (half_written_) {
        where += " AND tick != " + std::to_string(half_written_->tick);
    }
    tidy_ = database_.number(("SELECT count(*) FROM checkpoint_part WHERE " + where).c_str()) == 0;
    if (database_.failed()) {
        return failure();
    }
    if (tidy_) {
        return sweep_.has_value();
    }
    begin();
    constexpr int parts_at_once = 2;
    database_.run(("DELETE FROM checkpoint_part WHERE rowid IN (SELECT rowid FROM checkpoint_part WHERE " + where +
                   " LIMIT " + std::to_string(parts_at_once) + ")")
                      .c_str());
    if (auto committed = commit(); !committed) {
        return committed.error();
    }
    return true;
}

void RunFile::write(EndMark mark) {
    half_written_.reset();
    database_.run((std::string{"DELETE FROM checkpoint_part WHERE "} + belonging_to_none).c_str());
    const EndMark found = contents();
    mark.journal_entries = found.journal_entries;
    mark.generations = found.generations;
    mark.links = found.links;
    writers()
        .end.integer(std::int64_t{1})
        .text(mark.ended ? "ended" : "closed")
        .natural(mark.tick)
        .natural(mark.journal_entries)
        .natural(mark.generations)
        .natural(mark.links)
        .finish();
}

Result<void> RunFile::commit() {
    database_.run("COMMIT");
    if (database_.failed()) {
        return failure();
    }
    marked_ = false;
    return {};
}

bool RunFile::is_large() {
    return !sweep_ && (database_.number("PRAGMA page_count") - database_.number("PRAGMA freelist_count")) *
                              database_.number("PRAGMA page_size") >
                          options_.file_bytes_max;
}

Result<void> RunFile::thin_if_large() {
    const std::uint64_t last = last_generation();
    // The last two may still be written to.
    if (sweep_ || !is_large() || last < identity_.first_generation + 2 || last - 2 <= thinning_.until_generation) {
        return {};
    }
    // Once only the first is left of the older ones, there is nothing to halve.
    const std::uint64_t twice = thinning_.keep_every > last ? 1 : 2;
    Thinning next{.keep_every = twice * std::max(thinning_.keep_every, keep_every_),
                  .until_generation = last - 2,
                  .until_tick = 0};
    next.until_tick = static_cast<std::uint64_t>(database_.number(
        ("SELECT first_tick FROM generation WHERE generation = " + std::to_string(next.until_generation + 1)).c_str()));
    begin();
    database_.run(("DELETE FROM checkpoint WHERE generation <= " + std::to_string(next.until_generation) +
                   " AND (generation - " + std::to_string(identity_.first_generation) + ") % " +
                   std::to_string(next.keep_every) + " != 0")
                      .c_str());
    writers()
        .thinned.integer(1 + database_.number("SELECT max(number) FROM thinned"))
        .natural(next.keep_every)
        .natural(next.until_generation)
        .natural(next.until_tick)
        .finish();
    if (auto committed = commit(); !committed) {
        return committed;
    }
    thinning_ = next;
    tidy_ = false;
    sweep_ = Sweep{};
    return {};
}

Result<void> RunFile::sweep() {
    const std::string first = std::to_string(identity_.first_generation), every = std::to_string(thinning_.keep_every);
    constexpr std::uint64_t generations_at_once = 1000, links_at_once = 1000;
    constexpr std::int64_t pages_at_once = 64;
    if (sweep_->generation < thinning_.until_generation) {
        const std::uint64_t until = std::min(thinning_.until_generation, sweep_->generation + generations_at_once);
        std::vector<std::int64_t> generations;
        for (Statement left{database_, "SELECT DISTINCT generation FROM population WHERE generation > " +
                                           std::to_string(sweep_->generation) +
                                           " AND generation <= " + std::to_string(until) + " AND (generation - " +
                                           first + ") % " + every + " != 0 ORDER BY generation LIMIT 64"};
             left.row();) {
            generations.push_back(left.integer(0));
        }
        if (generations.empty()) {
            sweep_->generation = until;
            return {};
        }
        begin();
        const auto free_pages = [this] { return database_.number("PRAGMA freelist_count"); };
        const std::int64_t enough = free_pages() + pages_at_once;
        for (std::size_t i = 0; i < generations.size() && free_pages() < enough; ++i) {
            // The population last: by it a generation is found again of which not all has been taken out.
            for (const char* table : {"outcome", "founders", "population"}) {
                if (free_pages() < enough) {
                    database_.run(
                        ("DELETE FROM " + std::string{table} + " WHERE generation = " + std::to_string(generations[i]))
                            .c_str());
                }
            }
        }
        return commit();
    }
    if (sweep_->tick < thinning_.until_tick) {
        const std::uint64_t until = std::min(thinning_.until_tick, sweep_->tick + links_at_once * ticks_per_link);
        begin();
        database_.run(("DELETE FROM state_hash WHERE tick > " + std::to_string(sweep_->tick) +
                       " AND tick <= " + std::to_string(until) + " AND tick / " + std::to_string(ticks_per_link) +
                       " % " + every + " != 0")
                          .c_str());
        sweep_->tick = until;
        return commit();
    }
    sweep_.reset();
    return {};
}

} // namespace evod::run_file
