#include "server/run_file/run_file.h"

#include "server/base/overloaded.h"
#include "server/files/regular_file.h"
#include "server/run_file/data_folder.h"
#include "server/run_file/rows.h"
#include "server/run_file/schema.h"
#include "server/run_file/write_ahead_log.h"

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace evod::run_file {
namespace {

using base::Refusal;
using base::RefusalCode;
using base::Result;

Refusal exists_already(const std::string& path) {
    return refusal(RefusalCode::AlreadyExists, path + " exists already");
}

/// SQLite treats a file of one byte or less as an empty database, and deletes the log next to it.
Result<void> expect_bytes(const std::string& path) {
    std::error_code error;
    if (const auto bytes = std::filesystem::file_size(path, error); !error && bytes <= 1) {
        return empty_file(path);
    }
    return {};
}

/// SQLite reads a truncated last page as if zeros followed. This is allowed if the page may be complete in the
/// write-ahead log.
Result<void> expect_whole_pages(RunDatabase& database) {
    const auto bytes_of = [](const std::string& path) {
        std::error_code error;
        const auto bytes = std::filesystem::file_size(path, error);
        return error ? 0 : static_cast<std::int64_t>(bytes);
    };
    const std::int64_t page_bytes = database.number("PRAGMA page_size");
    if (page_bytes > 0 && bytes_of(database.path) % page_bytes != 0 && bytes_of(database.path + "-wal") == 0) {
        return database.damaged("its last page");
    }
    return {};
}

} // namespace

RunFile::RunFile(const std::string& path, Database::Mode mode, const Options& options)
    : RunContents{path, mode, options.vfs, options.part_bytes}, options_{options} {
    if (mode == Database::Mode::Read || mode == Database::Mode::ReadAtRest) {
        return;
    }
    database_.run("PRAGMA journal_mode = WAL");
    database_.run("PRAGMA journal_size_limit = 16777216"); // SQLite truncates a restarted log to this size
    database_.run(options.durability == Durability::Full ? "PRAGMA synchronous = FULL" : "PRAGMA synchronous = NORMAL");
}

Result<std::unique_ptr<RunFile>> RunFile::begin_new(const std::string& path, const RunIdentity& identity,
                                                    const Options& options) {
    std::unique_ptr<RunFile> file{new RunFile{path, Database::Mode::Create, options}};
    if (file->database_.number("SELECT count(*) FROM sqlite_schema") != 0) {
        return exists_already(path);
    }
    file->identity_ = {identity, options.keep_every};
    file->begin();
    create_schema(file->database_, identity.parameters);
    write_identity(file->database_, file->identity_);
    return file;
}

std::vector<RunFile::Record> RunFile::records_of(RunBeginning beginning) {
    std::vector<Record> records{std::move(beginning.generation)};
    if (beginning.ended) {
        records.emplace_back(*std::move(beginning.ended));
    }
    if (beginning.identity.forked_from) {
        records.emplace_back(std::move(beginning.inherited));
    }
    if (beginning.state) {
        records.emplace_back(*std::move(beginning.state));
    }
    return records;
}

Result<std::unique_ptr<RunFile>> RunFile::create(const std::string& path, const RunIdentity& identity,
                                                 const Options& options, const std::vector<Record>& first) {
    std::error_code error;
    if (std::filesystem::exists(path, error)) {
        return exists_already(path);
    }
    const std::string next = DataFolder::next_file_of(path);
    if (auto removed = remove_run_file(next); !removed) { // left by an earlier attempt that was interrupted
        return removed.error();
    }
    auto file = begin_new(next, identity, options);
    if (!file) {
        return file.error();
    }
    for (const Record& record : first) {
        (*file)->write(record);
    }
    if (auto committed = (*file)->commit(); !committed) {
        return committed.error();
    }
    if (auto merged = (*file)->merge_log(); !merged) {
        return merged.error();
    }
    file->reset();
    if (auto named = rename_run_file(next, path); !named) {
        return named.error();
    }
    return open(path, options);
}

Result<std::unique_ptr<RunFile>> RunFile::open(const std::string& path, const Options& options) {
    if (auto there = expect_bytes(path); !there) {
        return there.error();
    }
    if (auto single = expect_file_with_one_name(path); !single) {
        return single.error();
    }
    if (auto sound = check_log(path, LogIndex::Unread); !sound) { // SQLite would drop all frames after a damaged one
        return sound.error();
    }
    std::unique_ptr<RunFile> file{new RunFile{path, Database::Mode::Write, options}};
    if (auto read = file->read_beginning(); !read) {
        return read.error();
    }
    file->database_.has_end_mark = true;
    file->retention_.resume_purge();
    return file;
}

Result<std::unique_ptr<RunFile>> RunFile::open_read_only(const std::string& path) {
    std::error_code error;
    if (!exists(std::filesystem::status(path, error))) {
        return refusal(RefusalCode::NotFound, path + ": there is no such file");
    }
    struct stat status {};
    if (::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
        return refusal(RefusalCode::InvalidArgument,
                       path + ": this is " + std::string{files::other_than_file(status.st_mode)} + ", not a run file");
    }
    if (auto there = expect_bytes(path); !there) {
        return there.error();
    }
    std::unique_ptr<RunFile> file{new RunFile{path, Database::Mode::Read, {}}};
    auto read = file->read_beginning();
    // A reader uses the log next to the file, so SQLite must be able to write to the folder. If it cannot, a file with
    // an empty log can be read without the log.
    const auto log_bytes = std::filesystem::file_size(path + "-wal", error);
    if (!read && read.error().code == RefusalCode::Unavailable && (error || log_bytes == 0)) {
        file.reset(new RunFile{path, Database::Mode::ReadAtRest, {}});
        read = file->read_beginning();
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

Result<void> RunFile::read_beginning() {
    database_.run("BEGIN"); // makes all checks read one snapshot
    if (auto sound = check_schema(database_); !sound) {
        return sound;
    }
    if (auto whole = expect_whole_pages(database_); !whole) {
        return whole;
    }
    auto identity = read_identity(database_);
    if (!identity) {
        return identity.error();
    }
    identity_ = *std::move(identity);
    if (!identity_.has_parameters_in_effect && identity_.run.forked_from) {
        const auto opening = generations_.opening_of(identity_.run.first_generation);
        if (!opening) {
            return opening.error();
        }
        if (*opening) {
            identity_.run.parameters = (*opening)->parameters.active;
        }
    }
    if (auto whole = check_optional_tables(database_, identity_.run.parameters); !whole) {
        return whole;
    }
    if (auto read = retention_.read(); !read) {
        return read;
    }
    return database_.commit();
}

Result<void> RunFile::pin_snapshot() {
    database_.run("BEGIN");
    return retention_.read();
}

Result<void> RunFile::copy_to(const std::string& path, const base::StopCheck& stop) {
    database_.database.copy_to(path, stop);
    return database_.unless_failed();
}

void RunFile::begin() {
    database_.begin();
}

void RunFile::write(const Record& record) {
    std::visit(base::Overloaded{[this](const JournalEntry& entry) { journal_.write(entry); },
                                [this](const Inherited& inherited) { generations_.write(inherited); },
                                [this](const GenerationBegun& begun) {
                                    generations_.write(begun);
                                    checkpoints_.expect_orphans();
                                },
                                [this](const GenerationEnded& ended) { generations_.write(ended); },
                                [this](const HashRecord& hash) {
                                    if (!hash_writer_) {
                                        hash_writer_.emplace(database_.database);
                                    }
                                    hash_writer_->write(hash);
                                },
                                [this](const Checkpoint& checkpoint) { checkpoints_.write(checkpoint); },
                                [this](const StoredCheckpoint& checkpoint) { checkpoints_.write(checkpoint); },
                                [this](const EndMark& mark) { put(mark); }},
               record);
}

void RunFile::put(EndMark mark) {
    checkpoints_.delete_all_orphans();
    const EndMark found = contents();
    mark.journal_entries = found.journal_entries;
    mark.generations = found.generations;
    mark.hashes = found.hashes;
    TableWriter<EndMarkTable>{database_.database}.write(EndMarkTable::Row{1, mark.ended ? "ended" : "closed", mark});
}

Result<void> RunFile::set_generation_limit(std::uint32_t limit) {
    identity_.run.parameters.generation_limit = limit;
    write_identity(database_, identity_);
    return parameter_sets_.set_generation_limit(limit);
}

Result<void> RunFile::commit() {
    return database_.commit();
}

Result<bool> RunFile::write_checkpoint_part(const StoredCheckpoint& checkpoint) {
    if (checkpoints_.is_written(checkpoint)) {
        return database_.unless_failed(true);
    }
    begin();
    const bool last = checkpoints_.write_part(checkpoint);
    if (auto committed = commit(); !committed) {
        return committed.error();
    }
    checkpoints_.part_written(last);
    return last;
}

Result<bool> RunFile::purge_step() {
    if (database_.has_end_mark) {
        return false;
    }
    if (checkpoints_.may_have_orphans()) {
        const bool orphans = checkpoints_.has_orphans();
        if (database_.failed()) {
            return database_.failure();
        }
        if (orphans) {
            database_.begin();
            checkpoints_.delete_some_orphans();
            if (auto committed = database_.commit(); !committed) {
                return committed.error();
            }
        }
        return orphans || retention_.is_purging();
    }
    if (!retention_.is_purging()) {
        return false;
    }
    if (auto purged = retention_.purge_step(); !purged) {
        return purged.error();
    }
    return true;
}

Result<void> RunFile::shrink_if_large() {
    if (!is_large()) {
        return {};
    }
    const auto halved = retention_.halve();
    if (!halved) {
        return halved.error();
    }
    if (*halved) {
        checkpoints_.expect_orphans();
    }
    return {};
}

Result<void> RunFile::merge_log() {
    if (database_.number("PRAGMA wal_checkpoint(TRUNCATE)") != 0) {
        return refusal(RefusalCode::Unavailable, path() + " is being read by another program");
    }
    return database_.unless_failed();
}

Result<bool> is_empty_file(const std::string& path) {
    RunDatabase database{path, Database::Mode::Write, nullptr};
    const bool empty = is_empty(database);
    return database.unless_failed(empty);
}

void copy_log(const std::string& path, const RunFile::Options& options) {
    Database file{path, Database::Mode::Write, options.vfs};
    (void)file.number("SELECT count(*) FROM sqlite_schema"); // SQLite opens the log with the first query
    file.copy_log();
}

} // namespace evod::run_file
