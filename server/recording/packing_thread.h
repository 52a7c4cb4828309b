// Packing thread: what takes long and need not be done by the storage thread, one job after another.
//
// Owner        the storage thread's object. A job owns what it works on, and hands back what comes of it by itself.
// Bound        set by who hands over: of each run at most one checkpoint to be compressed and one log to be copied.
#pragma once

#include <pthread.h>

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace evod::recording {

class PackingThread {
  public:
    using Job = std::function<void()>;

    PackingThread();
    /// Finishes the job that it is at, and drops the others.
    ~PackingThread();

    void add(Job job);
    /// To ask the system about it.
    pthread_t handle() { return thread_.native_handle(); }

  private:
    static constexpr int niceness = 10; // about a tenth of what a thread of the simulation gets beside it

    void work();

    std::mutex mutex_; // guards what follows
    std::condition_variable changed_;
    std::deque<Job> jobs_;
    bool stopping_ = false;

    std::thread thread_; // last: it uses the rest
};

} // namespace evod::recording
