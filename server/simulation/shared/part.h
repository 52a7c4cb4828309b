// Part: the islands of a shared world that one process simulates.
//
// All processes call the same functions in the same order. Each function sends what the other processes need, and
// returns when all have called it. Results are complete on rank 0; the other processes ignore them.
//
// Owner        the islands of a world on rank 0, follow() in the other processes.
// Threads      one at a time.
#pragma once

#include "server/base/exchange.h"
#include "server/simulation/local_islands.h"
#include "server/simulation/shared/orders.h"

#include <span>
#include <vector>

namespace evod::simulation::shared {

class Part {
  public:
    Part(base::Exchange& exchange, base::Seed seed, std::uint32_t island_count);

    // One function per order. Arguments behind the executor are those of rank 0; the other processes pass none.

    /// Returns whether memory suffices in all processes.
    bool perform(const Begin& order, base::Executor& executor, BredIslands bred = {});
    void perform(const UseParameters& order) { parameters_ = order.parameters; }
    void perform(const Restore& order, base::Executor& executor, const WorldState& state = {});
    /// Returns the last tick that any process has performed, and what has died out.
    ExchangedResults perform(const Advance& order, base::Executor& executor);
    std::vector<GenerationStatistics> perform(const EndGeneration& order, base::Executor& executor,
                                              std::span<const Rating> given = {});
    /// Returns whether memory suffices in all processes.
    bool perform(const TurnOver& order, base::Executor& executor);
    EntityIds perform(const Place& order);
    void perform(const Remove& order);
    /// Returns the islands in the order of the list.
    std::vector<SentIsland> perform(const Bring& order) const;
    BredIslands perform(const Bred& order) const;
    std::vector<IslandOutcome> perform(const Outcomes& order) const;
    std::vector<IslandState> perform(const States& order, base::Executor& executor) const;
    std::vector<LiveStatistics> perform(const LiveStatisticsOfAll& order) const;
    void perform(const End&) {}

    const LocalIslands& islands() const { return islands_; }
    /// Of all islands.
    std::span<const IslandSummary> summaries() const { return summaries_; }
    const parameters::Parameters& parameters() const { return parameters_; }

  private:
    bool is_first() const { return exchange_.rank() == 0; }
    std::uint32_t rank_of_island(std::size_t island) const;
    /// Returns the elements of a list over all islands that belong to each rank.
    template <class T>
    std::vector<std::vector<T>> divide(std::vector<T> of_all) const;
    /// The shapes of the islands of this process.
    std::vector<IslandShape> shapes() const;
    /// Sends the results of this process to all others. Returns the results of all processes together.
    ExchangedResults exchange_results(ExchangedResults own = {});
    /// Exchanges the migrants of the routes that begin in one process and end in another.
    void carry(std::span<const evolution::MigrationRoute> routes, std::vector<Migrants>& migrants) const;

    base::Exchange& exchange_;
    std::uint32_t island_count_;
    base::Range share_; // the islands of this process
    LocalIslands islands_;
    std::vector<IslandSummary> summaries_;
    parameters::Parameters parameters_;
};

} // namespace evod::simulation::shared
