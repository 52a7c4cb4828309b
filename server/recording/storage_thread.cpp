#include "server/recording/storage_thread.h"

#include "server/recording/storage_worker.h"

#include <utility>

namespace evod::recording {
namespace {

std::vector<WaitingRecord> records_of(StorageThread::Batch batch, DiskState& disk) {
    std::vector<WaitingRecord> records;
    std::size_t bytes = 0;
    for (Record& record : batch.records) {
        const std::size_t record_bytes = bytes_of(record);
        records.push_back({.record = std::move(record), .bytes = record_bytes});
        bytes += record_bytes;
    }
    if (records.empty()) {
        records.emplace_back();
    }
    if (batch.ticket != 0) {
        records.back().handed_over = std::chrono::steady_clock::now();
    }
    records.back().ticket = batch.ticket;
    disk.added(bytes);
    return records;
}

} // namespace

StorageThread::StorageThread(run_file::RunFile::Options options, std::chrono::milliseconds retry_after)
    : options_{options}, thread_{[this, retry_after] {
        lost_ = !StorageWorker{queue_, disk_, jobs_, times_, receipt_sink_, retry_after}.work();
    }} {}

StorageThread::~StorageThread() {
    finish();
}

bool StorageThread::finish() {
    if (thread_.joinable()) {
        queue_.stop();
        thread_.join();
    }
    return !lost_;
}

RunNumber StorageThread::create(const std::string& path, run_file::RunIdentity identity, Batch first) {
    RunLog run{.options = options_};
    run.path = path;
    run.run_id = identity.run_id;
    run.creation = RunLog::Creation{.identity = std::move(identity)};
    return queue_.add_run(std::move(run), records_of(std::move(first), disk_));
}

RunNumber StorageThread::replace(RunNumber old_run, Ending ending, const std::string& path,
                                 run_file::RunIdentity identity, Batch first) {
    RunLog run{.options = options_};
    run.path = path;
    run.run_id = identity.run_id;
    run.creation = RunLog::Creation{.identity = std::move(identity), .replaces = old_run};
    Closing closing{
        .last = records_of(std::move(ending.last), disk_), .renamed = std::move(ending.renamed), .replaced = true};
    return queue_.add_run(std::move(run), records_of(std::move(first), disk_), std::pair{old_run, std::move(closing)});
}

RunNumber StorageThread::adopt(std::unique_ptr<run_file::RunFile> file) {
    RunLog run{.options = options_};
    run.path = file->path();
    run.run_id = file->identity().run_id;
    run.file = std::move(file);
    (void)run.name.check(run.path, {}); // remembers this file
    return queue_.add_run(std::move(run), {});
}

void StorageThread::write(RunNumber run, Batch batch) {
    queue_.add(run, records_of(std::move(batch), disk_));
}

void StorageThread::write(RunNumber run, run_file::Checkpoint checkpoint, std::shared_ptr<CheckpointWriting> writing) {
    writing->waits = true;
    ++queue_.unfinished;
    std::vector<WaitingRecord> records;
    records.push_back({.record = std::move(checkpoint), .writing = std::move(writing)});
    queue_.add(run, std::move(records));
}

void StorageThread::close(RunNumber run, Ending ending) {
    Closing closing{.last = records_of(std::move(ending.last), disk_),
                    .renamed = std::move(ending.renamed),
                    .leaving = std::move(ending.leaving)};
    queue_.close(run, std::move(closing));
}

} // namespace evod::recording
