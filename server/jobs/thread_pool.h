// Thread pool: an Executor with threads of its own, which may have a lower priority than the rest of the program.
//
// oneTBB, which serves the live worlds, has one set of threads for the whole program, so it cannot give the replays
// threads of another priority. ThreadSanitizer can see all of this pool, but not of oneTBB.
//
// Loops        of a tick follow one another within microseconds, less than it takes to wake a thread. So a thread that
//              finds no work yields its processor some times before it sleeps.
// Threads      the caller of a loop works too. A loop that is started inside a piece runs on the thread that started
//              it. One thread at a time may start a loop from outside.
// Exceptions   run() throws the first one that a piece has thrown, after all pieces have run.
// Determinism  any thread may compute any piece; the result must not depend on it.
#pragma once

#include "server/base/executor.h"

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
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
    /// The pieces that one thread takes first: a range of indices. When it has none left, it takes from the others. So
    /// in all loops over the same data, a thread mostly works on the same part, which is then in its cache.
    struct alignas(64) Part {
        std::atomic<std::size_t> next = 0; // the first index that no thread has taken; may exceed `end`
        std::size_t end = 0;
    };
    struct Loop {
        base::FunctionRef<void(base::Range)> body;
        const std::size_t grain;
    };
    void divide(std::size_t count, std::size_t grain);
    bool has_pieces() const;
    void take_pieces(const Loop& loop, std::size_t thread);
    void start_threads();
    /// thread  number of the thread, >= 1.
    void work(std::size_t thread);

    const std::size_t thread_count_;
    const int niceness_;
    std::vector<Part> parts_; // by number of the thread; the caller of a loop is thread 0
    /// Yields the processor until `is_over` returns true, but not for long.
    template <class Predicate>
    static void yield_until(Predicate is_over);

    std::atomic<std::uint64_t> loop_count_ = 0; // loops begun
    std::atomic<std::size_t> working_ = 0;      // threads of the pool that may use loop_
    std::mutex mutex_;                          // guards the members below, and changes of working_
    std::condition_variable work_available_, loop_finished_;
    const Loop* loop_ = nullptr;
    std::exception_ptr failure_; // the first exception that a piece of the loop has thrown
    bool stopping_ = false;
    std::vector<std::thread> threads_;
};

} // namespace evod::jobs
