// Job queue: runs background jobs on at most threads_max threads. It serves users in turn, and the jobs of one user in
// the order of their arrival.
//
// Each kind of work has its own queue, so slow jobs of one kind cannot block other kinds.
//
// Owner        the object whose jobs it runs. A job owns its data and delivers its result itself.
// Threads      the constructor starts the first thread. The queue starts another one when a job is added and no thread
//              is idle. If the system refuses it, the job waits for a thread that exists. Any thread may call add().
// Full         never: the caller must bound the number of jobs that it adds.
#pragma once

#include "server/base/fair_queue.h"

#include <pthread.h>

#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace evod::jobs {

class JobQueue {
  public:
    /// stop  requested when the caller cancels the job and when the queue is destroyed.
    using Job = std::function<void(const std::stop_token& stop)>;

    struct Options {
        std::string name; // of the threads (this_thread.h)
        std::size_t threads_max = 1;
        std::size_t threads_per_user_max = ~std::size_t{0}; // jobs of one user that run at once
        int niceness = 0;                                   // of the threads
    };
    /// Throws std::system_error if no thread can be started.
    explicit JobQueue(Options options);
    /// Requests all jobs to stop, waits for the running jobs and drops the waiting ones.
    ~JobQueue();
    JobQueue(const JobQueue&) = delete;
    JobQueue& operator=(const JobQueue&) = delete;

    /// Adds a job.
    ///
    /// user     whose turn it takes.
    /// returns  a handle that cancels the job. A job that is cancelled while it waits still runs, with `stop`
    ///          requested.
    std::stop_source add(Job job, std::string user = {});
    /// The first thread, for reading its CPU time.
    pthread_t handle() { return threads_.front().native_handle(); }

  private:
    struct Waiting {
        Job job;
        std::stop_source stop;
        std::string user;
    };
    struct Running {
        std::string user;
        std::stop_source stop;
    };
    void work();
    void start_thread();
    bool may_run(const std::string& user) const;

    const Options options_;
    std::mutex mutex_; // guards the members below
    std::condition_variable changed_;
    base::FairQueue<Waiting> waiting_;
    std::vector<Running> running_;
    std::size_t idle_threads_ = 0;
    bool stopping_ = false;
    std::vector<std::thread> threads_; // last member, because the threads use the members above
};

} // namespace evod::jobs
