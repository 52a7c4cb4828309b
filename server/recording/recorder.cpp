#include "server/recording/recorder.h"

#include "server/base/assert.h"

#include <chrono>
#include <filesystem>
#include <utility>

namespace evod::recording {

RunRecorder::RunRecorder(StorageThread& thread, const run_file::RunBeginning& beginning)
    : thread_{thread}
    , new_records_{beginning.identity.first_tick, beginning.identity.first_generation,
                   beginning.ended ? beginning.identity.first_generation : 0} {}

void RunRecorder::pass(WaitingRecord record) {
    std::vector<WaitingRecord> records;
    records.push_back(std::move(record));
    thread_.write(number_, std::move(records));
}

void RunRecorder::pass_new_records(const simulation::World& world) {
    // Passes the records together, so that a file contains either all records of a tick or none.
    std::vector<WaitingRecord> records;
    const std::uint64_t begun = new_records_.generations_begun();
    new_records_.report(world, [&records](auto record) { records.emplace_back(std::move(record)); });
    if (new_records_.generations_begun() != begun) {
        since_beginning_ = {};
    }
    if (!records.empty()) {
        thread_.write(number_, std::move(records));
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
    new_records_.seen(world.moment().tick);
    WaitingRecord checkpoint{run_file::checkpoint_of(world, journal_entries_, executor)};
    checkpoint.writing = writing_;
    pass(std::move(checkpoint));
    since_beginning_ = since_checkpoint_ = {};
}

WaitingRecord RunRecorder::record_of(CommandRecord command) {
    new_records_.seen(command.tick);
    return WaitingRecord{run_file::JournalEntry{.number = ++journal_entries_,
                                                .tick = command.tick,
                                                .origin = std::move(command.origin),
                                                .answer = std::move(command.answer),
                                                .control = command.control},
                         command.ticket};
}

void RunRecorder::journal(CommandRecord command) {
    pass(record_of(std::move(command)));
}

Closing RunRecorder::ending(std::uint64_t tick, bool ended, std::string renamed, std::optional<CommandRecord> command) {
    Closing closing{.renamed = std::move(renamed)};
    if (command) {
        closing.last.push_back(record_of(*std::move(command)));
    }
    new_records_.seen(tick);
    closing.last.emplace_back(run_file::EndMark{.ended = ended, .tick = new_records_.tick()});
    return closing;
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

void Recorder::begin(run_file::RunBeginning beginning, std::optional<CommandRecord> command,
                     std::optional<ReplacedRun> old) {
    const std::string world = beginning.identity.name;
    RunRecorder run{thread_, beginning};
    std::optional<WaitingRecord> record;
    if (command) {
        record = run.record_of(*std::move(command));
    }
    run.number_ = thread_.create(folder_.file_of(world), std::move(beginning), std::move(record), std::move(old));
    add(world, std::move(run));
}

void Recorder::begin_after_reset(run_file::RunBeginning beginning, const simulation::RunId& ended_run,
                                 std::uint64_t tick, std::optional<CommandRecord> command) {
    const std::string world = beginning.identity.name;
    auto old = runs_.extract(world);
    EVOD_ASSERT(!old.empty());
    RunRecorder& ended = old.mapped();
    begin(std::move(beginning), std::move(command),
          ReplacedRun{ended.number_, ended.ending(tick, true, folder_.ended_file_of(world, ended_run))});
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
    Closing closing = run->second.ending(tick, true, folder_.ended_file_of(world, run_id), std::move(command));
    closing.leaving = leaving;
    thread_.close(run->second.number_, std::move(closing));
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
