#include "server/runtime/storage_watch.h"

#include "server/log/log.h"
#include "server/replay/recovery.h"

#include <utility>

namespace evod::runtime {
namespace {

simulation::Storage storage_of(const recording::RunFault& fault) {
    const bool is_full = fault.kind == recording::RunFault::Kind::Full;
    return {is_full ? simulation::StorageState::Behind : simulation::StorageState::Stalled, fault.why.message};
}

} // namespace

StorageWatch::StorageWatch(simulation::Laboratory& laboratory, recording::Recorder* recorder, const WorldBuilds& builds,
                           const LoopOutputs& outputs)
    : laboratory_{laboratory}, recorder_{recorder}, builds_{builds}, outputs_{outputs} {
    if (recorder_) {
        laboratory_.set_storage({});
    }
}

void StorageWatch::poll(Clock::time_point now) {
    if (recorder_) {
        poll_disk(now);
        poll_files();
    }
}

std::optional<Clock::time_point> StorageWatch::due() const {
    return waiting_since_ && !laboratory_.storage()->worlds_wait() ? std::optional{*waiting_since_ + slow_disk_patience}
                                                                   : std::nullopt;
}

void StorageWatch::poll_disk(Clock::time_point at) {
    // trouble() must be read before has_room(), because the storage thread makes room before it clears the trouble.
    const auto trouble = recorder_->trouble();
    worlds_wait_ = !recorder_->has_room();
    if (!worlds_wait_ || trouble) {
        waiting_since_.reset();
    } else if (!waiting_since_) {
        waiting_since_ = at;
    }
    simulation::Storage now;
    if (trouble) {
        now = {worlds_wait_ ? simulation::StorageState::Stalled : simulation::StorageState::Failing, *trouble};
    } else if (waiting_since_ && at - *waiting_since_ >= slow_disk_patience) {
        now = {simulation::StorageState::Behind,
               std::to_string(recording::DiskState::waiting_bytes_max >> 20) + " MiB wait to be written"};
    }
    const simulation::Storage before = *laboratory_.storage();
    if (now == before) {
        return;
    }
    if (now.worlds_wait() && !before.worlds_wait()) {
        log::warn("worlds wait for the disk: {}", now.reason);
    } else if (before.worlds_wait() && !now.worlds_wait()) {
        log::info("worlds continue");
    }
    laboratory_.set_storage(now);
    outputs_.storage(now);
}

std::optional<base::Refusal> StorageWatch::refusal_of(const std::string& world) const {
    const auto found = faults_.find(world);
    if (found == faults_.end() || found->second.kind == recording::RunFault::Kind::Full) {
        return std::nullopt;
    }
    return base::refusal(base::RefusalCode::Unavailable,
                         "the world accepts no commands because the server cannot record them: " +
                             found->second.why.message + "; send the command again when the file can be written");
}

void StorageWatch::stop_damaged(const std::string& world, const base::Refusal& why) {
    const auto entry = std::as_const(laboratory_).find(world);
    const auto damaged = replay::damaged_world(world, (*entry)->run_id, why);
    log::error({.world = world}, "world \"{}\" does not run any more: {}", world, damaged.reason);
    recorder_->give_up(world);
    laboratory_.replace_with_damaged(damaged);
    outputs_.damaged(damaged);
}

void StorageWatch::poll_files() {
    std::map<std::string, recording::RunFault> faults;
    for (const auto& [name, fault] : recorder_->faults()) {
        if (fault.kind != recording::RunFault::Kind::Damaged) {
            faults.emplace(name, fault);
        } else if (!builds_.holds(name)) { // otherwise the build thread may be reading the world
            stop_damaged(name, fault.why);
        }
    }
    const auto before = std::exchange(faults_, std::move(faults));
    if (before.empty() && faults_.empty()) {
        return;
    }
    for (const auto& entry : laboratory_.entries()) {
        const auto found = faults_.find(entry->name);
        if (found == faults_.end() && !before.contains(entry->name)) {
            continue;
        }
        const simulation::Storage now = found == faults_.end() ? *laboratory_.storage() : storage_of(found->second);
        entry->storage = now;
        const bool was_faulty = before.contains(entry->name);
        if (was_faulty != (found != faults_.end())) {
            outputs_.storage_of_world(entry->name, now);
        }
    }
}

} // namespace evod::runtime
