#include "server/runtime/simulation_thread.h"

#include <pthread.h>

#include <utility>

namespace evod::runtime {

SimulationThread::SimulationThread(Mailbox& mailbox, StreamDemand& demand, base::Executor& executor, Clock& clock,
                                   LoopOutputs outputs, simulation::Laboratory laboratory,
                                   recording::Recorder* recorder, std::optional<FileReplay> replay)
    : mailbox_{mailbox}
    , recorder_{recorder}
    , loop_{mailbox, demand, executor, clock, std::move(outputs), std::move(laboratory), recorder, std::move(replay)}
    , thread_{[this] {
        pthread_setname_np(pthread_self(), "simulation"); // the name that `top -H` shows
        if (recorder_) {
            recorder_->when_changed([this] { mailbox_.wake(); });
        }
        while (!stopping_.load(std::memory_order_acquire)) {
            const auto next = loop_.pass();
            // pass() treats a stop() after the check above like mail, so the flag must be checked again before waiting.
            if (!stopping_.load(std::memory_order_acquire) && (!next || !mailbox_.pending())) {
                mailbox_.wait(next);
            }
        }
        loop_.close();
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
