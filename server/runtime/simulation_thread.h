// Simulation thread: the one that owns all worlds. Sleeps when nothing is due, no mail comes and the disk
// has no news.
#pragma once

#include "server/runtime/simulation_loop.h"

#include <pthread.h>

#include <atomic>
#include <thread>

namespace evod::runtime {

class SimulationThread {
  public:
    /// Starts. Everything handed in outlives the thread.
    SimulationThread(Mailbox& mailbox, StreamDemand& demand, base::Executor& executor, Clock& clock,
                     LoopOutputs outputs, simulation::Laboratory laboratory = {},
                     recording::Recorder* recorder = nullptr, std::optional<Replays::FileReplay> replay = {});
    ~SimulationThread() { stop(); }

    /// Minds the mail that waits and ends; returns when it has.
    void stop();

    /// To ask the system about it; not after stop().
    pthread_t handle() { return thread_.native_handle(); }

  private:
    Mailbox& mailbox_;
    recording::Recorder* const recorder_;
    std::atomic<bool> stopping_ = false;
    SimulationLoop loop_;
    std::thread thread_;
};

} // namespace evod::runtime
