#include "server/recording/recorder.h"

#include "server/base/assert.h"

#include <chrono>
#include <filesystem>
#include <utility>

namespace evod::recording {

void RunRecorder::pass_new_records(const simulation::World& world) {
    // Passes the records in one batch, so that a file contains either all records of a tick or none.
    std::vector<Record> records;
    const std::uint64_t begun = news_.generations_begun();
    news_.report(world, [&records](auto record) { records.emplace_back(std::move(record)); });
    if (news_.generations_begun() != begun) {
        since_beginning_ = {};
    }
    if (!records.empty()) {
        thread_.write(number_, {.records = std::move(records)});
    }
}

bool RunRecorder::checkpoint_due(const simulation::World& world, std::chrono::nanoseconds spent) {
    since_beginning_ += spent;
    since_checkpoint_ += spent;
    // If a generation is over, the next generation begins with the next tick and is stored then.
    return since_beginning_ > worth_a_checkpoint && !world.generation_over() && !writing_->waits &&
           since_checkpoint_ > checkpoint_cost_factor * (copying_took_ + writing_->took.load());
}

void RunRecorder::make_checkpoint(const simulation::World& world, base::Executor& executor) {
    news_.seen(world.moment().tick);
    thread_.write(number_, run_file::checkpoint_of(world, journal_entries_, executor), writing_);
    since_beginning_ = since_checkpoint_ = {};
}

run_file::JournalEntry RunRecorder::entry(CommandRecord& command) {
    news_.seen(command.tick);
    return {.number = ++journal_entries_,
            .tick = command.tick,
            .origin = std::move(command.origin),
            .answer = std::move(command.answer),
            .control = command.control};
}

void RunRecorder::journal(CommandRecord command) {
    std::vector<Record> records;
    records.emplace_back(entry(command));
    thread_.write(number_, {std::move(records), command.ticket});
}

StorageThread::Batch RunRecorder::first(run_file::RunBeginning beginning, std::optional<CommandRecord> command) {
    const run_file::RunIdentity& run = beginning.identity;
    news_ = {run.first_tick, run.first_generation, beginning.ended ? run.first_generation : 0};
    StorageThread::Batch batch{.records = run_file::RunFile::records_of(std::move(beginning))};
    if (command) {
        batch.records.emplace_back(entry(*command));
        batch.ticket = command->ticket;
    }
    return batch;
}

StorageThread::Ending RunRecorder::ending(std::uint64_t tick, bool ended, std::string renamed,
                                          std::optional<CommandRecord> command) {
    StorageThread::Ending ending{.last = {}, .renamed = std::move(renamed)};
    if (command) {
        ending.last.records.emplace_back(entry(*command));
        ending.last.ticket = command->ticket;
    }
    news_.seen(tick);
    ending.last.records.emplace_back(run_file::EndMark{.ended = ended, .tick = news_.tick()});
    return ending;
}

std::optional<base::Refusal> Recorder::refusal() const {
    const auto why = trouble();
    if (!why) {
        return std::nullopt;
    }
    return base::Refusal{.code = base::RefusalCode::Unavailable,
                         .message = "the server accepts no commands because it cannot record them: " + *why +
                                    "; send the command again when the disk can be written",
                         .violations = {}};
}

std::map<std::string, RunFault> Recorder::faults() const {
    std::map<std::string, RunFault> of_worlds;
    const RunFaults faults = thread_.disk().faults();
    if (!faults.empty()) {
        for (const auto& [world, run] : runs_) {
            if (const auto found = faults.find(run.number_); found != faults.end()) {
                of_worlds.emplace(world, found->second);
            }
        }
    }
    return of_worlds;
}

void Recorder::give_up(const std::string& world) {
    const auto run = runs_.find(world);
    EVOD_ASSERT(run != runs_.end());
    thread_.close(run->second.number_, {});
    runs_.erase(run);
}

std::optional<base::Refusal> Recorder::refusal_of_place(const std::string& world) const {
    const auto leaving = leaving_.find(world);
    if (runs_.contains(world) || (leaving != leaving_.end() && *leaving->second > 0)) {
        return std::nullopt;
    }
    const std::string path = folder_.file_of(world);
    for (const std::string& taken : {path, run_file::DataFolder::next_file_of(path)}) {
        std::error_code error; // if the file cannot be examined, its creation reports the reason
        if (std::filesystem::exists(taken, error)) {
            return base::refusal(base::RefusalCode::AlreadyExists,
                                 "the run would be stored in " + taken +
                                     ", which exists already and belongs to no world of this "
                                     "server: move that file, or choose another name");
        }
    }
    return std::nullopt;
}

RunRecorder* Recorder::of(const std::string& world) {
    const auto found = runs_.find(world);
    return found == runs_.end() ? nullptr : &found->second;
}

void Recorder::add(const std::string& world, RunRecorder run) {
    const bool added = runs_.emplace(world, std::move(run)).second;
    EVOD_ASSERT(added);
}

void Recorder::begin(run_file::RunBeginning beginning, std::optional<CommandRecord> command) {
    RunRecorder run{thread_};
    const run_file::RunIdentity identity = beginning.identity;
    run.number_ =
        thread_.create(folder_.file_of(identity.name), identity, run.first(std::move(beginning), std::move(command)));
    add(identity.name, std::move(run));
}

void Recorder::begin_after_reset(run_file::RunBeginning beginning, const simulation::RunId& ended_run,
                                 std::uint64_t tick, std::optional<CommandRecord> command) {
    const run_file::RunIdentity identity = beginning.identity;
    const auto old = runs_.find(identity.name);
    EVOD_ASSERT(old != runs_.end());
    RunRecorder run{thread_};
    run.number_ = thread_.replace(
        old->second.number_, old->second.ending(tick, true, folder_.ended_file_of(identity.name, ended_run)),
        folder_.file_of(identity.name), identity, run.first(std::move(beginning), std::move(command)));
    runs_.erase(old);
    add(identity.name, std::move(run));
}

RunRecorder& Recorder::resume(const std::string& world, std::unique_ptr<run_file::RunFile> file,
                              const run_file::EndMark& so_far, std::uint64_t generations_ended) {
    const auto number = thread_.adopt(std::move(file));
    add(world, RunRecorder{thread_, number, so_far, generations_ended});
    return *of(world);
}

void Recorder::end(const std::string& world, const simulation::RunId& run_id, CommandRecord command) {
    const auto run = runs_.find(world);
    EVOD_ASSERT(run != runs_.end());
    const std::uint64_t tick = command.tick;
    std::erase_if(leaving_, [](const auto& item) { return *item.second == 0; });
    auto& leaving = leaving_[world];
    if (!leaving) {
        leaving = std::make_shared<Leaving>(0);
    }
    ++*leaving;
    StorageThread::Ending ending =
        run->second.ending(tick, true, folder_.ended_file_of(world, run_id), std::move(command));
    ending.leaving = leaving;
    thread_.close(run->second.number_, std::move(ending));
    runs_.erase(run);
}

void Recorder::close_all(const simulation::Laboratory& laboratory) {
    for (const auto& entry : laboratory.entries()) {
        if (RunRecorder* run = of(entry->name)) {
            thread_.close(run->number_, run->ending(entry->world.moment().tick, false));
        }
    }
    runs_.clear();
}

} // namespace evod::recording
