#include "server/runtime/simulations.h"

#include "server/base/inline_executor.h"
#include "tests/support/waiting.h"

#include <gtest/gtest.h>

#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace evod::runtime {
namespace {

TEST(Simulations, MailGoesToTheThreadThatHasTheWorld) {
    Simulations both{false};
    EXPECT_EQ(&both.mailbox_of(""), &both.mailbox_of("w"));
    EXPECT_NE(&both.mailbox_of("w"), &both.mailbox_of("w@1"));
    EXPECT_EQ(&both.mailbox_of("w@1"), &both.mailbox_of("other@2"));
    Simulations file{true};
    EXPECT_EQ(&file.mailbox_of("w"), &file.mailbox_of("w@1"));
}

TEST(Simulations, DemandIsDividedBetweenTheThreads) {
    Simulations simulations{false};
    simulations.set_demand({{"w", {.rate_hz = 1, .islands = {}}}, {"w@1", {.rate_hz = 2, .islands = {}}}}, true);
    EXPECT_TRUE(simulations.events_wanted());
    const WorldDemands live = simulations.part_of("w").demand.take(),
                       replays = simulations.part_of("w@1").demand.take();
    ASSERT_EQ(live.size(), 1u);
    EXPECT_EQ(live.begin()->first, "w");
    ASSERT_EQ(replays.size(), 1u);
    EXPECT_EQ(replays.begin()->first, "w@1");
    EXPECT_TRUE(simulations.mailbox_of("w").pending() && simulations.mailbox_of("w@1").pending()) << "both are woken";
}

TEST(Simulations, RequestsForReplaysGetTheRunFirst) {
    Simulations simulations{false};
    const auto sent = [&](std::string_view to) { return simulations.mailbox_of(to).drain(); };
    ASSERT_TRUE(
        simulations.try_send(ReplayMail{.request = OpenReplay{.world = "w", .at = {}}, .session = 1, .request_id = 1}));
    ASSERT_TRUE(
        simulations.try_send(ReplayMail{.request = Seek{.world = "w@1", .to = {}}, .session = 1, .request_id = 2}));
    std::vector<Mail> mail = sent("w");
    ASSERT_EQ(mail.size(), 2u);
    for (Mail& find : mail) {
        const auto& wanted = std::get<FindRun>(find);
        EXPECT_EQ(wanted.world, "w");
        FoundRun run{.world = "w", .run = {{"w.evod"}, {1, 2}}, .until = {3, 4}};
        EXPECT_FALSE(simulations.pass_on(RunFound{wanted, run}));
    }
    mail = sent("w@1");
    ASSERT_EQ(mail.size(), 2u);
    EXPECT_EQ(std::get<ReplayMail>(mail[0]).run->until.tick, 4u);
    EXPECT_EQ(std::get<ReplayMail>(mail[1]).run->run.run_id(), (simulation::RunId{1, 2}));
    // Without a run, a replay cannot be opened, but it can still be moved.
    const auto pass_on_refusal = [&](ReplayMail mail_of_client) {
        EXPECT_TRUE(simulations.try_send(std::move(mail_of_client)));
        const auto wanted = std::get<FindRun>(sent("w").at(0));
        return simulations.pass_on(RunFound{wanted, base::refusal(base::RefusalCode::NotFound, "none")});
    };
    const auto refused = pass_on_refusal({.request = OpenReplay{.world = "w", .at = {}}, .session = 1});
    ASSERT_TRUE(refused);
    EXPECT_EQ(std::get<ReplayDone>(*refused).world.error().message, "none");
    EXPECT_FALSE(pass_on_refusal({.request = Seek{.world = "w@1", .to = {}}, .session = 1}));
    EXPECT_EQ(sent("w@1").size(), 1u);
}

TEST(Simulations, AForkOfAReplayGoesToItsThread) {
    Simulations simulations{false};
    ASSERT_TRUE(simulations.try_send(CommandMail{
        simulation::ForkWorld{.world = "w@1", .name = "f", .at_generation = {}, .run_id = {1, 1}}, {}, "fork"}));
    ASSERT_TRUE(simulations.try_send(CommandMail{simulation::Run{"f", {}}, {}, "run"}));
    const auto live = simulations.mailbox_of("").drain();
    ASSERT_EQ(live.size(), 2u);
    EXPECT_EQ(std::get<ForkAnnounced>(live[0]).name, "f");
    EXPECT_TRUE(std::holds_alternative<CommandMail>(live[1]));
    EXPECT_EQ(simulations.mailbox_of("w@1").drain().size(), 1u);
}

TEST(Simulations, RequestsOfEndedSessionsAreDropped) {
    Simulations simulations{false};
    ASSERT_TRUE(
        simulations.try_send(ReplayMail{.request = OpenReplay{.world = "w", .at = {}}, .session = 1, .request_id = 1}));
    const auto wanted = std::get<FindRun>(simulations.mailbox_of("w").drain().at(0));
    simulations.forget(1);
    simulations.mailbox_of("w@1").drain();
    EXPECT_FALSE(simulations.pass_on(RunFound{wanted, FoundRun{.world = "w", .run = {{"w.evod"}, {1, 2}}}}));
    EXPECT_TRUE(simulations.mailbox_of("w@1").drain().empty());
}

TEST(Simulations, BothThreadsAnswerAndEnd) {
    Simulations simulations{false};
    base::InlineExecutor executor;
    SteadyClock clock;
    std::mutex mutex;
    int pongs = 0;
    simulations.start({.executor = executor,
                       .clock = clock,
                       .outputs = {.events = [](auto&&...) {},
                                   .snapshot = [](SnapshotPtr) {},
                                   .reply =
                                       [&](const Reply& reply) {
                                           const std::lock_guard lock{mutex};
                                           pongs += std::holds_alternative<Pong>(reply);
                                       }},
                       .laboratory = {}});
    std::vector<std::string> names;
    simulations.for_each_thread([&](const char* name, pthread_t) { names.emplace_back(name); });
    EXPECT_EQ(names, (std::vector<std::string>{"simulation", "replays"}));
    for (const char* world : {"w", "w@1"}) {
        simulations.mailbox_of(world).push(Ping{});
    }
    EXPECT_TRUE(wait_until([&] {
        const std::lock_guard lock{mutex};
        return pongs == 2;
    }));
    simulations.forget(1);
    simulations.stop();
}

} // namespace
} // namespace evod::runtime
