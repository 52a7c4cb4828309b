#include "server/storage/recorder.h"

#include "server/base/assert.h"

#include <chrono>
#include <utility>

namespace evod::storage {

void RunRecorder::hand_over(const simulation::World& world) {
    // Together, so that a file tells of a tick all there is to tell or nothing.
    std::vector<StorageThread::Record> records;
    const simulation::Moment& moment = world.moment();
    if (moment.generation != written_.generations) {
        records.emplace_back(beginning_of(world));
        written_.generations = moment.generation;
    }
    const bool new_tick = moment.tick > written_.tick;
    written_.tick = std::max(written_.tick, moment.tick);
    if (new_tick && moment.tick % ticks_per_link == 0)
        records.emplace_back(HashLink{moment.tick, world.hash()});
    if (world.generation_over() && generations_ended_ != moment.generation) {
        records.emplace_back(end_of(world));
        generations_ended_ = moment.generation;
    }
    if (!records.empty())
        thread_.write(number_, std::move(records));
}

void RunRecorder::journal(std::uint64_t tick, const simulation::RunControl& control, Origin origin, std::string answer,
                          StorageThread::Done done) {
    written_.tick = std::max(written_.tick, tick);
    thread_.write(number_,
                  JournalEntry{.number = ++written_.journal_entries,
                               .tick = tick,
                               .origin = std::move(origin),
                               .answer = std::move(answer),
                               .control = control},
                  std::move(done));
}

void RunRecorder::close(std::uint64_t tick, bool ended, std::string renamed) {
    written_.tick = std::max(written_.tick, tick);
    written_.ended = ended;
    thread_.close(number_, written_, std::move(renamed));
}

std::optional<base::Refusal> Recorder::refusal() const {
    const auto trouble = thread_.trouble();
    if (!trouble)
        return std::nullopt;
    return base::Refusal{.code = base::RefusalCode::Unavailable,
                         .message = "nothing can be changed while it cannot be written down: " + *trouble,
                         .violations = {}};
}

RunRecorder* Recorder::of(const std::string& world) {
    const auto found = runs_.find(world);
    return found == runs_.end() ? nullptr : &found->second;
}

RunRecorder& Recorder::begin(const simulation::Entry& entry) {
    using namespace std::chrono;
    const auto now = duration_cast<milliseconds>(system_clock::now().time_since_epoch());
    const auto number =
        thread_.create(folder_.file_of(entry.name), {.name = entry.name,
                                                     .run_id = entry.run_id,
                                                     .seed = entry.world.seed(),
                                                     .parameters = entry.world.parameters().requested,
                                                     .began_unix_ms = now.count(),
                                                     .first_population = entry.world.first_population()});
    const auto [run, added] = runs_.emplace(entry.name, RunRecorder{thread_, number});
    EVOD_ASSERT(added);
    run->second.follow(entry.world);
    return run->second;
}

RunRecorder& Recorder::go_on(const std::string& world, std::unique_ptr<RunFile> file, const EndMark& so_far,
                             std::uint64_t generations_ended) {
    const auto number = thread_.adopt(std::move(file));
    const auto [run, added] = runs_.emplace(world, RunRecorder{thread_, number, so_far, generations_ended});
    EVOD_ASSERT(added);
    return run->second;
}

void Recorder::end(const std::string& world, const simulation::RunId& run_id, std::uint64_t tick) {
    const auto run = runs_.find(world);
    if (run == runs_.end())
        return;
    run->second.close(tick, true, folder_.ended_file_of(world, run_id));
    runs_.erase(run);
}

void Recorder::close_all(const simulation::Laboratory& laboratory) {
    for (const auto& entry : laboratory.entries())
        if (RunRecorder* run = of(entry->name))
            run->close(entry->world.moment().tick, false);
    runs_.clear();
}

} // namespace evod::storage
