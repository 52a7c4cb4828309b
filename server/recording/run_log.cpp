#include "server/recording/run_log.h"

#include "server/log/log.h"
#include "server/run_file/data_folder.h"

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <utility>
#include <variant>

namespace evod::recording {
namespace {

using base::Refusal;
using base::Result;

/// Returns the refusal for a file that was moved or deleted. `other_file` states whether another file has its name now.
Refusal moved_file_refusal(const std::string& path, bool other_file) {
    // If the whole folder is missing, this concerns all runs.
    std::error_code error;
    const bool has_folder = std::filesystem::exists(std::filesystem::path{path}.parent_path(), error);
    return {.code = has_folder ? base::RefusalCode::NotFound : base::RefusalCode::Unavailable,
            .message =
                path + (other_file ? " is not the file that the server writes" : " has been moved or deleted") +
                ": move the original file back; otherwise everything written from now on is lost when the server "
                "stops, and you must restore a copy before the next start",
            .violations = {}};
}

Refusal exists_already(const std::string& path) {
    return {.code = base::RefusalCode::AlreadyExists,
            .message =
                path + " exists already and contains another run: move it away, and the server writes the waiting data",
            .violations = {}};
}

} // namespace

std::optional<Refusal> FileNameWatch::check(const std::string& path, std::chrono::steady_clock::time_point now) {
    if (known_ && !known_->lost && now - known_->checked < interval) {
        return std::nullopt;
    }
    struct stat status {};
    const bool exists = ::stat(path.c_str(), &status) == 0;
    if (!known_) {
        if (!exists) {
            return moved_file_refusal(path, false);
        }
        known_ = Known{.device = status.st_dev, .number = status.st_ino};
    }
    known_->checked = now;
    known_->lost = !exists || status.st_dev != known_->device || status.st_ino != known_->number;
    return known_->lost ? std::optional{moved_file_refusal(path, exists)} : std::nullopt;
}

Refusal RunLog::fail(Refusal why) {
    file.reset();
    return why;
}

WaitingRecord* RunLog::next_to_compress() {
    if (compressing) {
        return nullptr;
    }
    for (std::vector<WaitingRecord>* records : {&waiting, &checkpoints}) {
        for (WaitingRecord& record : *records) {
            if (record.record && std::holds_alternative<run_file::Checkpoint>(*record.record)) {
                return &record;
            }
        }
    }
    return nullptr;
}

void RunLog::add(std::vector<WaitingRecord> records) {
    for (WaitingRecord& record : records) {
        (record.writing ? checkpoints : waiting).push_back(std::move(record));
    }
}

void RunLog::apply(CompressedCheckpoint compressed) {
    compressing = false;
    for (std::vector<WaitingRecord>* records : {&waiting, &checkpoints}) {
        for (WaitingRecord& record : *records) {
            if (std::exchange(record.being_compressed, false)) {
                record.record = std::move(compressed.checkpoint);
                record.took = compressed.took;
                return;
            }
        }
    }
}

Result<bool> RunLog::open() {
    const bool to_create = creation && !creation->committed;
    const std::string name_now = creation ? run_file::DataFolder::next_file_of(path) : path;
    // The file to create may already exist: an earlier commit succeeded although it was reported as failed.
    Result<std::unique_ptr<run_file::RunFile>> opened = run_file::RunFile::open(name_now, options);
    const bool is_new = to_create && !opened;
    if (is_new) { // one transaction for all first records, so that a reader sees all of them or none
        opened = run_file::RunFile::begin_new(name_now, creation->identity, options);
    } else if (opened && (*opened)->identity().run_id != run_id) {
        opened = to_create ? exists_already(name_now) : moved_file_refusal(name_now, true);
    }
    std::error_code error;
    if (!opened && !to_create && !std::filesystem::exists(name_now, error)) {
        return fail(moved_file_refusal(name_now, false));
    }
    if (!opened) {
        return fail(opened.error());
    }
    file = *std::move(opened);
    of_class = file->is_of_class();
    name.forget();
    if (!creation) {
        (void)name.check(path, std::chrono::steady_clock::now()); // remembers the file that was opened
    }
    log_copy.pages = 0;
    return is_new;
}

Result<std::chrono::nanoseconds> RunLog::commit(const std::vector<WaitingRecord>& records) {
    if (std::ranges::none_of(records, [](const WaitingRecord& record) { return record.record.has_value(); })) {
        return std::chrono::nanoseconds{0};
    }
    if (!file || creation) {
        name.forget();
    } else if (auto lost = name.check(path, std::chrono::steady_clock::now())) {
        return *lost;
    }
    bool begun = false;
    if (!file) {
        const auto is_new = open();
        if (!is_new) {
            return is_new.error();
        }
        begun = *is_new;
    }
    if (!begun) {
        file->begin();
    }
    for (const WaitingRecord& record : records) {
        if (record.record) {
            file->write(*record.record);
        }
    }
    const auto began = std::chrono::steady_clock::now();
    if (auto committed = file->commit(); !committed) {
        return fail(committed.error());
    }
    const auto took = std::chrono::steady_clock::now() - began;
    if (creation && !creation->committed) {
        if (auto merged = file->merge_log(); !merged) {
            return fail(merged.error());
        }
        creation->committed = true;
    }
    return took;
}

Result<void> RunLog::shrink() {
    if (const auto shrunk = file->shrink_if_large(); !shrunk) {
        return fail(shrunk.error());
    }
    if (!large_reported && file->is_large()) {
        log::warn("{} is larger than --file-bytes-max: the data that is always retained exceeds this limit", path);
        large_reported = true;
    }
    full = file->is_full();
    return {};
}

Result<void> RunLog::rename_to_final_name() {
    file.reset();
    std::error_code error;
    if (std::filesystem::exists(path, error)) {
        return fail(exists_already(path));
    }
    if (const auto renamed = run_file::rename_run_file(run_file::DataFolder::next_file_of(path), path); !renamed) {
        return fail(renamed.error());
    }
    creation.reset();
    return {};
}

Result<void> RunLog::rename_ended_file() {
    if (!closing->renamed.empty()) {
        if (const auto renamed = run_file::rename_run_file(path, closing->renamed); !renamed) {
            return fail(renamed.error());
        }
    }
    return {};
}

Result<bool> RunLog::background_step() {
    if (creation || log_copy.running || is_finished() || !waiting.empty()) {
        return false;
    }
    if (file) {
        const auto purged = file->purge_step();
        if (!purged) {
            return fail(purged.error());
        }
        if (*purged) {
            return true;
        }
    }
    const run_file::StoredCheckpoint* checkpoint = nullptr;
    if (!checkpoints.empty() && checkpoints.front().record) {
        checkpoint = std::get_if<run_file::StoredCheckpoint>(&*checkpoints.front().record);
    }
    if (checkpoint == nullptr) {
        return false;
    }
    if (!file) {
        if (const auto opened = open(); !opened) {
            return opened.error();
        }
    }
    const auto began = std::chrono::steady_clock::now();
    const auto whole = file->write_checkpoint_part(*checkpoint);
    if (!whole) {
        return fail(whole.error());
    }
    checkpoints.front().took += std::chrono::steady_clock::now() - began;
    if (*whole) {
        written.push_back(std::move(checkpoints.front()));
        checkpoints.erase(checkpoints.begin());
    }
    return true;
}

bool RunLog::log_copy_due() {
    if (!file || creation || log_copy.running) {
        return false;
    }
    const std::uint32_t pages = file->database().database.log_pages();
    if (pages < log_copy.pages) { // the log has shrunk, because SQLite restarted it
        log_copy.pages = 0;
    }
    if (pages < log_copy.pages + options.log_pages_max) {
        return false;
    }
    log_copy.pages = pages;
    log_copy.running = true;
    return true;
}

void RunLog::apply(LogCopied) {
    log_copy.running = false;
    constexpr std::uint32_t pages_factor_max = 4;
    if (!file) {
        return;
    }
    run_file::Database& database = file->database().database;
    if (database.log_pages() == log_copy.pages || database.log_pages() < pages_factor_max * options.log_pages_max) {
        return;
    }
    database.copy_log();
    log_copy.pages = database.log_pages();
}

} // namespace evod::recording
