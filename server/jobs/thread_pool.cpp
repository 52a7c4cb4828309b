#include "server/jobs/thread_pool.h"

#include "server/base/assert.h"
#include "server/jobs/this_thread.h"

#include <algorithm>
#include <system_error>
#include <utility>

namespace evod::jobs {
namespace {

thread_local bool is_inside_a_piece = false;

} // namespace

ThreadPool::ThreadPool(std::size_t thread_count, int niceness)
    : thread_count_{thread_count}, niceness_{niceness}, parts_(thread_count) {
    EVOD_ASSERT(thread_count >= 1);
}

void ThreadPool::start_threads() {
    try {
        while (threads_.size() + 1 < thread_count_) {
            threads_.emplace_back([this, thread = threads_.size() + 1] {
                set_up_thread("worker", niceness_);
                work(thread);
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

void ThreadPool::divide(std::size_t count, std::size_t grain) {
    const std::size_t pieces = (count + grain - 1) / grain;
    for (std::size_t thread = 0; thread < thread_count_; ++thread) {
        parts_[thread].next.store(pieces * thread / thread_count_ * grain, std::memory_order_relaxed);
        parts_[thread].end = std::min(pieces * (thread + 1) / thread_count_ * grain, count);
    }
}

bool ThreadPool::has_pieces() const {
    return std::ranges::any_of(parts_,
                               [](const Part& part) { return part.next.load(std::memory_order_relaxed) < part.end; });
}

void ThreadPool::take_pieces(const Loop& loop, std::size_t thread) {
    is_inside_a_piece = true;
    for (std::size_t i = 0; i < thread_count_; ++i) {
        Part& part = parts_[(thread + i) % thread_count_];
        for (std::size_t begin; (begin = part.next.fetch_add(loop.grain, std::memory_order_relaxed)) < part.end;) {
            try {
                loop.body({begin, std::min(begin + loop.grain, part.end)});
            } catch (...) {
                const std::lock_guard lock{mutex_};
                failure_ = failure_ ? failure_ : std::current_exception();
            }
        }
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
    const Loop loop{body, grain};
    {
        const std::lock_guard lock{mutex_};
        EVOD_ASSERT(loop_ == nullptr);
        divide(count, grain);
        loop_ = &loop;
        loop_count_.fetch_add(1, std::memory_order_relaxed);
    }
    work_available_.notify_all();
    take_pieces(loop, 0);
    {
        const std::lock_guard lock{mutex_};
        loop_ = nullptr; // a thread that wakes up only now finds no work
    }
    yield_until([this] { return working_.load(std::memory_order_acquire) == 0; });
    std::unique_lock lock{mutex_};
    loop_finished_.wait(lock, [this] { return working_.load(std::memory_order_relaxed) == 0; });
    if (const std::exception_ptr failure = std::exchange(failure_, nullptr)) {
        lock.unlock();
        std::rethrow_exception(failure);
    }
}

template <class Predicate>
void ThreadPool::yield_until(Predicate is_over) {
    constexpr int yields_max = 200; // about as long as a thread takes to fall asleep and to wake up
    for (int i = 0; i < yields_max && !is_over(); ++i) {
        std::this_thread::yield();
    }
}

void ThreadPool::work(std::size_t thread) {
    std::unique_lock lock{mutex_};
    while (true) {
        work_available_.wait(lock, [this] { return stopping_ || (loop_ != nullptr && has_pieces()); });
        if (stopping_) {
            return;
        }
        const Loop& loop = *loop_;
        const std::uint64_t number = loop_count_.load(std::memory_order_relaxed);
        working_.fetch_add(1, std::memory_order_relaxed);
        lock.unlock();
        take_pieces(loop, thread);
        lock.lock();
        if (working_.fetch_sub(1, std::memory_order_release) == 1) {
            loop_finished_.notify_all();
        }
        lock.unlock();
        yield_until([&] { return loop_count_.load(std::memory_order_relaxed) != number; });
        lock.lock();
    }
}

} // namespace evod::jobs
