#include "server/recording/log_jobs.h"

#include "server/run_file/checkpoint.h"

#include <memory>
#include <utility>
#include <variant>

namespace evod::recording {

void LogJobs::start(const RunLog& run, std::function<std::function<void(RunLog&)>()> job) {
    ++running_count_;
    ++queue_.unfinished;
    jobs_.add([this, number = run.number, job = std::move(job)](const std::stop_token&) {
        queue_.add_result({.run = number, .apply = job()});
    });
}

void LogJobs::apply_results(std::map<RunNumber, RunLog>& runs, bool wait) {
    for (const JobResult& result : queue_.take_results(wait)) {
        --running_count_;
        --queue_.unfinished;
        if (const auto found = runs.find(result.run); found != runs.end()) {
            result.apply(found->second);
        }
    }
}

void LogJobs::compress_next(RunLog& run) {
    WaitingRecord* next = run.next_to_compress();
    if (next == nullptr) {
        return;
    }
    next->being_compressed = run.compressing = true;
    const auto given = std::make_shared<run_file::Checkpoint>(std::move(std::get<run_file::Checkpoint>(*next->record)));
    start(run, [given]() -> std::function<void(RunLog&)> {
        const auto began = std::chrono::steady_clock::now();
        const auto packed = std::make_shared<run_file::StoredCheckpoint>(run_file::pack(*given));
        *given = {};
        const auto took = std::chrono::steady_clock::now() - began;
        return [packed, took](RunLog& log) { log.compressed(std::move(*packed), took); };
    });
}

void LogJobs::copy_log_if_due(RunLog& run) {
    if (run.log_copy_due()) {
        start(run, [path = run.path, options = run.options]() -> std::function<void(RunLog&)> {
            run_file::copy_log(path, options);
            return [](RunLog& log) { log.log_copied(); };
        });
    }
}

} // namespace evod::recording
