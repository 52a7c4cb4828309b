#include "server/recording/storage_thread.h"

#include "server/recording/storage_worker.h"

#include <utility>

namespace evod::recording {
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

RunNumber StorageThread::create(const std::string& path, run_file::RunBeginning beginning,
                                std::optional<WaitingRecord> command, std::optional<ReplacedRun> old) {
    RunLog run{.path = path,
               .run_id = beginning.identity.run_id,
               .options = options_,
               .creation = RunLog::Creation{.identity = beginning.identity}};
    if (old) {
        run.creation->replaces = old->number;
        old->closing.replaced = true;
    }
    for (Record& record : run_file::RunFile::records_of(std::move(beginning))) {
        run.waiting.emplace_back(std::move(record));
    }
    if (command) {
        run.waiting.push_back(*std::move(command));
    }
    return queue_.add_run(std::move(run), std::move(old));
}

RunNumber StorageThread::adopt(std::unique_ptr<run_file::RunFile> file) {
    RunLog run{.path = file->path(), .run_id = file->identity().run_id, .options = options_};
    run.file = std::move(file);
    (void)run.name.check(run.path, {}); // remembers this file
    return queue_.add_run(std::move(run));
}

} // namespace evod::recording
