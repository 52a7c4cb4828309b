// Job queue: runs background jobs, first in, first out, on at most so many threads.
//
// Each kind of work has a queue of its own, so that a kind with slow jobs cannot block another one.
//
// Owner        the object whose jobs it runs. A job owns what it works on, and hands over its result by itself.
// Threads      its own; each starts when a job finds no idle one. add() may be called on any thread.
// Full         never: the caller bounds how many jobs it adds.
#pragma once

#include <pthread.h>

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace evod::jobs {

class JobQueue {
  public:
    /// stop  requested by the caller, and when the queue is destroyed.
    using Job = std::function<void(const std::stop_token& stop)>;

    struct Options {
        std::string name; // of its threads, as `top -H` shows it; at most 15 characters
        std::size_t threads_max = 1;
        int niceness = 0;       // 10: about a tenth of a processor beside a busy thread of the simulation
        bool start_now = false; // start the first thread at once, so that handle() is valid
    };
    explicit JobQueue(Options options);
    /// Requests all jobs to stop, waits for the running ones and drops the others.
    ~JobQueue();
    JobQueue(const JobQueue&) = delete;
    JobQueue& operator=(const JobQueue&) = delete;

    /// returns  cancels the job: a waiting one runs with `stop` requested.
    std::stop_source add(Job job);
    /// The first thread, for reading its processor time; only with Options::start_now.
    pthread_t handle() { return threads_.front().native_handle(); }

  private:
    struct Waiting {
        Job job;
        std::stop_source stop;
    };
    void work();
    void start_thread();

    const Options options_;
    std::mutex mutex_; // guards what follows
    std::condition_variable changed_;
    std::deque<Waiting> waiting_;
    std::vector<std::stop_source> running_;
    std::size_t idle_threads_ = 0;
    bool stopping_ = false;
    std::vector<std::thread> threads_; // last: they use the rest
};

} // namespace evod::jobs
