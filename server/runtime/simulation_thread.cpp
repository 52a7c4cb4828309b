#include "server/runtime/simulation_thread.h"

#include "server/jobs/this_thread.h"

#include <utility>

namespace evod::runtime {

SimulationThread::SimulationThread(Options options, Mailbox& mailbox, std::unique_ptr<SimulationLoop> loop,
                                   recording::Recorder* recorder)
    : name_{options.name}, mailbox_{mailbox}, recorder_{recorder}, loop_{std::move(loop)}, thread_{[this, options] {
        jobs::set_up_thread(options.name, options.niceness);
        if (recorder_) {
            recorder_->when_changed([this] { mailbox_.wake(); });
        }
        while (!stopping_.load(std::memory_order_acquire)) {
            const auto next = loop_->pass();
            // pass() treats a stop() after the check above like mail, so the flag must be checked again before waiting.
            if (!stopping_.load(std::memory_order_acquire) && (!next || !mailbox_.pending())) {
                mailbox_.wait(next);
            }
        }
        loop_->close();
        if (recorder_) {
            recorder_->when_changed({});
        }
    }} {}

void SimulationThread::stop() {
    stopping_.store(true, std::memory_order_release);
    mailbox_.wake();
    if (thread_.joinable()) {
        thread_.join();
    }
}

} // namespace evod::runtime
