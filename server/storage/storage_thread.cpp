#include "server/storage/storage_thread.h"

#include "server/base/overloaded.h"

#include <pthread.h>
#include <spdlog/spdlog.h>

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
            [](const GenerationBegun& begun) {
                std::size_t bytes = small;
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

StorageThread::RunNumber StorageThread::create(const std::string& path, RunIdentity identity) {
    Run run;
    run.path = path;
    run.to_create = std::move(identity);
    const std::lock_guard lock{mutex_};
    new_runs_.emplace(++last_number_, std::move(run));
    return last_number_;
}

StorageThread::RunNumber StorageThread::adopt(std::unique_ptr<RunFile> file) {
    Run run;
    run.path = file->path();
    run.file = std::move(file);
    const std::lock_guard lock{mutex_};
    new_runs_.emplace(++last_number_, std::move(run));
    return last_number_;
}

void StorageThread::write(RunNumber run, Record record, Done done) {
    std::vector<Item> items;
    items.push_back({std::move(record), std::move(done), {}});
    hand_over(run, std::move(items));
}

void StorageThread::write(RunNumber run, std::vector<Record> records) {
    std::vector<Item> items;
    for (Record& record : records)
        items.push_back({std::move(record), {}, {}});
    hand_over(run, std::move(items));
}

void StorageThread::write(RunNumber run, Checkpoint checkpoint, std::shared_ptr<CheckpointWriting> writing) {
    writing->waits = true;
    waiting_checkpoints_.fetch_add(1);
    std::vector<Item> items;
    items.push_back({std::move(checkpoint), {}, std::move(writing)});
    hand_over(run, std::move(items));
}

void StorageThread::close(RunNumber run, const EndMark& mark, std::string renamed, Done done) {
    std::vector<Item> items;
    items.push_back({mark, std::move(done), {}});
    hand_over(run, std::move(items), std::move(renamed));
}

void StorageThread::hand_over(RunNumber run, std::vector<Item> items, std::optional<std::string> closing_as) {
    bool somebody_waits = closing_as.has_value();
    std::size_t bytes = 0;
    for (Item& item : items) {
        item.bytes = bytes_of(item.record);
        bytes += item.bytes;
        somebody_waits |= item.done != nullptr;
    }
    waiting_bytes_.fetch_add(bytes, std::memory_order_relaxed);
    bool wake = false;
    {
        const std::lock_guard lock{mutex_};
        // Somebody who waits, and the first of what is gathered.
        urgent_ |= somebody_waits;
        wake = urgent_ || handed_over_.empty();
        std::vector<Item>& waiting = handed_over_[run];
        waiting.insert(waiting.end(), std::make_move_iterator(items.begin()), std::make_move_iterator(items.end()));
        if (closing_as)
            closing_.emplace(run, *std::move(closing_as));
    }
    if (wake)
        changed_.notify_one();
}

std::optional<std::string> StorageThread::trouble() const {
    const std::lock_guard lock{mutex_};
    return trouble_.empty() ? std::nullopt : std::optional{trouble_};
}

void StorageThread::set_trouble(const std::string& why) {
    std::string before;
    {
        const std::lock_guard lock{mutex_};
        before = std::exchange(trouble_, why);
    }
    if (before.empty() && !why.empty())
        spdlog::error("{}; commands are refused until it can be written again", why);
    else if (!before.empty() && why.empty())
        spdlog::info("run files can be written again");
}

void StorageThread::work() {
    pthread_setname_np(pthread_self(), "storage"); // as `top -H` shows it
    bool failed = false, stopping = false;
    while (!stopping) {
        {
            std::unique_lock lock{mutex_};
            if (failed) {
                changed_.wait_for(lock, retry_after_, [this] { return stopping_; });
            } else {
                changed_.wait(lock, [this] { return stopping_ || !handed_over_.empty(); });
                changed_.wait_for(lock, gathering_time, [this] { return stopping_ || urgent_; });
            }
            urgent_ = false;
            stopping = stopping_;
            runs_.merge(new_runs_);
            new_runs_.clear();
            for (auto& [number, items] : std::exchange(handed_over_, {})) {
                std::vector<Item>& waiting = runs_[number].waiting;
                waiting.insert(waiting.end(), std::make_move_iterator(items.begin()),
                               std::make_move_iterator(items.end()));
            }
            for (auto& [number, renamed] : std::exchange(closing_, {})) {
                runs_[number].closing = true;
                runs_[number].renamed = std::move(renamed);
            }
        }
        failed = false;
        for (auto& [number, run] : runs_)
            failed |= !write_out(run);
        std::erase_if(runs_, [](const auto& item) { return item.second.closing && item.second.waiting.empty(); });
        if (!failed)
            set_trouble({});
    }
}

Result<void> StorageThread::open(Run& run) {
    if (run.file)
        return {};
    // One that was to be created may be there already, if it is not known how creating it went.
    Result<std::unique_ptr<RunFile>> file = RunFile::open(run.path, options_);
    if (run.to_create && !file)
        file = RunFile::create(run.path, *run.to_create, options_);
    else if (run.to_create && (*file)->identity().run_id != run.to_create->run_id)
        file = Refusal{.code = base::RefusalCode::AlreadyExists,
                       .message = run.path + " is there already, and holds another run",
                       .violations = {}};
    if (!file)
        return file.error();
    run.file = *std::move(file);
    run.to_create.reset();
    return {};
}

bool StorageThread::write_out(Run& run) {
    if (run.waiting.empty())
        return true;
    const auto fail = [&](const Refusal& why) {
        run.file.reset();
        set_trouble(why.message);
        return false;
    };
    if (auto opened = open(run); !opened)
        return fail(opened.error());
    const auto began = std::chrono::steady_clock::now();
    run.file->begin();
    for (const Item& item : run.waiting)
        std::visit([&](const auto& record) { run.file->write(record); }, item.record);
    if (auto committed = run.file->commit(); !committed)
        return fail(committed.error());
    const auto took = std::chrono::steady_clock::now() - began;

    std::size_t bytes = 0;
    std::vector<Item> written = std::exchange(run.waiting, {});
    // Not after an end mark, which counts the rows. What is written stays written if this fails.
    bool sound = true;
    if (!run.closing)
        if (const auto thinned = run.file->thin_if_large(); !thinned)
            sound = fail(thinned.error());
    if (run.file && !run.said_large && run.file->is_large()) {
        spdlog::warn("{} is larger than it should be: what is kept for good takes more", run.path);
        run.said_large = true;
    }
    if (run.closing) {
        run.file.reset();
        if (!run.renamed.empty())
            if (const auto moved = RunFile::rename(run.path, run.renamed); !moved)
                spdlog::error("{}", moved.error().message);
    }
    for (const Item& item : written) {
        bytes += item.bytes;
        if (item.done)
            item.done();
        if (item.writing) {
            item.writing->took = took;
            item.writing->waits = false;
            waiting_checkpoints_.fetch_sub(1);
        }
    }
    waiting_bytes_.fetch_sub(bytes, std::memory_order_release);
    return sound;
}

} // namespace evod::storage
