#include "server/runtime/worker_pool.h"

#include "server/base/assert.h"
#include "server/base/inline_executor.h"

#ifdef EVOD_THREAD_EXECUTOR
#include "server/jobs/thread_pool.h"
#else
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

#include <algorithm>

namespace evod::runtime {
namespace {

#ifndef EVOD_THREAD_EXECUTOR
class Pool final : public base::Executor {
  public:
    explicit Pool(std::size_t threads)
        : control_{tbb::global_control::max_allowed_parallelism, threads}
        , arena_{static_cast<int>(threads)}
        , threads_{threads} {}

    std::size_t thread_count() const override { return threads_; }

  protected:
    void run(std::size_t count, std::size_t grain, base::FunctionRef<void(base::Range)> body) override {
        const std::size_t pieces = (count + grain - 1) / grain;
        arena_.execute([&] {
            // TBB divides the range of pieces, not of elements. Each cut is therefore a multiple of the grain.
            tbb::parallel_for(
                tbb::blocked_range<std::size_t>{0, pieces, 1},
                [&](const tbb::blocked_range<std::size_t>& range) {
                    for (std::size_t piece = range.begin(); piece < range.end(); ++piece) {
                        body({piece * grain, std::min((piece + 1) * grain, count)});
                    }
                },
                tbb::simple_partitioner{});
        });
    }

  private:
    tbb::global_control control_; // allows more threads than the machine has processors
    tbb::task_arena arena_;
    std::size_t threads_;
};
#endif

} // namespace

std::unique_ptr<base::Executor> make_executor(std::size_t threads) {
    EVOD_ASSERT(threads >= 1);
    if (threads == 1) {
        return std::make_unique<base::InlineExecutor>();
    }
#ifdef EVOD_THREAD_EXECUTOR
    return std::make_unique<jobs::ThreadPool>(threads);
#else
    return std::make_unique<Pool>(threads);
#endif
}

} // namespace evod::runtime
