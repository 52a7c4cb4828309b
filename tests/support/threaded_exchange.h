// ThreadedExchange: connects the threads of one process, each of which plays one process of a shared world.
//
// Threads      each rank is used by one thread.
// Determinism  like every exchange.
#pragma once

#include "server/base/exchange.h"

#include <barrier>
#include <cstddef>
#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace evod::support {

class ThreadedExchange {
  public:
    explicit ThreadedExchange(std::uint32_t size) : barrier_{static_cast<std::ptrdiff_t>(size)}, sent_(size) {
        for (std::uint32_t rank = 0; rank < size; ++rank) {
            ranks_.emplace_back(*this, rank);
        }
    }

    /// Calls work(exchange) for all ranks, each on a thread of its own. Returns when all have returned.
    void run(const std::function<void(base::Exchange&)>& work) {
        std::vector<std::jthread> threads;
        for (Rank& rank : ranks_) {
            threads.emplace_back([&] { work(rank); });
        }
    }

  private:
    class Rank final : public base::Exchange {
      public:
        Rank(ThreadedExchange& all, std::uint32_t rank) : all_{all}, rank_{rank} {}
        std::uint32_t rank() const override { return rank_; }
        std::uint32_t size() const override { return static_cast<std::uint32_t>(all_.sent_.size()); }
        std::vector<std::string> gather(std::string part) override {
            return swap(std::vector<std::string>(size(), part));
        }
        std::vector<std::string> swap(std::vector<std::string> parts) override {
            all_.sent_[rank_] = std::move(parts);
            all_.barrier_.arrive_and_wait();
            std::vector<std::string> received;
            for (const std::vector<std::string>& sent : all_.sent_) {
                received.push_back(sent[rank_]);
            }
            all_.barrier_.arrive_and_wait();
            return received;
        }

        std::string broadcast(std::string from_first) override {
            return swap(std::vector<std::string>(size(), from_first)).front();
        }

      private:
        ThreadedExchange& all_;
        const std::uint32_t rank_;
    };

    std::barrier<> barrier_;
    std::vector<std::vector<std::string>> sent_; // by sender: the parts for each receiver
    std::vector<Rank> ranks_;
};

} // namespace evod::support
