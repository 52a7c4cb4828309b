#include "server/recording/log_jobs.h"

#include "server/run_file/checkpoint.h"

#include <memory>
#include <utility>
#include <variant>

namespace evod::recording {

void LogJobs::start(const RunLog& run, std::function<decltype(JobResult::result)()> job) {
    ++running_count_;
    ++queue_.unfinished;
    jobs_.add([this, number = run.number, job = std::move(job)](const std::stop_token&) {
        queue_.add_result({.run = number, .result = job()});
    });
}

void LogJobs::apply_results(std::map<RunNumber, RunLog>& runs, bool wait) {
    for (JobResult& ended : queue_.take_results(wait)) {
        --running_count_;
        --queue_.unfinished;
        if (const auto found = runs.find(ended.run); found != runs.end()) { // otherwise the run has ended
            std::visit([&](auto& result) { found->second.apply(std::move(result)); }, ended.result);
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
    start(run, [given] {
        const auto began = std::chrono::steady_clock::now();
        CompressedCheckpoint compressed{.checkpoint = run_file::pack(*given), .took = {}};
        *given = {};
        compressed.took = std::chrono::steady_clock::now() - began;
        return compressed;
    });
}

void LogJobs::copy_log_if_due(RunLog& run) {
    if (run.log_copy_due()) {
        start(run, [path = run.path, options = run.options] {
            run_file::copy_log(path, options);
            return LogCopied{};
        });
    }
}

} // namespace evod::recording
