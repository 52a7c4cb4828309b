#include "server/runtime/demand.h"

#include <utility>

namespace evod::runtime {

void Demand::set(Watches watches) {
    const std::lock_guard lock{mutex_};
    watches_ = std::move(watches);
    changed_.store(true, std::memory_order_release);
}

Watches Demand::take() {
    const std::lock_guard lock{mutex_};
    changed_.store(false, std::memory_order_release);
    return watches_;
}

} // namespace evod::runtime
