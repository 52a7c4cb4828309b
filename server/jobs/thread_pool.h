// Thread pool: an Executor with threads of its own, which may have a lower priority than the rest of the program.
//
// oneTBB, which serves the live worlds, has one set of threads for the whole program, so it cannot give the replays
// threads of another priority. ThreadSanitizer can see all of this pool, but not of oneTBB.
//
// Threads      the caller of a loop works too. A loop that is started inside a piece runs on the thread that started it.
//              One thread at a time may start a loop from outside.
// Determinism  pieces are handed out in index order but finish in any order.
#pragma once

#include "server/base/executor.h"

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <thread>
#include <vector>

namespace evod::jobs {

class ThreadPool final : public base::Executor {
  public:
    /// The first loop starts the threads. If the system refuses some, the pool works with fewer.
    ///
    /// thread_count  threads that work at once, the caller included, >= 1.
    /// niceness      of the threads that the pool starts, in addition to that of the caller of the first loop.
    explicit ThreadPool(std::size_t thread_count, int niceness = 0);
    ~ThreadPool() override;

    std::size_t thread_count() const override { return thread_count_; }

  protected:
    void run(std::size_t count, std::size_t grain, base::FunctionRef<void(base::Range)> body) override;

  private:
    struct Loop {
        base::FunctionRef<void(base::Range)> body;
        const std::size_t count, grain;
        std::atomic<std::size_t> next = 0; // the first index that no thread has taken; may exceed count
        bool is_handed_out() const { return next.load(std::memory_order_relaxed) >= count; }
        void take_pieces();
    };
    void start_threads();
    void work();

    const std::size_t thread_count_;
    const int niceness_;
    std::mutex mutex_; // guards the members below
    std::condition_variable work_available_, loop_finished_;
    Loop* loop_ = nullptr;
    std::size_t working_ = 0; // threads of the pool that may use loop_
    bool stopping_ = false;
    std::vector<std::thread> threads_;
};

} // namespace evod::jobs
