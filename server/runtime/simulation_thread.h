// Simulation thread: a thread that owns worlds. It sleeps until a world is due, mail arrives or the state of the disk
// changes.
#pragma once

#include "server/runtime/simulation_loop.h"

#include <pthread.h>

#include <atomic>
#include <memory>
#include <thread>

namespace evod::runtime {

class SimulationThread {
  public:
    struct Options {
        const char* name = "simulation"; // a literal, which `top -H` shows
        int niceness = 0;
    };
    /// Starts the thread. The mailbox of the loop and the recorder must outlive it.
    ///
    /// recorder  of the loop; nullptr if it has none.
    SimulationThread(Options options, Mailbox& mailbox, std::unique_ptr<SimulationLoop> loop,
                     recording::Recorder* recorder = nullptr);
    ~SimulationThread() { stop(); }

    /// Ends the thread after it has handled the remaining mail.
    void stop();

    const char* name() const { return name_; }
    /// Returns the handle of the thread, for reading its CPU time. Must not be called after stop().
    pthread_t handle() { return thread_.native_handle(); }

  private:
    const char* const name_;
    Mailbox& mailbox_;
    recording::Recorder* const recorder_;
    std::atomic<bool> stopping_ = false;
    const std::unique_ptr<SimulationLoop> loop_;
    std::thread thread_;
};

} // namespace evod::runtime
