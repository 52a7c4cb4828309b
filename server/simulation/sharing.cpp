#include "server/simulation/sharing.h"

#include "server/base/assert.h"
#include "server/simulation/packed.h"
#include "server/simulation/world.h"

#include <map>
#include <string>

namespace evod::simulation {

void Leader::order(Order order, std::uint64_t world, base::Packer arguments) {
    if (exchange_.size() == 1) {
        return;
    }
    base::Packer packer;
    packer.add(order);
    packer.add(world);
    packer.append(std::move(arguments));
    exchange_.broadcast(packer.take());
}

Sharing::Sharing(Leader* leader, std::uint32_t island_count) {
    if (leader != nullptr && leader->exchange().size() > 1 && island_count >= leader->exchange().size()) {
        leader_ = leader;
        exchange_ = &leader->exchange();
        world_ = leader->next_world();
    }
}

Sharing::Sharing(const Sharing& other) {
    EVOD_ASSERT(!other.is_shared()); // World::copy() copies a shared world
}

Sharing::~Sharing() {
    order(Order::Drop);
}

namespace {

/// A process that follows, and its worlds.
class Follower {
  public:
    Follower(base::Exchange& exchange, base::Executor& executor) : exchange_{exchange}, executor_{executor} {}

    /// Performs the order in `bytes`. Returns whether more orders will come.
    bool perform(const std::string& bytes) {
        base::Unpacker arguments{bytes};
        const auto order = arguments.next<Order>();
        const auto number = arguments.next<std::uint64_t>();
        switch (order) {
        case Order::Create:
            create(number, [&] { return World::created(arguments, exchange_); });
            return true;
        case Order::Open:
            create(number, [&] { return World::opened(arguments, exchange_, executor_); });
            return true;
        case Order::Drop:
            worlds_.erase(number);
            return true;
        case Order::End:
            return false;
        default:
            World& world = worlds_.at(number);
            perform(order, arguments, world);
            (void)world.take_events(); // rank 0 has the same
            return true;
        }
    }

  private:
    /// Creates a world, unless memory does not suffice in any of the processes.
    template <class Make>
    void create(std::uint64_t number, Make&& make) {
        try {
            worlds_.emplace(number, make());
        } catch (const TooLargeToShare&) { // rank 0 reports it
        }
    }

    void perform(Order order, base::Unpacker& arguments, World& world) {
        switch (order) {
        case Order::Restore:
            return world.restore_share(arguments, executor_);
        case Order::SetPlanned: {
            std::vector<parameters::PlannedChange> planned(arguments.next<std::uint64_t>());
            for (parameters::PlannedChange& change : planned) {
                change = unpack_planned_change(arguments);
            }
            return world.set_planned(std::move(planned), arguments.next<std::uint64_t>());
        }
        case Order::Advance:
            return world.advance(arguments.next<std::uint64_t>(), executor_);
        case Order::TurnOver:
            return world.turn_over(executor_);
        case Order::Request:
            return world.request_parameters(parameters::RequestedParameters{arguments.next<parameters::Parameters>()});
        case Order::Plan:
            world.plan(unpack_planned_change(arguments));
            return;
        case Order::Cancel:
            (void)world.cancel(arguments.next<std::uint64_t>());
            return;
        case Order::Place:
            (void)world.place(unpack_place_entities(arguments));
            return;
        case Order::Remove:
            (void)world.remove(unpack_remove_entities(arguments));
            return;
        case Order::SetFitness:
            return world.set_fitness(unpack_set_fitness(arguments));
        case Order::Bring:
            return world.send_islands(arguments.next_list<WantedIsland>());
        case Order::Bred:
            (void)world.bred();
            return;
        case Order::Outcomes:
            (void)world.outcomes();
            return;
        case Order::State:
            (void)world.state(executor_);
            return;
        case Order::LiveStatistics:
            (void)world.live_statistics();
            return;
        case Order::Create:
        case Order::Open:
        case Order::Drop:
        case Order::End:
            break;
        }
        EVOD_ASSERT(!"an order is known");
    }

    base::Exchange& exchange_;
    base::Executor& executor_;
    std::map<std::uint64_t, World> worlds_;
};

} // namespace

void follow(base::Exchange& exchange, base::Executor& executor) {
    Follower follower{exchange, executor};
    while (follower.perform(exchange.broadcast({}))) {
    }
}

} // namespace evod::simulation
