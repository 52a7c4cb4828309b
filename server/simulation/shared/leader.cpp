#include "server/simulation/shared/leader.h"

#include "server/base/assert.h"
#include "server/base/inline_executor.h"
#include "server/simulation/shared/part.h"
#include "server/simulation/state_bytes.h"

#include <map>
#include <new>
#include <utility>

namespace evod::simulation::shared {
namespace {

/// The islands of a world of rank 0 that several processes simulate. What concerns the other processes, they are
/// ordered to perform with the part of rank 0. An island of another process is brought here as a copy when it is read.
class SharedIslands final : public Islands {
  public:
    SharedIslands(Leader& leader, Leader::WorldNumber number, base::Seed seed, std::uint32_t island_count)
        : leader_{leader}, number_{std::move(number)}, part_{leader.exchange(), seed, island_count} {
        begun_.seed = seed;
    }

    void begin_generation(const parameters::Parameters& parameters, std::uint64_t generation, BredIslands bred,
                          base::Executor& executor) override {
        begun_ = {begun_.seed, generation, parameters, !bred.islands.empty()};
        if (!part_.perform(order(begun_), executor, std::move(bred))) {
            throw std::bad_alloc{};
        }
    }
    void restore(const parameters::Parameters& begun_with, const WorldState& state, base::Executor& executor) override {
        use(begun_with);
        const auto tick = static_cast<std::uint32_t>(state.moment.generation_tick);
        part_.perform(order(Restore{tick, state.parameters.active}), executor, state);
        change(tick);
    }
    Advanced advance(const parameters::Parameters& parameters, GenerationTicks ticks, base::Executor& executor,
                     std::vector<DiedOut>& died_out) override {
        use(parameters);
        ExchangedResults results = part_.perform(order(Advance{ticks}), executor);
        died_out = std::move(results.died_out);
        change(results.tick);
        Advanced advanced{.tick = results.tick, .alive_count = 0};
        for (const IslandSummary& island : results.summaries) {
            advanced.alive_count += island.alive_count;
        }
        return advanced;
    }
    std::vector<GenerationStatistics> end_generation(const parameters::Parameters& parameters, std::uint32_t tick,
                                                     std::span<const Rating> given, base::Executor& executor) override {
        use(parameters);
        return part_.perform(order(EndGeneration{tick, !given.empty()}), executor, given);
    }
    void breed_next_generation(const parameters::Parameters& parameters, std::uint64_t generation, std::uint32_t tick,
                               const Routes& routes, base::Executor& executor) override {
        use(parameters);
        if (!part_.perform(order(TurnOver{generation, tick, routes}), executor)) {
            throw std::bad_alloc{};
        }
        begun_.generation = generation + 1;
        begun_.parameters = parameters;
        brought_.clear();
        tick_ = 0;
    }
    EntityIds place(const PlaceEntities& command, const parameters::Parameters& parameters,
                    std::uint32_t tick) override {
        use(parameters);
        change(tick);
        return part_.perform(order(Place{command, tick}));
    }
    void remove(const RemoveEntities& command, std::uint32_t tick) override {
        change(tick);
        part_.perform(order(Remove{command, tick}));
    }

    std::span<const IslandSummary> summaries() const override { return part_.summaries(); }
    const Island& island(std::size_t index) const override {
        if (part_.islands().holds(index)) {
            return part_.islands().island(index);
        }
        const auto wanted = static_cast<std::uint32_t>(index);
        bring({&wanted, 1});
        return brought_.at(wanted).now;
    }
    std::span<const std::uint32_t> founders(std::size_t index) const override {
        (void)island(index);
        return part_.islands().holds(index) ? part_.islands().founders(index) : brought_.at(index).founders;
    }
    void bring(std::span<const std::uint32_t> islands) const override {
        Bring wanted;
        for (const std::uint32_t index : islands) {
            const auto here = brought_.find(index);
            if (!part_.islands().holds(index) && (here == brought_.end() || !here->second.is_current)) {
                wanted.islands.push_back({.index = index, .with_organisms = here == brought_.end()});
            }
        }
        if (wanted.islands.empty()) {
            return;
        }
        std::vector<SentIsland> sent = part_.perform(order(wanted));
        for (std::size_t i = 0; i < sent.size(); ++i) {
            receive(wanted.islands[i], std::move(sent[i]));
        }
    }
    BredIslands bred() const override { return part_.perform(order(Bred{})); }
    std::vector<IslandOutcome> outcomes() const override { return part_.perform(order(Outcomes{})); }
    std::vector<IslandState> states(base::Executor& executor) const override {
        return part_.perform(order(States{}), executor);
    }
    std::vector<LiveStatistics> live_statistics() const override { return part_.perform(order(LiveStatisticsOfAll{})); }
    std::unique_ptr<Islands> copy() const override { return nullptr; }
    IslandsMaker* maker() const override { return &leader_; }

  private:
    /// A copy of an island that another process simulates.
    struct BroughtIsland {
        Island begun; // as its generation began
        Island now;
        bool is_current; // `now` is its present state
        std::vector<std::uint32_t> founders;
    };

    /// Gives the order to the other processes and returns it.
    template <class AnOrder>
    AnOrder order(AnOrder order) const {
        leader_.order(number_, order);
        return order;
    }
    /// Orders all processes to use these parameters, if they use others.
    void use(const parameters::Parameters& parameters) {
        if (!(parameters == part_.parameters())) {
            part_.perform(order(UseParameters{parameters}));
        }
    }
    /// To be called when the islands change.
    void change(std::uint32_t tick) {
        tick_ = tick;
        for (auto& [index, island] : brought_) {
            island.is_current = false;
        }
    }
    void receive(const Bring::Island& wanted, SentIsland sent) const {
        base::InlineExecutor executor; // a reader has none
        if (wanted.with_organisms) {
            Island begun{begun_.seed, wanted.index};
            begun.begin_generation(begun_.parameters, begun_.generation, std::move(sent.bred.at(0)), executor,
                                   sent.opening.empty() ? std::nullopt : std::optional{std::move(sent.opening[0])});
            brought_.emplace(wanted.index,
                             BroughtIsland{.begun = begun, .now = begun, .is_current = false, .founders = {}});
        }
        BroughtIsland& here = brought_.at(wanted.index);
        WorldState state;
        const auto read = read_state(sent.state, std::vector{here.begun.shape()}, state);
        EVOD_ASSERT(read.has_value());
        here.now = here.begun;
        here.now.restore(state.islands.front(), tick_, begun_.parameters, executor);
        EVOD_ASSERT(here.now.hash() == summaries()[wanted.index].hash);
        here.founders = std::move(sent.founders);
        here.is_current = true;
    }

    Leader& leader_;
    Leader::WorldNumber number_;
    Part part_;
    Begin begun_{};                                        // the seed, and how the present generation began
    std::uint32_t tick_ = 0;                               // of the generation
    mutable std::map<std::size_t, BroughtIsland> brought_; // of this generation, by index
};

} // namespace

bool Leader::divides(std::uint32_t island_count) const {
    return exchange_.size() > 1 && island_count >= exchange_.size();
}

std::unique_ptr<Islands> Leader::make(base::Seed seed, std::uint32_t island_count) {
    const auto number = std::make_shared<const std::uint64_t>(++world_count_);
    worlds_.push_back({*number, number});
    return std::make_unique<SharedIslands>(*this, number, seed, island_count);
}

void Leader::order(const WorldNumber& world, Order order) {
    Message message{.dropped = {}, .world = world ? *world : 0, .order = std::move(order)};
    std::erase_if(worlds_, [&](const World& each) {
        if (each.exists.expired()) {
            message.dropped.push_back(each.number);
        }
        return each.exists.expired();
    });
    exchange_.broadcast(base::pack(message));
}

void lead(base::Exchange& exchange, const std::function<void(Leader&)>& work) {
    Leader leader{exchange};
    try {
        work(leader);
    } catch (...) {
        leader.end();
        throw;
    }
    leader.end();
}

void follow(base::Exchange& exchange, base::Executor& executor) {
    std::map<std::uint64_t, Part> parts; // by the number of their world
    for (;;) {
        const auto message = base::unpack<Message>(exchange.broadcast({}));
        for (const std::uint64_t dropped : message.dropped) {
            parts.erase(dropped);
        }
        if (std::holds_alternative<End>(message.order)) {
            return;
        }
        if (const auto* begin = std::get_if<Begin>(&message.order)) {
            const auto part =
                parts.try_emplace(message.world, exchange, begin->seed, begin->parameters.island_count).first;
            if (!part->second.perform(*begin, executor)) {
                parts.erase(part); // rank 0 reports it
            }
            continue;
        }
        Part& part = parts.at(message.world);
        const auto perform = [&](const auto& order) {
            if constexpr (requires { part.perform(order, executor); }) {
                (void)part.perform(order, executor);
            } else {
                (void)part.perform(order);
            }
        };
        std::visit(perform, message.order);
    }
}

} // namespace evod::simulation::shared
