// Exchange: what the processes that simulate one world send each other. The core receives an exchange and never creates
// one, as with executors.
//
// Every process of a world calls the same functions in the same order; each call returns when all processes have called
// it. A process is named by its rank, from 0.
//
// Threads      only the thread that advances the world calls an exchange.
// Determinism  results depend on what the ranks pass, never on which rank arrives first.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace evod::base {

class Exchange {
  public:
    virtual ~Exchange() = default;

    virtual std::uint32_t rank() const = 0;
    virtual std::uint32_t size() const = 0; // number of processes, >= 1

    /// Returns the parts of all ranks, by rank.
    virtual std::vector<std::string> gather(std::string part) = 0;
    /// Returns the parts of all ranks, by rank, on rank 0; an empty vector on all others.
    std::vector<std::string> collect(std::string part) {
        std::vector<std::string> parts(size());
        parts.front() = std::move(part);
        parts = swap(std::move(parts));
        return rank() == 0 ? std::move(parts) : std::vector<std::string>{};
    }
    /// Sends parts[r] to rank r. Returns what each rank has sent to this one, by rank.
    virtual std::vector<std::string> swap(std::vector<std::string> parts) = 0;
    /// Returns the bytes that rank 0 passes.
    virtual std::string broadcast(std::string from_first) = 0;
};

} // namespace evod::base
