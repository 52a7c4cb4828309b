#include "server/recording/record_queue.h"

#include <iterator>

namespace evod::recording {

RunNumber RecordQueue::add_run(RunLog run, std::vector<WaitingRecord> records,
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

void RecordQueue::add(RunNumber run, std::vector<WaitingRecord> records) {
    bool wake = false;
    {
        const std::lock_guard lock{mutex_};
        wake = enqueue(run, std::move(records));
    }
    if (wake) {
        changed_.notify_one();
    }
}

bool RecordQueue::enqueue(RunNumber run, std::vector<WaitingRecord> records) {
    std::size_t bytes = 0;
    for (const WaitingRecord& record : records) {
        bytes += record.bytes;
    }
    urgent_ |= records.back().ticket != 0 || bytes > gathered_bytes_max;
    has_barrier_ |= records.back().is_barrier();
    // Only an urgent batch and the first batch of a group wake the thread.
    const bool wake = urgent_ || handed_over_.records.empty();
    if (handed_over_.records.empty()) {
        handed_over_since_ = std::chrono::steady_clock::now();
    }
    std::vector<WaitingRecord>& waiting = handed_over_.records[run];
    waiting.insert(waiting.end(), std::make_move_iterator(records.begin()), std::make_move_iterator(records.end()));
    return wake;
}

void RecordQueue::close(RunNumber run, Closing closing) {
    {
        const std::lock_guard lock{mutex_};
        handed_over_.closing.emplace(run, std::move(closing));
        urgent_ = true;
    }
    changed_.notify_one();
}

void RecordQueue::stop() {
    {
        const std::lock_guard lock{mutex_};
        handed_over_.stopping = true;
    }
    changed_.notify_one();
}

std::optional<std::chrono::steady_clock::time_point> RecordQueue::waiting_since() const {
    const std::lock_guard lock{mutex_};
    return taken_since_ ? taken_since_ : handed_over_since_;
}

HandedOver RecordQueue::take(bool more, std::optional<std::chrono::steady_clock::time_point> retry_at,
                             std::optional<std::chrono::steady_clock::time_point> wake_at, bool jobs_run) {
    std::unique_lock lock{mutex_};
    const bool& stopping = handed_over_.stopping;
    const auto hurries = [&] { return urgent_ || !results_.empty() || (stopping && !jobs_run); };
    if (retry_at) {
        changed_.wait_until(lock, *retry_at,
                            [&] { return has_barrier_ || (stopping && (!jobs_run || !results_.empty())); });
    } else if (!more) {
        --unfinished;
        const auto has_work = [&] { return hurries() || !handed_over_.records.empty(); };
        if (wake_at) {
            changed_.wait_until(lock, *wake_at, has_work);
        } else {
            changed_.wait(lock, has_work);
        }
        ++unfinished;
        if (has_work()) {
            changed_.wait_for(lock, gathering_time, [&] { return hurries() || stopping; });
        }
    }
    const auto now = std::chrono::steady_clock::now();
    if (more && !retry_at && !urgent_ && !stopping &&
        !(handed_over_since_ && now - *handed_over_since_ >= gathering_time)) {
        return {};
    }
    urgent_ = has_barrier_ = false;
    if (!taken_since_) {
        taken_since_ = handed_over_since_;
    }
    handed_over_since_.reset();
    HandedOver taken = std::exchange(handed_over_, {});
    handed_over_.stopping = taken.stopping;
    return taken;
}

void RecordQueue::all_written() {
    const std::lock_guard lock{mutex_};
    taken_since_.reset();
}

bool RecordQueue::is_urgent() const {
    const std::lock_guard lock{mutex_};
    return urgent_;
}

bool RecordQueue::is_empty() const {
    const std::lock_guard lock{mutex_};
    return handed_over_.records.empty() && handed_over_.closing.empty();
}

void RecordQueue::add_result(JobResult result) {
    {
        const std::lock_guard lock{mutex_};
        results_.push_back(std::move(result));
    }
    changed_.notify_one();
}

std::vector<JobResult> RecordQueue::take_results(bool wait) {
    std::unique_lock lock{mutex_};
    if (wait) {
        changed_.wait(lock, [this] { return !results_.empty(); });
    }
    return std::exchange(results_, {});
}

} // namespace evod::recording
