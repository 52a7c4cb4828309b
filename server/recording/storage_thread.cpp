#include "server/recording/storage_thread.h"

#include "server/log/log.h"
#include "server/recording/storage_worker.h"

#include <utility>

namespace evod::recording {

StorageThread::StorageThread(run_file::RunFile::Options options, std::chrono::milliseconds retry_after)
    : options_{options}, retry_after_{retry_after}, thread_{[this] { Worker{*this}.work(); }} {}

StorageThread::~StorageThread() {
    finish();
}

bool StorageThread::finish() {
    if (thread_.joinable()) {
        {
            const std::lock_guard lock{mutex_};
            stopping_ = true;
        }
        changed_.notify_one();
        thread_.join();
    }
    return !lost_;
}

std::vector<WaitingRecord> StorageThread::records_of(Batch batch) {
    std::vector<WaitingRecord> records;
    std::size_t bytes = 0;
    for (Record& record : batch.records) {
        const std::size_t record_bytes = bytes_of(record);
        records.push_back({.record = std::move(record), .done = {}, .writing = {}, .bytes = record_bytes});
        bytes += record_bytes;
    }
    if (records.empty()) {
        records.emplace_back();
    }
    if (batch.done) {
        records.back().handed_over = std::chrono::steady_clock::now();
    }
    records.back().done = std::move(batch.done);
    waiting_bytes_.fetch_add(bytes, std::memory_order_relaxed);
    return records;
}

StorageThread::RunNumber StorageThread::add(RunLog run, std::vector<WaitingRecord> records,
                                            std::optional<std::pair<RunNumber, Closing>> old) {
    RunNumber number = 0;
    {
        const std::lock_guard lock{mutex_};
        number = run.number = ++last_number_;
        handed_over_.new_runs.emplace(number, std::move(run));
        if (old) {
            handed_over_.closing.insert(*std::move(old));
        }
        if (!records.empty()) {
            enqueue(number, std::move(records));
        }
    }
    changed_.notify_one();
    return number;
}

StorageThread::RunNumber StorageThread::create(const std::string& path, run_file::RunIdentity identity, Batch first) {
    RunLog run{.options = options_};
    run.path = path;
    run.creation = RunLog::Creation{.identity = std::move(identity)};
    return add(std::move(run), records_of(std::move(first)));
}

StorageThread::RunNumber StorageThread::replace(RunNumber old_run, Ending ending, const std::string& path,
                                                run_file::RunIdentity identity, Batch first) {
    RunLog run{.options = options_};
    run.path = path;
    run.creation = RunLog::Creation{.identity = std::move(identity), .replaces = old_run};
    Closing closing{.last = records_of(std::move(ending.last)), .renamed = std::move(ending.renamed), .replaced = true};
    return add(std::move(run), records_of(std::move(first)), std::pair{old_run, std::move(closing)});
}

StorageThread::RunNumber StorageThread::adopt(std::unique_ptr<run_file::RunFile> file) {
    RunLog run{.options = options_};
    run.path = file->path();
    run.file = std::move(file);
    (void)run.name.check(run.path, {}); // remembers this file
    return add(std::move(run), {});
}

void StorageThread::write(RunNumber run, Batch batch) {
    hand_over(run, records_of(std::move(batch)));
}

void StorageThread::write(RunNumber run, run_file::Checkpoint checkpoint, std::shared_ptr<CheckpointWriting> writing) {
    writing->waits = true;
    waiting_checkpoints_.fetch_add(1);
    std::vector<WaitingRecord> records;
    records.push_back({.record = std::move(checkpoint), .done = {}, .writing = std::move(writing)});
    hand_over(run, std::move(records));
}

void StorageThread::close(RunNumber run, Ending ending) {
    Closing closing{.last = records_of(std::move(ending.last)), .renamed = std::move(ending.renamed)};
    {
        const std::lock_guard lock{mutex_};
        handed_over_.closing.emplace(run, std::move(closing));
        urgent_ = true;
    }
    changed_.notify_one();
}

void StorageThread::hand_over(RunNumber run, std::vector<WaitingRecord> records) {
    bool wake = false;
    {
        const std::lock_guard lock{mutex_};
        wake = enqueue(run, std::move(records));
    }
    if (wake) {
        changed_.notify_one();
    }
}

bool StorageThread::enqueue(RunNumber run, std::vector<WaitingRecord> records) {
    std::size_t bytes = 0;
    for (const WaitingRecord& record : records) {
        bytes += record.bytes;
    }
    urgent_ |= records.back().done != nullptr || bytes > gathered_bytes_max;
    // Only an urgent batch and the first batch of a group wake the thread.
    const bool wake = urgent_ || handed_over_.records.empty();
    if (handed_over_.records.empty()) {
        handed_over_since_ = std::chrono::steady_clock::now();
    }
    std::vector<WaitingRecord>& waiting = handed_over_.records[run];
    waiting.insert(waiting.end(), std::make_move_iterator(records.begin()), std::make_move_iterator(records.end()));
    return wake;
}

std::optional<std::chrono::steady_clock::time_point> StorageThread::waiting_since() const {
    const std::lock_guard lock{mutex_};
    return taken_since_ ? taken_since_ : handed_over_since_;
}

std::optional<std::string> StorageThread::trouble() const {
    const std::lock_guard lock{mutex_};
    return trouble_.empty() ? std::nullopt : std::optional{trouble_};
}

void StorageThread::when_changed(std::function<void()> changed) {
    const std::lock_guard lock{mutex_};
    when_changed_ = std::move(changed);
}

void StorageThread::set_trouble(const std::string& why) {
    std::string before;
    {
        const std::lock_guard lock{mutex_};
        before = std::exchange(trouble_, why);
        if (before != why && when_changed_) {
            when_changed_();
        }
    }
    if (before.empty() && !why.empty()) {
        log::error("{}; commands are refused until the file can be written again", why);
    } else if (!before.empty() && why.empty()) {
        log::info("run files can be written again");
    }
}

} // namespace evod::recording
