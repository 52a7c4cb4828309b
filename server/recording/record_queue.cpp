#include "server/recording/record_queue.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace evod::recording {

RunNumber RecordQueue::add_run(RunLog run, std::optional<ReplacedRun> old) {
    RunNumber number = 0;
    bool wake = false;
    {
        const std::lock_guard lock{mutex_};
        number = run.number = ++last_number_;
        wake = !run.waiting.empty() && count(run.waiting);
        handed_over_.runs[number].added = std::move(run);
        if (old) {
            set_closing(old->number, std::move(old->closing));
        }
    }
    if (wake) {
        changed_.notify_one();
    }
    return number;
}

void RecordQueue::add(RunNumber run, std::vector<WaitingRecord> records) {
    bool wake = false;
    {
        const std::lock_guard lock{mutex_};
        wake = count(records);
        std::ranges::move(records, std::back_inserter(handed_over_.runs[run].records));
    }
    if (wake) {
        changed_.notify_one();
    }
}

bool RecordQueue::count(const std::vector<WaitingRecord>& records) {
    const std::size_t bytes = bytes_of(records);
    disk_.added(bytes);
    urgent_ |= bytes > gathered_bytes_max;
    for (const WaitingRecord& record : records) {
        urgent_ |= record.ticket != 0;
        has_barrier_ |= record.is_barrier();
        if (record.writing) {
            record.writing->waits = true;
            ++unfinished;
        }
    }
    // Only an urgent batch and the first batch of a group wake the thread.
    const bool is_first = !handed_over_since_;
    if (is_first) {
        handed_over_since_ = std::chrono::steady_clock::now();
    }
    return urgent_ || is_first;
}

void RecordQueue::close(RunNumber run, Closing closing) {
    {
        const std::lock_guard lock{mutex_};
        set_closing(run, std::move(closing));
        urgent_ = true;
    }
    changed_.notify_one();
}

void RecordQueue::set_closing(RunNumber run, Closing closing) {
    disk_.added(bytes_of(closing.last));
    handed_over_.runs[run].closing = std::move(closing);
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
        const auto has_work = [&] { return hurries() || handed_over_since_; };
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
    return handed_over_.runs.empty();
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
