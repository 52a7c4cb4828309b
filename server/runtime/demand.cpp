#include "server/runtime/demand.h"

#include <utility>

namespace evod::runtime {

void StreamDemand::set(WorldDemands worlds) {
    const std::lock_guard lock{mutex_};
    worlds_ = std::move(worlds);
    changed_.store(true, std::memory_order_release);
}

WorldDemands StreamDemand::take() {
    const std::lock_guard lock{mutex_};
    changed_.store(false, std::memory_order_release);
    return worlds_;
}

} // namespace evod::runtime
