#include "server/storage/storage_thread.h"

#include "server/base/overloaded.h"
#include "server/log/log.h"
#include "server/storage/data_folder.h"

#include <pthread.h>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace evod::storage {
namespace {

using base::Refusal;
using base::Result;

std::size_t bytes_of(const StorageThread::Record& record) {
    constexpr std::size_t small = 256;
    return std::visit(
        base::Overloaded{
            [](const JournalEntry& entry) { return small + entry.origin.request.size() + entry.answer.size(); },
            [](const Inherited& inherited) {
                std::size_t bytes = small;
                for (const simulation::GenerationRows& rows : inherited.history)
                    bytes += rows.size() * sizeof(simulation::GenerationStatistics);
                return bytes;
            },
            [](const GenerationBegun& begun) {
                std::size_t bytes = small;
                for (const std::vector<std::uint32_t>& founders : begun.founders)
                    bytes += founders.size() * sizeof(std::uint32_t);
                for (const evolution::NextGeneration& born : begun.born)
                    bytes += static_cast<std::size_t>(born.genes.cols()) *
                             (sizeof(float) * evolution::gene_count + sizeof(evolution::Parents));
                return bytes;
            },
            [](const GenerationEnded& ended) {
                std::size_t bytes = small;
                for (const IslandOutcome& outcome : ended.outcomes)
                    bytes += small + outcome.fitness.size() * (sizeof(double) + sizeof(std::uint32_t) + 1);
                return bytes;
            },
            [](const Checkpoint&) { return std::size_t{0}; }, // has a bound of its own
            [](const auto&) { return sizeof(HashLink); },
        },
        record);
}

Refusal is_there(const std::string& path) {
    return {.code = base::RefusalCode::AlreadyExists,
            .message = path + " is there already, and holds another run",
            .violations = {}};
}

} // namespace

StorageThread::StorageThread(RunFile::Options options, std::chrono::milliseconds retry_after)
    : options_{options}, retry_after_{retry_after}, thread_{[this] { work(); }} {}

StorageThread::~StorageThread() {
    {
        const std::lock_guard lock{mutex_};
        stopping_ = true;
    }
    changed_.notify_one();
    thread_.join();
}

std::vector<StorageThread::Item> StorageThread::items_of(Batch batch) {
    std::vector<Item> items;
    std::size_t bytes = 0;
    for (Record& record : batch.records) {
        const std::size_t record_bytes = bytes_of(record);
        items.push_back({.record = std::move(record), .done = {}, .writing = {}, .bytes = record_bytes});
        bytes += record_bytes;
    }
    if (items.empty())
        items.emplace_back();
    items.back().done = std::move(batch.done);
    waiting_bytes_.fetch_add(bytes, std::memory_order_relaxed);
    return items;
}

StorageThread::RunNumber StorageThread::add(Run run, std::vector<Item> items,
                                            std::optional<std::pair<RunNumber, Closing>> old) {
    RunNumber number = 0;
    {
        const std::lock_guard lock{mutex_};
        number = ++last_number_;
        new_runs_.emplace(number, std::move(run));
        if (old)
            closing_.insert(*std::move(old));
        if (!items.empty())
            wait_in_line(number, std::move(items));
    }
    changed_.notify_one();
    return number;
}

StorageThread::RunNumber StorageThread::create(const std::string& path, RunIdentity identity, Batch first) {
    Run run;
    run.path = path;
    run.to_create = std::move(identity);
    run.unnamed = true;
    return add(std::move(run), items_of(std::move(first)));
}

StorageThread::RunNumber StorageThread::replace(RunNumber old_run, Ending ending, const std::string& path,
                                                RunIdentity identity, Batch first) {
    Run run;
    run.path = path;
    run.to_create = std::move(identity);
    run.unnamed = true;
    run.replaces = old_run;
    Closing closing{.last = items_of(std::move(ending.last)), .renamed = std::move(ending.renamed), .replaced = true};
    return add(std::move(run), items_of(std::move(first)), std::pair{old_run, std::move(closing)});
}

StorageThread::RunNumber StorageThread::adopt(std::unique_ptr<RunFile> file) {
    Run run;
    run.path = file->path();
    run.file = std::move(file);
    return add(std::move(run), {});
}

void StorageThread::write(RunNumber run, Batch batch) {
    hand_over(run, items_of(std::move(batch)));
}

void StorageThread::write(RunNumber run, Checkpoint checkpoint, std::shared_ptr<CheckpointWriting> writing) {
    writing->waits = true;
    waiting_checkpoints_.fetch_add(1);
    std::vector<Item> items;
    items.push_back({.record = std::move(checkpoint), .done = {}, .writing = std::move(writing)});
    hand_over(run, std::move(items));
}

void StorageThread::close(RunNumber run, Ending ending) {
    Closing closing{.last = items_of(std::move(ending.last)), .renamed = std::move(ending.renamed)};
    {
        const std::lock_guard lock{mutex_};
        closing_.emplace(run, std::move(closing));
        urgent_ = true;
    }
    changed_.notify_one();
}

void StorageThread::hand_over(RunNumber run, std::vector<Item> items) {
    bool wake = false;
    {
        const std::lock_guard lock{mutex_};
        wake = wait_in_line(run, std::move(items));
    }
    if (wake)
        changed_.notify_one();
}

bool StorageThread::wait_in_line(RunNumber run, std::vector<Item> items) {
    urgent_ |= items.back().done != nullptr;
    // Somebody who waits, and the first of what is gathered.
    const bool wake = urgent_ || handed_over_.empty();
    if (handed_over_.empty())
        handed_over_since_ = std::chrono::steady_clock::now();
    std::vector<Item>& waiting = handed_over_[run];
    waiting.insert(waiting.end(), std::make_move_iterator(items.begin()), std::make_move_iterator(items.end()));
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
        if (before != why && when_changed_)
            when_changed_();
    }
    if (before.empty() && !why.empty())
        log::error("{}; commands are refused until it can be written again", why);
    else if (!before.empty() && why.empty())
        log::info("run files can be written again");
}

void StorageThread::work() {
    pthread_setname_np(pthread_self(), "storage"); // as `top -H` shows it
    bool stopping = false;
    while (!stopping) {
        {
            std::unique_lock lock{mutex_};
            if (failed_) {
                changed_.wait_for(lock, retry_after_, [this] { return stopping_; });
            } else {
                changed_.wait(lock, [this] { return stopping_ || urgent_ || !handed_over_.empty(); });
                changed_.wait_for(lock, gathering_time, [this] { return stopping_ || urgent_; });
            }
            urgent_ = false;
            stopping = stopping_;
            if (!taken_since_)
                taken_since_ = handed_over_since_;
            handed_over_since_.reset();
            runs_.merge(new_runs_);
            new_runs_.clear();
            for (auto& [number, items] : std::exchange(handed_over_, {})) {
                Run& run = runs_[number];
                for (Item& item : items)
                    (item.writing ? run.checkpoints : run.waiting).push_back(std::move(item));
            }
            for (auto& [number, closing] : std::exchange(closing_, {}))
                runs_[number].closing = std::move(closing);
        }
        failed_ = false;
        for (auto& [number, run] : runs_)
            (void)write_out(run);
        for (auto& [number, run] : runs_)
            (void)write_checkpoints(run);
        std::erase_if(runs_, [](const auto& item) { return item.second.closing && item.second.closing->finished; });
        if (!failed_) {
            {
                const std::lock_guard lock{mutex_};
                taken_since_.reset();
            }
            set_trouble({});
        }
    }
}

bool StorageThread::fail(Run& run, const Refusal& why) {
    run.file.reset();
    if (!std::exchange(failed_, true))
        set_trouble(why.message); // that of the first, as long as it fails, however many do
    return false;
}

Result<void> StorageThread::begin(Run& run) {
    if (run.file) {
        run.file->begin();
        return {};
    }
    const std::string path = run.unnamed ? DataFolder::next_file_of(run.path) : run.path;
    // One that was to be created may be there already, if it is not known how creating it went.
    Result<std::unique_ptr<RunFile>> file = RunFile::open(path, options_);
    const bool is_new = run.to_create && !file;
    if (is_new) // with all that it begins with, so that nobody finds one that has less
        file = RunFile::begin_new(path, *run.to_create, options_);
    else if (run.to_create && (*file)->identity().run_id != run.to_create->run_id)
        file = is_there(path);
    if (!file)
        return file.error();
    run.file = *std::move(file);
    if (!is_new)
        run.file->begin();
    return {};
}

bool StorageThread::commit(Run& run, const std::vector<Item>& items) {
    if (std::ranges::none_of(items, [](const Item& item) { return item.record.has_value(); }))
        return true;
    const auto began = std::chrono::steady_clock::now();
    if (auto begun = begin(run); !begun)
        return fail(run, begun.error());
    for (const Item& item : items)
        if (item.record)
            std::visit([&](const auto& record) { run.file->write(record); }, *item.record);
    if (auto committed = run.file->commit(); !committed)
        return fail(run, committed.error());
    if (run.to_create)
        if (auto settled = run.file->settle(); !settled)
            return fail(run, settled.error());
    run.to_create.reset();
    run.commit_took = std::chrono::steady_clock::now() - began;
    return true;
}

void StorageThread::tell(const Run& run, std::vector<Item>& items) {
    std::size_t bytes = 0;
    for (const Item& item : std::exchange(items, {})) {
        bytes += item.bytes;
        if (item.done)
            item.done();
        if (item.writing) {
            item.writing->took = run.commit_took;
            item.writing->waits = false;
            waiting_checkpoints_.fetch_sub(1);
        }
    }
    const std::size_t before = waiting_bytes_.fetch_sub(bytes, std::memory_order_release);
    if (before < waiting_bytes_max || before - bytes >= waiting_bytes_max)
        return;
    const std::lock_guard lock{mutex_};
    if (when_changed_)
        when_changed_();
}

bool StorageThread::write_out(Run& run) {
    const bool news = !run.waiting.empty();
    if (news) {
        if (!commit(run, run.waiting))
            return false;
        run.written.insert(run.written.end(), std::make_move_iterator(run.waiting.begin()),
                           std::make_move_iterator(run.waiting.end()));
        run.waiting.clear();
    }
    if (run.unnamed && !run.to_create && !take_place(run))
        return false;
    tell(run, run.written);
    if (run.closing)
        return run.closing->replaced || end(run);
    // What is written stays written if this fails.
    if (news && run.file)
        if (const auto thinned = run.file->thin_if_large(); !thinned)
            return fail(run, thinned.error());
    if (run.file && !run.said_large && run.file->is_large()) {
        log::warn("{} is larger than it should be: what is kept for good takes more", run.path);
        run.said_large = true;
    }
    return true;
}

bool StorageThread::write_checkpoints(Run& run) {
    if (run.checkpoints.empty())
        return true;
    if (!run.waiting.empty() || run.unnamed || !commit(run, run.checkpoints))
        return false;
    tell(run, run.checkpoints);
    return true;
}

bool StorageThread::take_place(Run& run) {
    if (const auto old = run.replaces ? runs_.find(*run.replaces) : runs_.end(); old != runs_.end()) {
        old->second.closing->replaced = false;
        if (!write_out(old->second))
            return false;
    }
    run.file.reset();
    std::error_code error;
    if (std::filesystem::exists(run.path, error))
        return fail(run, is_there(run.path));
    if (const auto moved = RunFile::rename(DataFolder::next_file_of(run.path), run.path); !moved)
        return fail(run, moved.error());
    run.replaces.reset();
    run.unnamed = false;
    return true;
}

bool StorageThread::end(Run& run) {
    Closing& closing = *run.closing;
    if (closing.finished)
        return true;
    if (!write_checkpoints(run))
        return false;
    if (!closing.marked) {
        if (!commit(run, closing.last))
            return false;
        closing.marked = true;
        run.file.reset();
    }
    if (!closing.renamed.empty())
        if (const auto moved = RunFile::rename(run.path, closing.renamed); !moved)
            return fail(run, moved.error());
    closing.finished = true;
    tell(run, closing.last);
    return true;
}

} // namespace evod::storage
