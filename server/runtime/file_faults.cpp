#include "server/runtime/file_faults.h"

#include "server/log/log.h"
#include "server/replay/recovery.h"

namespace evod::runtime {

std::optional<base::Refusal> FileFaults::refusal_of(const std::string& world) const {
    const auto found = displaced_.find(world);
    if (found == displaced_.end()) {
        return std::nullopt;
    }
    return base::refusal(base::RefusalCode::Unavailable,
                         "the world accepts no commands because the server cannot record them: " +
                             found->second.message + "; send the command again when the file can be written");
}

FileFaults::Changes FileFaults::poll() {
    Changes changes;
    if (!recorder_) {
        return changes;
    }
    std::map<std::string, base::Refusal> displaced;
    for (const auto& [name, fault] : recorder_->faults()) {
        if (fault.kind == recording::RunFault::Kind::Displaced) {
            displaced.emplace(name, fault.why);
            continue;
        }
        if (builds_.holds(name)) {
            continue; // the build thread may be reading the world
        }
        const auto entry = std::as_const(laboratory_).find(name);
        const auto damaged = replay::damaged_world(name, (*entry)->run_id, fault.why);
        log::error({.world = name}, "world \"{}\" does not run any more: {}", name, damaged.reason);
        recorder_->give_up(name);
        laboratory_.replace_with_damaged(damaged);
        changes.damaged.push_back(damaged);
    }
    const auto before = std::exchange(displaced_, std::move(displaced));
    if (before.empty() && displaced_.empty()) {
        return changes;
    }
    for (const auto& entry : laboratory_.entries()) {
        const auto found = displaced_.find(entry->name);
        if (entry->replay || (found == displaced_.end() && !before.contains(entry->name))) {
            continue;
        }
        const simulation::Storage now =
            found == displaced_.end() ? *laboratory_.storage()
                                      : simulation::Storage{simulation::StorageState::Stalled, found->second.message};
        entry->storage = now;
        const auto known = before.find(entry->name);
        if ((known == before.end()) != (found == displaced_.end())) {
            changes.storage.emplace_back(entry->name, now);
        }
    }
    return changes;
}

} // namespace evod::runtime
