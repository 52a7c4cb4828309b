#include "server/recording/storage_worker.h"

#include "server/log/log.h"
#include "server/run_file/checkpoint.h"

#include <pthread.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>
#include <variant>

namespace evod::recording {

void StorageThread::Worker::work() {
    pthread_setname_np(pthread_self(), "storage"); // the name that `top -H` shows
    constexpr int skipped_max = 8;                 // maximum number of consecutive rounds without a background step
    int skipped = 0;
    for (bool more = false;;) {
        const bool stopping = take(more);
        const bool first_try = !std::exchange(failed_, false);
        for (auto& [number, run] : runs_) {
            compress_next(run);
        }
        more = write_out();
        if (first_try && skipped < skipped_max && commands_waiting()) {
            ++skipped;
            more = true;
        } else {
            skipped = 0;
            more |= background_step();
        }
        std::erase_if(runs_, [](const auto& item) { return item.second.is_finished(); });
        if (!failed_) {
            const bool all_written =
                std::ranges::all_of(runs_, [](const auto& run) { return run.second.waiting.empty(); });
            if (all_written) {
                const std::lock_guard lock{thread_.mutex_};
                thread_.taken_since_.reset();
            }
            thread_.set_trouble({});
        }
        // When the server stops, retries failed records as long as any record can still be written. After that, the
        // failed records are lost.
        const bool advanced = std::exchange(advanced_, false);
        if (stopping && !more && !is_awaiting() && !(failed_ && advanced)) {
            if (failed_) {
                report_lost();
            }
            return;
        }
    }
}

bool StorageThread::Worker::take(bool more) {
    StorageThread& thread = thread_;
    bool stopping = false;
    {
        std::unique_lock lock{thread.mutex_};
        const auto hurries = [&] {
            return thread.urgent_ || !thread.results_.empty() || (thread.stopping_ && thread.jobs_running_ == 0);
        };
        if (failed_) {
            thread.changed_.wait_for(lock, thread.retry_after_, [&] {
                return thread.stopping_ && (thread.jobs_running_ == 0 || !thread.results_.empty());
            });
        } else if (!more) {
            thread.working_ = false;
            thread.changed_.wait(lock, [&] { return hurries() || !thread.handed_over_.records.empty(); });
            thread.working_ = true;
            thread.changed_.wait_for(lock, gathering_time, [&] { return hurries() || thread.stopping_; });
        }
        stopping = thread.stopping_;
        const auto now = std::chrono::steady_clock::now();
        if (!more || failed_ || thread.urgent_ || stopping ||
            (thread.handed_over_since_ && now - *thread.handed_over_since_ >= gathering_time)) {
            thread.urgent_ = false;
            if (!thread.taken_since_) {
                thread.taken_since_ = thread.handed_over_since_;
            }
            thread.handed_over_since_.reset();
            HandedOver taken = std::exchange(thread.handed_over_, {});
            runs_.merge(taken.new_runs);
            for (auto& [number, records] : taken.records) {
                RunLog& run = runs_[number];
                for (WaitingRecord& record : records) {
                    (record.writing ? run.checkpoints : run.waiting).push_back(std::move(record));
                }
            }
            for (auto& [number, closing] : taken.closing) {
                runs_[number].closing = std::move(closing);
            }
        }
    }
    run_results();
    return stopping;
}

void StorageThread::Worker::run_results() {
    std::vector<std::function<void(Worker&)>> results;
    {
        const std::lock_guard lock{thread_.mutex_};
        results.swap(thread_.results_);
    }
    for (const auto& result : results) {
        result(*this);
    }
}

bool StorageThread::Worker::is_awaiting() {
    const std::lock_guard lock{thread_.mutex_};
    return thread_.jobs_running_ > 0 || !thread_.handed_over_.records.empty() || !thread_.handed_over_.closing.empty();
}

bool StorageThread::Worker::commands_waiting() {
    const std::lock_guard lock{thread_.mutex_};
    return thread_.urgent_;
}

/// job  runs on the job queue. The function that it returns runs on this thread, unless the run has ended.
void StorageThread::Worker::start_job(RunLog& run, const std::function<std::function<void(RunLog&)>()>& job) {
    ++thread_.jobs_running_;
    thread_.jobs_.add([&thread = thread_, number = run.number, job](const std::stop_token&) {
        auto result = [number, apply = job()](Worker& worker) {
            --worker.thread_.jobs_running_;
            if (const auto found = worker.runs_.find(number); found != worker.runs_.end()) {
                apply(found->second);
            }
        };
        {
            const std::lock_guard lock{thread.mutex_};
            thread.results_.emplace_back(std::move(result));
        }
        thread.changed_.notify_one();
    });
}

void StorageThread::Worker::compress_next(RunLog& run) {
    WaitingRecord* next = run.next_to_compress();
    if (next == nullptr) {
        return;
    }
    next->being_compressed = run.compressing = true;
    const auto given = std::make_shared<run_file::Checkpoint>(std::move(std::get<run_file::Checkpoint>(*next->record)));
    start_job(run, [given]() -> std::function<void(RunLog&)> {
        const auto began = std::chrono::steady_clock::now();
        const auto packed = std::make_shared<run_file::StoredCheckpoint>(run_file::pack(*given));
        *given = {};
        const auto took = std::chrono::steady_clock::now() - began;
        return [packed, took](RunLog& log) { log.compressed(std::move(*packed), took); };
    });
}

void StorageThread::Worker::copy_log_if_due(RunLog& run) {
    if (run.log_copy_due()) {
        start_job(run, [path = run.path, options = thread_.options_]() -> std::function<void(RunLog&)> {
            run_file::copy_log(path, options);
            return [](RunLog& log) { log.log_copied(); };
        });
    }
}

bool StorageThread::Worker::write_out() {
    std::vector<RunLog*> others;
    for (auto& [number, run] : runs_) {
        if (run.closing ||
            std::ranges::any_of(run.waiting, [](const WaitingRecord& record) { return record.done != nullptr; })) {
            (void)write_out(run);
        } else if (!run.waiting.empty() || run.creation) {
            others.push_back(&run);
        }
    }
    // The runs take turns, even if there are many commands.
    std::stable_partition(others.begin(), others.end(),
                          [this](const RunLog* run) { return run->number > last_written_; });
    for (RunLog* run : others) {
        if (run != others.front() && commands_waiting()) {
            return true;
        }
        last_written_ = run->number;
        (void)write_out(*run);
    }
    return false;
}

bool StorageThread::Worker::write_out(RunLog& run) {
    const auto is_uncompressed = [](const WaitingRecord& record) {
        return record.record && std::holds_alternative<run_file::Checkpoint>(*record.record);
    };
    if (std::ranges::any_of(run.waiting, is_uncompressed) || !is_its_turn(run)) {
        return false;
    }
    const bool has_records = !run.waiting.empty();
    if (has_records) {
        if (!commit(run, run.waiting)) {
            return false;
        }
        run.written.insert(run.written.end(), std::make_move_iterator(run.waiting.begin()),
                           std::make_move_iterator(run.waiting.end()));
        run.waiting.clear();
    }
    if (run.creation && run.creation->committed && !take_name(run)) {
        return false;
    }
    report_written(run.written);
    if (run.closing) {
        return run.closing->replaced || end(run);
    }
    if (has_records && run.file) {
        if (const auto shrunk = run.shrink(); !shrunk) { // the records are written even if this fails
            return fail(shrunk.error());
        }
    }
    return true;
}

bool StorageThread::Worker::is_its_turn(const RunLog& run) {
    for (auto& [number, earlier] : runs_) {
        if (number >= run.number) {
            break;
        }
        if (earlier.path != run.path) {
            continue;
        }
        const bool is_replaced = run.creation && run.creation->replaces == number;
        const auto is_out_of_the_way = [&, &log = earlier] { return is_replaced ? !log.creation : log.is_finished(); };
        if (!is_out_of_the_way()) {
            (void)write_out(earlier);
            if (!is_out_of_the_way()) {
                return false;
            }
        }
    }
    return true;
}

bool StorageThread::Worker::commit(RunLog& run, const std::vector<WaitingRecord>& records) {
    const auto took = run.commit(records);
    if (!took) {
        return fail(took.error());
    }
    if (took->count() > 0) {
        thread_.times_.commit.add(*took);
        copy_log_if_due(run);
        advanced_ = true;
    }
    return true;
}

bool StorageThread::Worker::take_name(RunLog& run) {
    const auto replaced = run.creation->replaces ? runs_.find(*run.creation->replaces) : runs_.end();
    if (replaced != runs_.end()) {
        RunLog& old = replaced->second;
        old.closing->replaced = false;
        if (!write_out(old) || !old.is_finished()) {
            return false;
        }
    }
    if (const auto named = run.take_name(); !named) {
        return fail(named.error());
    }
    advanced_ = true;
    return true;
}

bool StorageThread::Worker::end(RunLog& run) {
    Closing& closing = *run.closing;
    if (closing.finished) {
        return true;
    }
    const auto& last = closing.last.back().record;
    if (last && std::holds_alternative<run_file::EndMark>(*last) && std::get<run_file::EndMark>(*last).ended) {
        for (const WaitingRecord& dropped : std::exchange(run.checkpoints, {})) {
            dropped.writing->waits = false;
            thread_.waiting_checkpoints_.fetch_sub(1);
        }
    }
    if (!run.checkpoints.empty()) {
        return false; // closes the file after the checkpoints are written
    }
    while (run.log_copy.running) {
        {
            std::unique_lock lock{thread_.mutex_};
            thread_.changed_.wait(lock, [this] { return !thread_.results_.empty(); });
        }
        run_results();
    }
    if (!closing.marked) {
        if (!commit(run, closing.last)) {
            return false;
        }
        closing.marked = true;
        run.file.reset();
    }
    if (const auto renamed = run.rename_ended(); !renamed) {
        return fail(renamed.error());
    }
    closing.finished = true;
    advanced_ = true;
    report_written(closing.last);
    return true;
}

bool StorageThread::Worker::background_step() {
    std::vector<RunLog*> runs;
    for (auto& [number, run] : runs_) {
        runs.push_back(&run);
    }
    std::stable_partition(runs.begin(), runs.end(),
                          [this](const RunLog* run) { return run->number > last_background_; });
    return std::ranges::any_of(runs, [this](RunLog* run) {
        last_background_ = run->number;
        return background_step(*run);
    });
}

bool StorageThread::Worker::background_step(RunLog& run) {
    const auto step = run.background_step();
    if (!step) {
        return fail(step.error());
    }
    if (*step) {
        report_written(run.written);
        copy_log_if_due(run);
    }
    return *step;
}

void StorageThread::Worker::report_written(std::vector<WaitingRecord>& records) {
    std::size_t bytes = 0;
    for (const WaitingRecord& record : std::exchange(records, {})) {
        bytes += record.bytes;
        if (record.done) {
            if (record.record) { // only a batch with a command has a record and a `done`
                thread_.times_.journal_wait.add(std::chrono::steady_clock::now() - record.handed_over);
            }
            record.done();
        }
        if (record.writing) {
            record.writing->took = record.took;
            record.writing->waits = false;
            thread_.waiting_checkpoints_.fetch_sub(1);
        }
    }
    const std::size_t before = thread_.waiting_bytes_.fetch_sub(bytes, std::memory_order_release);
    if (before < waiting_bytes_max || before - bytes >= waiting_bytes_max) {
        return;
    }
    const std::lock_guard lock{thread_.mutex_};
    if (thread_.when_changed_) {
        thread_.when_changed_();
    }
}

bool StorageThread::Worker::fail(const base::Refusal& why) {
    if (!std::exchange(failed_, true)) {
        thread_.set_trouble(why.message); // reports only the first error of a round
    }
    return false;
}

void StorageThread::Worker::report_lost() {
    for (const auto& [number, run] : runs_) {
        std::size_t bytes = 0, commands = 0, generations = 0;
        const auto count = [&](const std::vector<WaitingRecord>& records) {
            for (const WaitingRecord& waiting : records) {
                bytes += waiting.bytes;
                commands += waiting.record && std::holds_alternative<run_file::JournalEntry>(*waiting.record);
                generations += waiting.record && std::holds_alternative<run_file::GenerationEnded>(*waiting.record);
            }
        };
        count(run.waiting);
        if (run.closing && !run.closing->marked) {
            count(run.closing->last);
        }
        if (bytes == 0) {
            continue;
        }
        thread_.lost_ = true;
        const std::string world = std::filesystem::path{run.path}.stem().string();
        const std::string lost =
            fmt::format("{} bytes could not be written: the results of {} generations, {} commands, "
                        "and the last tick",
                        bytes, generations, commands);
        if (run.name.is_lost()) {
            log::error({.world = world},
                       "world \"{}\": {}. Its file, {}, has been moved or deleted: move it back, or restore a copy",
                       world, lost, run.path);
        } else if (run.creation) {
            log::error({.world = world}, "world \"{}\": {}. {} was not created, and no client received a success reply",
                       world, lost, run.path);
        } else {
            log::error({.world = world},
                       "world \"{}\": {}. {} contains every acknowledged command: when the disk can be written again, "
                       "restart the server to continue the world from that point",
                       world, lost, run.path);
        }
    }
}

} // namespace evod::recording
