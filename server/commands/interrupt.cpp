#include "server/commands/interrupt.h"

#include <atomic>
#include <csignal>

namespace evod::commands {
namespace {

std::atomic<bool> flag = false;
static_assert(std::atomic<bool>::is_always_lock_free); // a signal handler may write only to lock-free atomic objects
extern "C" void set_flag(int) {
    flag.store(true, std::memory_order_relaxed);
}

} // namespace

void catch_interrupts() {
    std::signal(SIGINT, set_flag);
    std::signal(SIGTERM, set_flag);
}

bool interrupted() {
    return flag.load(std::memory_order_relaxed);
}

} // namespace evod::commands
