// ThreadExecutor: a plain pool of std::thread, for tests and for ThreadSanitizer, which can see all of it.
//
// Threads      the caller of a loop works too; a loop started inside a piece runs on the thread that started it.
// Determinism  pieces are handed out in index order but finish in any.
#pragma once

#include "server/base/executor.h"

#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

namespace evod::support {

class ThreadExecutor final : public base::Executor {
  public:
    /// thread_count  threads that work at once, the caller included, >= 1.
    explicit ThreadExecutor(std::size_t thread_count);
    ~ThreadExecutor() override;

    std::size_t thread_count() const override { return threads_.size() + 1; }

  protected:
    void run(std::size_t count, std::size_t grain, base::FunctionRef<void(base::Range)> body) override;

  private:
    struct Loop {
        base::FunctionRef<void(base::Range)> body;
        std::size_t count, grain, next;
    };
    void work();
    void take_pieces(std::unique_lock<std::mutex>& lock);

    std::mutex mutex_; // guards everything below
    std::condition_variable work_available_, loop_finished_;
    Loop* loop_ = nullptr;
    std::size_t working_ = 0;
    bool stopping_ = false;
    std::vector<std::thread> threads_;
};

} // namespace evod::support
