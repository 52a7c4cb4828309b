// The orders of rank 0, as the exchange sees them.
#include "server/simulation/shared/leader.h"

#include "server/simulation/world.h"
#include "tests/support/shared_worlds.h"

#include <gtest/gtest.h>

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace evod::simulation::shared {
namespace {

/// Keeps the messages that rank 0 broadcasts.
class Overheard final : public base::Exchange {
  public:
    explicit Overheard(base::Exchange& exchange) : exchange_{exchange} {}
    std::uint32_t rank() const override { return exchange_.rank(); }
    std::uint32_t size() const override { return exchange_.size(); }
    std::vector<std::string> gather(std::string part) override { return exchange_.gather(std::move(part)); }
    std::vector<std::string> swap(std::vector<std::string> parts) override { return exchange_.swap(std::move(parts)); }
    std::string broadcast(std::string from_first) override {
        messages.push_back(base::unpack<Message>(from_first));
        return exchange_.broadcast(std::move(from_first));
    }

    std::vector<Message> messages;

  private:
    base::Exchange& exchange_;
};

/// Calls work(leader, messages) as rank 0 of two processes. Returns the messages of rank 0.
template <class Work>
std::vector<Message> messages_of(Work&& work) {
    std::vector<Message> messages;
    support::ThreadedExchange{2}.run([&](base::Exchange& exchange) {
        if (exchange.rank() > 0) {
            base::InlineExecutor executor;
            return follow(exchange, executor);
        }
        Overheard overheard{exchange};
        try {
            lead(overheard, [&](Leader& leader) { work(leader, overheard.messages); });
        } catch (const std::runtime_error&) {
        }
        messages = std::move(overheard.messages);
    });
    return messages;
}

World two_islands(IslandsMaker& maker) {
    parameters::Parameters parameters;
    parameters.island_count = 2;
    parameters.population_size = 5;
    return {parameters, base::Seed{3}, {}, {}, &maker};
}

TEST(Leader, SendsNothingWhenAWorldEnds) {
    base::InlineExecutor executor;
    const auto messages = messages_of([&](Leader& leader, const std::vector<Message>& sent) {
        World kept = two_islands(leader);
        {
            std::optional<World> first{two_islands(leader)};
            const World second = std::move(*first);
            EXPECT_TRUE(second.is_shared());
        }
        EXPECT_EQ(sent.size(), 2U) << "two worlds have begun";
        kept.advance_tick(executor);
        EXPECT_EQ(sent.back().dropped, (std::vector<std::uint64_t>{2})) << "the next order names the world";
        kept.advance_tick(executor);
        EXPECT_TRUE(sent.back().dropped.empty()) << "once";
    });
    EXPECT_TRUE(std::holds_alternative<End>(messages.back().order));
    EXPECT_EQ(messages.back().dropped, (std::vector<std::uint64_t>{1})) << "the end of all names the last world";
}

TEST(Leader, SendsParametersOnlyAfterAChange) {
    base::InlineExecutor executor;
    const auto messages = messages_of([&](Leader& leader, const std::vector<Message>&) {
        World world = two_islands(leader);
        for (int tick = 0; tick < 3; ++tick) {
            world.advance_tick(executor);
        }
        parameters::RequestedParameters requested = world.parameters().requested;
        requested.values.food_health += 1;
        world.request_parameters(requested);
        for (int tick = 0; tick < 3; ++tick) {
            world.advance_tick(executor);
        }
    });
    EXPECT_EQ(
        std::ranges::count_if(
            messages, [](const Message& message) { return std::holds_alternative<UseParameters>(message.order); }),
        1);
}

TEST(Leader, EndsTheOthersIfItsWorkFails) {
    const auto messages = messages_of([](Leader&, const std::vector<Message>&) { throw std::runtime_error{"failed"}; });
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_TRUE(std::holds_alternative<End>(messages.front().order));
}

TEST(Leader, DividesWorldsWithEnoughIslands) {
    (void)messages_of([](Leader& leader, const std::vector<Message>& sent) {
        EXPECT_FALSE(leader.divides(1));
        EXPECT_TRUE(leader.divides(2));
        const World alone{parameters::Parameters{}, base::Seed{1}, {}, {}, &leader};
        EXPECT_FALSE(alone.is_shared());
        EXPECT_TRUE(sent.empty());
    });
}

} // namespace
} // namespace evod::simulation::shared
