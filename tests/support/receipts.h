// Receipts: collects the receipts of a storage thread in a test.
#pragma once

#include "server/recording/storage_thread.h"

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

namespace evod::support {

class Receipts {
  public:
    /// A function that the storage thread calls with a receipt.
    using Call = std::function<void(const recording::Receipt&)>;

    /// Returns the receipts of this thread. The first call sets its sink.
    static std::shared_ptr<Receipts> of(recording::StorageThread& thread) {
        static std::mutex mutex;
        static std::map<recording::StorageThread*, std::weak_ptr<Receipts>> of_threads;
        const std::lock_guard lock{mutex};
        std::weak_ptr<Receipts>& known = of_threads[&thread];
        std::shared_ptr<Receipts> receipts = known.lock();
        if (!receipts) { // the sink keeps them as long as the thread exists
            known = receipts = std::make_shared<Receipts>();
            thread.set_receipt_sink([receipts](recording::Receipt receipt) { receipts->add(std::move(receipt)); });
        }
        return receipts;
    }

    recording::Ticket next_ticket(Call call = {}) {
        const std::lock_guard lock{mutex_};
        calls_.emplace(++last_ticket_, std::move(call));
        return last_ticket_;
    }
    bool has(recording::Ticket ticket) {
        const std::lock_guard lock{mutex_};
        return receipts_.contains(ticket);
    }
    /// Waits until the receipt comes.
    recording::Receipt wait_for(recording::Ticket ticket) {
        std::unique_lock lock{mutex_};
        changed_.wait(lock, [&] { return receipts_.contains(ticket); });
        return receipts_.at(ticket);
    }

  private:
    void add(recording::Receipt receipt) {
        std::unique_lock lock{mutex_};
        if (const Call call = std::move(calls_.extract(receipt.ticket).mapped())) {
            lock.unlock();
            call(receipt);
            lock.lock();
        }
        receipts_.emplace(receipt.ticket, std::move(receipt));
        changed_.notify_all();
    }

    std::mutex mutex_; // guards the members below
    std::condition_variable changed_;
    recording::Ticket last_ticket_ = 0;
    std::map<recording::Ticket, Call> calls_;
    std::map<recording::Ticket, recording::Receipt> receipts_;
};

} // namespace evod::support
