// Leader: rank 0 of the processes that share worlds. It owns the worlds and calls their functions. The other processes
// follow: before a function of a shared world does something in which they have a part, it orders them to call the same
// function of their Part. So all processes call the same functions in the same order.
//
//   rank 0                          the others
//   world.advance(tick, executor) → order Advance, ticks → part.advance(ticks, executor)
//   ← both exchange what the other processes need (part.h) →
//
// A world that ends sends nothing. The next order contains the number of that world, and the others drop their part.
//
// Threads      rank 0 uses a leader and its worlds on one thread at a time; the others call follow().
// Determinism  the state of a world does not depend on how it is shared.
#pragma once

#include "server/base/exchange.h"
#include "server/base/executor.h"
#include "server/simulation/islands.h"
#include "server/simulation/shared/orders.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace evod::simulation::shared {

class Leader final : public IslandsMaker {
  public:
    /// exchange  must outlive the leader.
    explicit Leader(base::Exchange& exchange) : exchange_{exchange} {}
    Leader(const Leader&) = delete;
    Leader& operator=(const Leader&) = delete;

    bool divides(std::uint32_t island_count) const override;
    std::unique_ptr<Islands> make(base::Seed seed, std::uint32_t island_count) override;

    base::Exchange& exchange() { return exchange_; }
    /// The number of a world. The world ends when its last copy ends.
    using WorldNumber = std::shared_ptr<const std::uint64_t>;
    void order(const WorldNumber& world, Order order);
    /// Ends follow() in all other processes. The last call of all.
    void end() { order(nullptr, End{}); }

  private:
    base::Exchange& exchange_;
    std::uint64_t world_count_ = 0;
    struct World {
        std::uint64_t number;
        std::weak_ptr<const std::uint64_t> exists;
    };
    std::vector<World> worlds_; // of which the other processes have parts
};

/// Calls work(leader) on rank 0, then ends follow() in all others; also if work() throws.
void lead(base::Exchange& exchange, const std::function<void(Leader&)>& work);

/// Performs the orders of rank 0 until lead() ends there. All ranks but 0 call it.
void follow(base::Exchange& exchange, base::Executor& executor);

} // namespace evod::simulation::shared
