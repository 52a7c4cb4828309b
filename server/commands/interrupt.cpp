#include "server/commands/interrupt.h"

#include <atomic>
#include <csignal>

namespace evod::commands {
namespace {

std::atomic<bool> came = false;
static_assert(std::atomic<bool>::is_always_lock_free); // a handler may touch no other
extern "C" void note_interrupt(int) {
    came.store(true, std::memory_order_relaxed);
}

} // namespace

void mind_interrupts() {
    std::signal(SIGINT, note_interrupt);
    std::signal(SIGTERM, note_interrupt);
}

bool interrupted() {
    return came.load(std::memory_order_relaxed);
}

} // namespace evod::commands
