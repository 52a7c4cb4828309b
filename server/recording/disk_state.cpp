#include "server/recording/disk_state.h"

#include "server/log/log.h"

#include <utility>

namespace evod::recording {

std::optional<std::string> DiskState::trouble() const {
    const std::lock_guard lock{mutex_};
    return trouble_.empty() ? std::nullopt : std::optional{trouble_};
}

RunFaults DiskState::faults() const {
    const std::lock_guard lock{mutex_};
    return faults_;
}

void DiskState::set_faults(RunFaults faults) {
    const std::lock_guard lock{mutex_};
    if (faults_ != faults) {
        faults_ = std::move(faults);
        if (when_changed_) {
            when_changed_();
        }
    }
}

StorageLimits DiskState::limits() const {
    const std::lock_guard lock{mutex_};
    return limits_;
}

void DiskState::set_limits(const StorageLimits& limits) {
    const std::lock_guard lock{mutex_};
    limits_ = limits;
}

void DiskState::when_changed(std::function<void()> changed) {
    const std::lock_guard lock{mutex_};
    when_changed_ = std::move(changed);
}

void DiskState::written(std::size_t bytes) {
    const std::size_t before = waiting_bytes_.fetch_sub(bytes, std::memory_order_release);
    if (before < waiting_bytes_max || before - bytes >= waiting_bytes_max) {
        return;
    }
    const std::lock_guard lock{mutex_};
    if (when_changed_) {
        when_changed_();
    }
}

void DiskState::set_trouble(const std::string& why) {
    std::string before;
    {
        const std::lock_guard lock{mutex_};
        before = std::exchange(trouble_, why);
        if (before != why && when_changed_) {
            when_changed_();
        }
    }
    if (before.empty() && !why.empty()) {
        log::error("{}; commands are refused until the file can be written again", why);
    } else if (!before.empty() && why.empty()) {
        log::info("run files can be written again");
    }
}

} // namespace evod::recording
