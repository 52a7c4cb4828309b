#include "server/recording/storage_worker.h"

#include "server/log/log.h"
#include "server/run_file/data_folder.h"
#include "server/run_file/ended_runs.h"

#include <pthread.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <utility>
#include <variant>

namespace evod::recording {
namespace {

using Runs = std::map<RunNumber, RunLog>;

const std::string full_file_text = "the run file has reached " +
                                   std::to_string(2 * run_file::RunFile::class_file_bytes_max >> 20) +
                                   " MiB, the most of a world in a class: reset the world, or delete it";

/// Whether the run must not be tried now.
bool waits_for_its_file(const RunLog& run) {
    return run.fault && !run.is_damaged() && !run.retry_is_due;
}

void note_recovery(RunLog& run) {
    if (run.fault) {
        run.fault.reset();
        const std::string world = run_file::world_of(run.path);
        log::info({.world = world}, "the run file of the world \"{}\" can be written again", world);
    }
}

RunFaults faults_of(const Runs& runs) {
    RunFaults faults;
    for (const auto& [number, run] : runs) {
        if (run.fault) {
            faults.emplace(number, *run.fault);
        } else if (run.full) {
            faults.emplace(number, RunFault{.kind = RunFault::Kind::Full,
                                            .why = refusal(base::RefusalCode::ResourceExhausted, full_file_text)});
        }
    }
    return faults;
}

/// The time at which the next displaced file must be tried again; nullopt: no file is displaced.
std::optional<std::chrono::steady_clock::time_point> next_retry(const Runs& runs) {
    std::optional<std::chrono::steady_clock::time_point> next;
    for (const auto& [number, run] : runs) {
        if (run.fault && !run.is_damaged()) {
            next = next ? std::min(*next, run.retry_at) : run.retry_at;
        }
    }
    return next;
}

/// Logs how much of a run could not be written. Returns whether there was anything.
bool log_lost_records(const RunLog& run) {
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
        return false;
    }
    const std::string world = run_file::world_of(run.path);
    const std::string lost = fmt::format("{} bytes could not be written: the results of {} generations, {} commands, "
                                         "and the last tick",
                                         bytes, generations, commands);
    if (run.is_damaged()) {
        log::error({.world = world}, "world \"{}\": {}. The reason is: {}", world, lost, run.fault->why.message);
    } else if (run.fault || run.name.is_lost()) {
        log::error({.world = world},
                   "world \"{}\": {}. Its file, {}, has been moved or deleted: move it back, or restore a copy", world,
                   lost, run.path);
    } else if (run.creation) {
        log::error({.world = world}, "world \"{}\": {}. {} was not created, and no client received a success reply",
                   world, lost, run.path);
    } else {
        log::error({.world = world},
                   "world \"{}\": {}. {} contains every acknowledged command: when the disk can be written again, "
                   "restart the server to continue the world from that point",
                   world, lost, run.path);
    }
    return true;
}

bool log_lost_records(const Runs& runs) {
    bool lost_any = false;
    for (const auto& [number, run] : runs) {
        lost_any |= log_lost_records(run);
    }
    return lost_any;
}

} // namespace

bool StorageWorker::work() {
    pthread_setname_np(pthread_self(), "storage"); // the name that `top -H` shows
    constexpr int skipped_max = 8;                 // maximum number of consecutive rounds without a background step
    int skipped = 0;
    for (bool more = false;;) {
        const bool stopping = take(more);
        const bool first_try = !std::exchange(failure_, std::nullopt);
        for (auto& [number, run] : runs_) {
            jobs_.compress_next(run);
        }
        if (!stopping) { // what waits then is small, and would be lost
            check_quota();
        }
        more = !failure_ && write_records();
        if (failure_) {
            // Nothing can be written in this round.
        } else if (first_try && skipped < skipped_max && queue_.is_urgent()) {
            ++skipped;
            more = true;
        } else {
            skipped = 0;
            more |= background_step();
        }
        std::erase_if(runs_, [](const auto& item) { return item.second.is_finished(); });
        if (!failure_) {
            const bool all_written =
                std::ranges::all_of(runs_, [](const auto& run) { return run.second.waiting.empty(); });
            if (all_written) {
                queue_.all_written();
            }
            disk_.set_trouble({});
        }
        disk_.set_faults(faults_of(runs_));
        refuse_barriers();
        // When the server stops, retries failed records as long as any record can still be written. After that, the
        // failed records are lost.
        const bool advanced = std::exchange(advanced_, false);
        if (stopping && !more && !jobs_.are_running() && queue_.is_empty() && !(failure_ && advanced)) {
            const bool displaced = next_retry(runs_).has_value();
            return (!(failure_ || displaced) || !log_lost_records(runs_)) && !lost_;
        }
    }
}

bool StorageWorker::take(bool more) {
    using Clock = std::chrono::steady_clock;
    const auto retry_at = failure_ ? std::optional{Clock::now() + retry_after_} : std::nullopt;
    bool stopping = false;
    do {
        HandedOver taken = queue_.take(more, retry_at, next_retry(runs_), jobs_.are_running());
        stopping = taken.stopping;
        distribute(taken);
        refuse_barriers();
        jobs_.apply_results(runs_, false);
    } while (retry_at && !stopping && Clock::now() < *retry_at);
    const auto now = Clock::now();
    for (auto& [number, run] : runs_) {
        run.retry_is_due = stopping || now >= run.retry_at;
        if (run.retry_is_due) {
            run.retry_at = now + retry_after_;
        }
    }
    return stopping;
}

void StorageWorker::distribute(HandedOver& taken) {
    for (auto& [number, of_run] : taken.runs) {
        if (of_run.added) {
            runs_.emplace(number, *std::move(of_run.added));
        }
        RunLog& run = runs_.at(number);
        run.add(std::move(of_run.records));
        if (run.is_damaged()) {
            refuse_records_of_damaged(run);
        }
        if (of_run.closing) {
            run.closing = std::move(of_run.closing);
        }
    }
}

bool StorageWorker::write_records() {
    std::vector<RunLog*> others;
    for (auto& [number, run] : runs_) {
        if (run.closing ||
            std::ranges::any_of(run.waiting, [](const WaitingRecord& record) { return record.ticket != 0; })) {
            (void)write_records(run);
        } else if (!run.waiting.empty() || run.creation) {
            others.push_back(&run);
        }
    }
    // The runs take turns, even if there are many commands.
    std::stable_partition(others.begin(), others.end(),
                          [this](const RunLog* run) { return run->number > last_written_; });
    for (RunLog* run : others) {
        if (run != others.front() && queue_.is_urgent()) {
            return true;
        }
        last_written_ = run->number;
        (void)write_records(*run);
    }
    return false;
}

bool StorageWorker::write_records(RunLog& run) {
    if (run.is_damaged()) {
        return end_damaged(run);
    }
    if (waits_for_its_file(run)) {
        return false;
    }
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
    if (run.creation && run.creation->committed && !rename_to_final_name(run)) {
        return false;
    }
    release(run.written);
    if (run.closing) {
        return run.closing->replaced || end(run);
    }
    if (has_records && run.file) {
        if (const auto shrunk = run.shrink(); !shrunk) { // the records are written even if this fails
            return fail(run, shrunk.error());
        }
    }
    return true;
}

bool StorageWorker::is_its_turn(RunLog& run) {
    for (auto& [number, earlier] : runs_) {
        if (number >= run.number) {
            break;
        }
        if (earlier.path != run.path) {
            continue;
        }
        const bool is_replaced = run.creation && run.creation->replaces == number;
        const auto is_out_of_the_way = [&, &log = earlier] {
            return is_replaced ? !log.creation || log.is_damaged() : log.is_finished();
        };
        if (!is_out_of_the_way()) {
            (void)write_records(earlier);
            if (!is_out_of_the_way()) {
                if (earlier.fault && !earlier.is_damaged()) {
                    run.fault = earlier.fault; // otherwise its records would wait without a reason
                    run.retry_at = earlier.retry_at;
                    run.retry_is_due = false;
                }
                return false;
            }
        }
    }
    return true;
}

bool StorageWorker::commit(RunLog& run, const std::vector<WaitingRecord>& records) {
    const auto took = run.commit(records);
    if (!took) {
        return fail(run, took.error());
    }
    if (took->count() > 0) {
        times_.commit.add(*took);
        jobs_.copy_log_if_due(run);
        note_recovery(run);
        advanced_ = true;
    }
    return true;
}

bool StorageWorker::rename_to_final_name(RunLog& run) {
    const auto replaced = run.creation->replaces ? runs_.find(*run.creation->replaces) : runs_.end();
    if (replaced != runs_.end()) {
        RunLog& old = replaced->second;
        old.closing->replaced = false;
        if (!write_records(old) || !old.is_finished()) {
            return false;
        }
    }
    if (const auto named = run.rename_to_final_name(); !named) {
        return fail(run, named.error());
    }
    note_recovery(run);
    advanced_ = true;
    return true;
}

bool StorageWorker::end(RunLog& run) {
    Closing& closing = *run.closing;
    if (closing.finished) {
        return true;
    }
    if (closing.ends_run()) {
        release(run.checkpoints); // without writing them
    }
    if (!run.checkpoints.empty()) {
        return false; // closes the file after the checkpoints are written
    }
    while (run.log_copy.running) {
        jobs_.apply_results(runs_, true);
    }
    if (!closing.marked) {
        if (!commit(run, closing.last)) {
            return false;
        }
        closing.marked = true;
        run.file.reset();
    }
    if (const auto renamed = run.rename_ended_file(); !renamed) {
        return fail(run, renamed.error());
    }
    prune(run);
    finish(closing);
    return true;
}

void StorageWorker::prune(const RunLog& ended) {
    auto keep = disk_.limits().keep_runs;
    std::string rule = "--keep-runs " + std::to_string(keep.value_or(0));
    if (ended.of_class && keep.value_or(class_runs_kept) >= class_runs_kept) {
        keep = class_runs_kept;
        rule = "the newest " + std::to_string(class_runs_kept) + " ended runs of a world in a class stay";
    }
    if (!keep || ended.closing->renamed.empty()) {
        return;
    }
    const std::string world = run_file::world_of(ended.path);
    const auto deleted = run_file::prune(std::filesystem::path{ended.path}.parent_path().string(), *keep, world);
    if (!deleted) {
        log::warn({.world = world}, "{}: {}", rule, deleted.error().message);
        return;
    }
    for (const std::string& failure : deleted->failures) {
        log::warn({.world = world}, "{}: {}", rule, failure);
    }
    for (const run_file::EndedRun& run : deleted->deleted) {
        log::info({.world = world}, "{}: deleted {}", rule, run.path);
    }
}

void StorageWorker::check_quota() {
    constexpr std::chrono::seconds interval{1};
    const auto bytes_max = disk_.limits().disk_bytes_max;
    if (!bytes_max || runs_.empty()) {
        return;
    }
    const std::string folder = std::filesystem::path{runs_.begin()->second.path}.parent_path().string();
    const auto now = std::chrono::steady_clock::now();
    if (is_over_quota_ || now - quota_checked_ >= interval) { // while it is exceeded, at each attempt to write
        is_over_quota_ = run_file::bytes_of_folder(folder) > *bytes_max;
        quota_checked_ = now;
    }
    if (is_over_quota_) {
        fail(refusal(base::RefusalCode::Unavailable,
                     "the data folder " + folder + " contains more than --disk-max allows, " +
                         std::to_string(*bytes_max) + " bytes: delete old runs with evod prune, or raise the limit"));
    }
}

void StorageWorker::finish(Closing& closing) {
    closing.finished = true;
    advanced_ = true;
    if (closing.leaving) {
        --*closing.leaving;
    }
    release(closing.last);
}

bool StorageWorker::background_step() {
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

bool StorageWorker::background_step(RunLog& run) {
    if (run.is_damaged() || waits_for_its_file(run)) {
        return false;
    }
    const auto step = run.background_step();
    if (!step) {
        return fail(run, step.error());
    }
    if (*step) {
        note_recovery(run);
        release(run.written);
        jobs_.copy_log_if_due(run);
    }
    return *step;
}

void StorageWorker::release(std::vector<WaitingRecord>& records, const std::optional<base::Refusal>& refused) {
    const std::vector<WaitingRecord> released = std::exchange(records, {});
    for (const WaitingRecord& record : released) {
        if (record.ticket != 0) {
            if (!refused && !record.is_barrier()) { // only a command has a record and a ticket
                times_.journal_wait.add(WaitingRecord::Clock::now() - record.since);
            }
            receipts_({.ticket = record.ticket, .refused = refused});
        }
        if (record.writing) {
            record.writing->took = record.took;
            record.writing->waits = false;
            --queue_.unfinished;
        }
    }
    disk_.written(bytes_of(released));
}

void StorageWorker::refuse_barriers() {
    for (auto& [number, run] : runs_) {
        const auto why = run.fault ? std::optional{run.fault->why} : failure_;
        if (!why) {
            continue;
        }
        for (std::vector<WaitingRecord>* records : {&run.written, &run.waiting}) {
            std::vector<WaitingRecord> barriers;
            std::ranges::copy_if(*records, std::back_inserter(barriers), &WaitingRecord::is_barrier);
            std::erase_if(*records, std::mem_fn(&WaitingRecord::is_barrier));
            release(barriers, why);
        }
    }
}

void StorageWorker::refuse_records_of_damaged(RunLog& run) {
    for (std::vector<WaitingRecord>* records : {&run.written, &run.waiting, &run.checkpoints}) {
        release(*records, run.fault->why);
    }
}

void StorageWorker::fail(const base::Refusal& why) {
    if (!failure_) {
        failure_ = why;
        disk_.set_trouble(why.message); // reports only the first error of a round
    }
}

bool StorageWorker::fail(RunLog& run, const base::Refusal& why) {
    const auto fault = fault_of(why);
    if (!fault) {
        fail(why);
    } else if (fault->kind == RunFault::Kind::Damaged) {
        give_up(run, why);
    } else {
        if (!run.fault) {
            const std::string world = run_file::world_of(run.path);
            log::error({.world = world},
                       "{}; commands of the world \"{}\" are refused until the file can be written again", why.message,
                       world);
        }
        run.fault = fault;
        run.retry_at = std::chrono::steady_clock::now() + retry_after_;
        run.retry_is_due = false;
    }
    return false;
}

void StorageWorker::give_up(RunLog& run, const base::Refusal& why) {
    while (run.log_copy.running) { // the simulation thread may rename the file as soon as the fault is reported
        jobs_.apply_results(runs_, true);
    }
    run.file.reset();
    run.fault = RunFault{.kind = RunFault::Kind::Damaged, .why = why};
    (void)log_lost_records(run);
    keep_old_run(run);
    disk_.set_faults(
        faults_of(runs_)); // before the refusals, so that a client that has received one finds the world damaged
    refuse_records_of_damaged(run);
    lost_ |= run.closing && run.closing->renamed.empty();
    if (run.closing) {
        (void)end_damaged(run);
    }
}

void StorageWorker::keep_old_run(RunLog& replacement) {
    const auto old = replacement.creation && replacement.creation->replaces
                         ? runs_.find(*replacement.creation->replaces)
                         : runs_.end();
    if (old == runs_.end() || !old->second.closing || !old->second.closing->replaced) {
        return;
    }
    Closing& closing = *old->second.closing;
    release(closing.last, replacement.fault->why);
    closing = {};
    (void)write_records(old->second);
}

bool StorageWorker::end_damaged(RunLog& run) {
    if (!run.closing || run.closing->replaced) {
        return false;
    }
    Closing& closing = *run.closing;
    const std::string name_now = run.creation ? run_file::DataFolder::next_file_of(run.path) : run.path;
    std::error_code error;
    if (closing.renamed.empty()) {
        release(closing.last, run.fault->why);
    } else if (std::filesystem::exists(name_now, error)) {
        if (const auto renamed = run_file::rename_run_file(name_now, closing.renamed); !renamed) {
            fail(renamed.error());
            return false;
        }
    }
    finish(closing); // the world is deleted, although its file has no end mark
    return true;
}

} // namespace evod::recording
