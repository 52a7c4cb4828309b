// Simulation thread: owns all worlds. Sleeps while no world is due, no mail arrives and the disk state does not change.
#pragma once

#include "server/runtime/simulation_loop.h"

#include <pthread.h>

#include <atomic>
#include <thread>

namespace evod::runtime {

class SimulationThread {
  public:
    /// Starts the thread. Everything handed in outlives it.
    SimulationThread(Mailbox& mailbox, StreamDemand& demand, base::Executor& executor, Clock& clock,
                     LoopOutputs outputs, simulation::Laboratory laboratory = {},
                     recording::Recorder* recorder = nullptr, std::optional<Replays::FileReplay> replay = {});
    ~SimulationThread() { stop(); }

    /// Handles the remaining mail and ends the thread.
    void stop();

    /// For CPU-time queries; not after stop().
    pthread_t handle() { return thread_.native_handle(); }

  private:
    Mailbox& mailbox_;
    recording::Recorder* const recorder_;
    std::atomic<bool> stopping_ = false;
    SimulationLoop loop_;
    std::thread thread_;
};

} // namespace evod::runtime
