#include "server/jobs/thread_pool.h"

#include "server/base/assert.h"
#include "server/jobs/this_thread.h"

#include <algorithm>
#include <system_error>

namespace evod::jobs {
namespace {

thread_local bool is_inside_a_piece = false;

} // namespace

ThreadPool::ThreadPool(std::size_t thread_count, int niceness) : thread_count_{thread_count}, niceness_{niceness} {
    EVOD_ASSERT(thread_count >= 1);
}

void ThreadPool::start_threads() {
    try {
        while (threads_.size() + 1 < thread_count_) {
            threads_.emplace_back([this] {
                set_up_thread("worker", niceness_);
                work();
            });
        }
    } catch (const std::system_error&) { // the system has no further thread
    }
}

ThreadPool::~ThreadPool() {
    {
        const std::lock_guard lock{mutex_};
        stopping_ = true;
    }
    work_available_.notify_all();
    for (std::thread& thread : threads_) {
        thread.join();
    }
}

void ThreadPool::Loop::take_pieces() {
    is_inside_a_piece = true;
    for (std::size_t begin; (begin = next.fetch_add(grain, std::memory_order_relaxed)) < count;) {
        body({begin, std::min(begin + grain, count)});
    }
    is_inside_a_piece = false;
}

void ThreadPool::run(std::size_t count, std::size_t grain, base::FunctionRef<void(base::Range)> body) {
    if (threads_.empty() && !is_inside_a_piece) {
        start_threads();
    }
    if (is_inside_a_piece || threads_.empty()) {
        for (std::size_t begin = 0; begin < count; begin += grain) {
            body({begin, std::min(begin + grain, count)});
        }
        return;
    }
    Loop loop{body, count, grain};
    {
        const std::lock_guard lock{mutex_};
        EVOD_ASSERT(loop_ == nullptr);
        loop_ = &loop;
    }
    work_available_.notify_all();
    loop.take_pieces();
    std::unique_lock lock{mutex_};
    loop_ = nullptr; // a thread that wakes up only now finds no work
    loop_finished_.wait(lock, [this] { return working_ == 0; });
}

void ThreadPool::work() {
    std::unique_lock lock{mutex_};
    while (true) {
        work_available_.wait(lock, [this] { return stopping_ || (loop_ != nullptr && !loop_->is_handed_out()); });
        if (stopping_) {
            return;
        }
        Loop& loop = *loop_;
        ++working_;
        lock.unlock();
        loop.take_pieces();
        lock.lock();
        if (--working_ == 0) {
            loop_finished_.notify_all();
        }
    }
}

} // namespace evod::jobs
