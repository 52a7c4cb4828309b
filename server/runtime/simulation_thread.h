// Simulation thread: the thread that owns all worlds. It sleeps until a world is due, mail arrives or the state of the
// disk changes.
#pragma once

#include "server/runtime/simulation_loop.h"

#include <pthread.h>

#include <atomic>
#include <thread>

namespace evod::runtime {

class SimulationThread {
  public:
    /// Starts the thread. All arguments must outlive it.
    SimulationThread(Mailbox& mailbox, StreamDemand& demand, base::Executor& executor, Clock& clock,
                     LoopOutputs outputs, simulation::Laboratory laboratory = {},
                     recording::Recorder* recorder = nullptr, std::optional<FileReplay> replay = {});
    ~SimulationThread() { stop(); }

    /// Ends the thread after it has handled the remaining mail.
    void stop();

    /// Returns the handle of the thread, for reading its CPU time. Must not be called after stop().
    pthread_t handle() { return thread_.native_handle(); }

  private:
    Mailbox& mailbox_;
    recording::Recorder* const recorder_;
    std::atomic<bool> stopping_ = false;
    SimulationLoop loop_;
    std::thread thread_;
};

} // namespace evod::runtime
