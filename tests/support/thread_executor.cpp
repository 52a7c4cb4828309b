#include "tests/support/thread_executor.h"

#include "server/base/assert.h"

#include <algorithm>

namespace evod::support {
namespace {
thread_local bool inside_a_piece = false;
}

ThreadExecutor::ThreadExecutor(std::size_t thread_count) {
    EVOD_ASSERT(thread_count >= 1);
    for (std::size_t i = 1; i < thread_count; ++i) {
        threads_.emplace_back([this] { work(); });
    }
}

ThreadExecutor::~ThreadExecutor() {
    {
        const std::lock_guard lock{mutex_};
        stopping_ = true;
    }
    work_available_.notify_all();
    for (std::thread& thread : threads_) {
        thread.join();
    }
}

void ThreadExecutor::run(std::size_t count, std::size_t grain, base::FunctionRef<void(base::Range)> body) {
    if (inside_a_piece || threads_.empty()) {
        for (std::size_t begin = 0; begin < count; begin += grain) {
            body({begin, std::min(begin + grain, count)});
        }
        return;
    }
    Loop loop{body, count, grain, 0};
    std::unique_lock lock{mutex_};
    EVOD_ASSERT(loop_ == nullptr);
    loop_ = &loop;
    work_available_.notify_all();
    take_pieces(lock);
    loop_finished_.wait(lock, [&] { return working_ == 0 && loop.next >= loop.count; });
    loop_ = nullptr;
}

void ThreadExecutor::take_pieces(std::unique_lock<std::mutex>& lock) {
    ++working_;
    inside_a_piece = true;
    while (loop_->next < loop_->count) {
        const std::size_t begin = loop_->next;
        const std::size_t end = std::min(begin + loop_->grain, loop_->count);
        loop_->next = end;
        lock.unlock();
        loop_->body({begin, end});
        lock.lock();
    }
    inside_a_piece = false;
    --working_;
}

void ThreadExecutor::work() {
    std::unique_lock lock{mutex_};
    while (true) {
        work_available_.wait(lock, [this] { return stopping_ || (loop_ != nullptr && loop_->next < loop_->count); });
        if (stopping_) {
            return;
        }
        take_pieces(lock);
        if (working_ == 0) {
            loop_finished_.notify_all();
        }
    }
}

} // namespace evod::support
