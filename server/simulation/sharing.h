// Sharing: several processes simulate one world, each some of its islands (share.h).
//
// One process, rank 0, owns the world and calls its functions. The others follow: before a function of a shared world
// does something in which they have a part, the world orders them to call the same function. So all processes call the
// same functions in the same order, and nothing above World needs to know that a world is shared.
//
//   rank 0                          the others
//   world.advance(tick, executor) → order Advance, tick → world.advance(tick, executor)
//   ← both exchange what the other processes need (world_sharing.cpp) →
//
// Threads      rank 0 uses a leader and its worlds on one thread at a time; the others call follow().
// Determinism  the state of a world does not depend on how it is shared.
#pragma once

#include "server/base/exchange.h"
#include "server/base/executor.h"
#include "server/base/packing.h"

#include <cstdint>
#include <new>
#include <string>
#include <utility>
#include <vector>

namespace evod::simulation {

/// What the other processes do next. Except for the first two and the last two, the functions of World have these names.
enum class Order : std::uint8_t {
    Create,     // followed by ParameterSet, seed, schedule; swapped: first populations
    Open,       // followed by seed, Opening, whether founders are known, schedule; swapped: organisms and founders
    Restore,    // followed by WorldState without islands; swapped: states of islands
    SetPlanned, // followed by planned changes, number of changes planned so far
    Advance,    // followed by the tick
    Request,    // followed by Parameters
    Plan,       // followed by the planned change
    Cancel,     // followed by the id
    Place,      // followed by the command
    Remove,     // followed by the command
    SetFitness, // followed by the command
    Bring,      // followed by a list of WantedIsland
    TurnOver,
    Bred,
    Outcomes,
    State,
    LiveStatistics,
    Drop, // the world ends
    End,  // no more orders; of no world
};

/// Thrown in all processes that share a new world: memory does not suffice in one of them.
struct TooLargeToShare : std::bad_alloc {};

/// Rank 0 of the processes that share worlds. Its end ends follow() in all others.
class Leader {
  public:
    /// exchange  must outlive the leader.
    explicit Leader(base::Exchange& exchange) : exchange_{exchange} {}
    Leader(const Leader&) = delete;
    Leader& operator=(const Leader&) = delete;
    ~Leader() { order(Order::End, 0, {}); }

    base::Exchange& exchange() { return exchange_; }
    /// Returns the number of the next shared world.
    std::uint64_t next_world() { return ++worlds_; }
    void order(Order order, std::uint64_t world, base::Packer arguments);

  private:
    base::Exchange& exchange_;
    std::uint64_t worlds_ = 0;
};

/// Performs the orders of rank 0 until the leader ends. All ranks but 0 call it.
void follow(base::Exchange& exchange, base::Executor& executor);

/// How one world is shared. Every world has its own; it moves with the world.
class Sharing {
  public:
    /// The world is not shared.
    Sharing() = default;
    /// A new world of rank 0. With fewer islands than processes, it is not shared.
    ///
    /// leader  must outlive the world; nullptr: the world is not shared.
    Sharing(Leader* leader, std::uint32_t island_count);
    /// The world of a process that follows.
    explicit Sharing(base::Exchange& exchange) : exchange_{&exchange} {}

    Sharing(const Sharing& other);
    Sharing(Sharing&& other) noexcept { swap(other); }
    Sharing& operator=(Sharing other) noexcept {
        swap(other);
        return *this;
    }
    ~Sharing();

    base::Exchange& exchange() const { return *exchange_; }
    /// nullptr if the world is not shared, and in processes that follow.
    Leader* leader() const { return leader_; }
    bool is_shared() const { return exchange_->size() > 1; }

    /// Orders the other processes to call a function of this world. Does nothing if they have no part in it.
    ///
    /// add_arguments  add_arguments(packer)
    template <class AddArguments>
    void order(Order order, AddArguments&& add_arguments) const {
        if (leader_ != nullptr) {
            base::Packer arguments;
            add_arguments(arguments);
            leader_->order(order, world_, std::move(arguments));
        }
    }
    void order(Order order) const {
        this->order(order, [](base::Packer&) {});
    }

  private:
    void swap(Sharing& other) noexcept {
        std::swap(exchange_, other.exchange_);
        std::swap(leader_, other.leader_);
        std::swap(world_, other.world_);
    }

    base::Exchange* exchange_ = &base::no_exchange();
    Leader* leader_ = nullptr;
    std::uint64_t world_ = 0; // its number, if there is a leader
};

/// Collects something of every island on rank 0. All processes that share the world must call it.
///
/// share   the islands of this process.
/// pack    pack(packer, island) writes that of an island of this process.
/// unpack  unpack(unpacker, island) reads that of an island of another process.
template <class Pack, class Unpack>
void collect_islands(base::Exchange& exchange, base::Range share, Pack&& pack, Unpack&& unpack) {
    if (exchange.size() == 1) {
        return;
    }
    base::Packer packer;
    for (std::size_t island = share.begin; exchange.rank() > 0 && island < share.end; ++island) {
        pack(packer, island);
    }
    const std::vector<std::string> parts = exchange.collect(packer.take());
    std::size_t island = share.end; // rank 0 has the first islands
    for (std::size_t rank = 1; rank < parts.size(); ++rank) {
        for (base::Unpacker unpacker{parts[rank]}; !unpacker.empty(); ++island) {
            unpack(unpacker, island);
        }
    }
}

} // namespace evod::simulation
