// Worlds that another thread constructs: the order of commands, and refusals.
#include "server/runtime/world_builds.h"

#include "server/base/inline_executor.h"
#include "server/replay/recovery.h"
#include "tests/support/manual_clock.h"
#include "tests/support/two_loops.h"
#include "tests/support/waiting.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace evod::runtime {
namespace {

using namespace std::chrono_literals;

simulation::World small_world() {
    parameters::Parameters parameters;
    parameters.population_size = 5;
    return simulation::World{parameters, base::Seed{1}};
}

class WorldBuildsTest : public testing::Test {
  protected:
    /// An order for the build thread, or for this thread if `genes` is small.
    WorldBuilds::Order order(std::function<simulation::World(base::Executor&)> construct,
                             std::uint64_t genes = WorldBuilds::genes_built_at_once_max + 1) {
        return {.name = "new",
                .original = "original",
                .construction = {.construct = std::move(construct), .genes = genes},
                .finish =
                    [](simulation::World world, base::Executor&) {
                        return BuiltWorld{std::move(world), std::nullopt};
                    },
                .adopt = [this](base::Result<BuiltWorld> built) { adopted = std::move(built); }};
    }
    /// Waits for mail of the build thread, and handles it.
    void take_mail() {
        mailbox.wait(std::nullopt);
        for (const Mail& mail : mailbox.drain()) {
            builds.take(std::get<WorldBuilt>(mail));
        }
    }

    Mailbox mailbox;
    base::InlineExecutor executor;
    WorldBuilds builds{mailbox, executor};
    std::optional<base::Result<BuiltWorld>> adopted;
};

TEST_F(WorldBuildsTest, TheBuildThreadServesUsersInTurn) {
    std::vector<std::string> built;
    std::promise<void> begun, go_on;
    const auto begin = [&](
                           const std::string& user, std::function<void()> first = [] {}) {
        WorldBuilds::Order ordered = order([&built, user, first](base::Executor&) {
            first();
            built.push_back(user);
            return small_world();
        });
        ordered.user = user;
        builds.begin(std::move(ordered));
    };
    begin("eve", [&] {
        begun.set_value();
        go_on.get_future().wait();
    });
    begun.get_future().wait();
    for (const char* user : {"eve", "eve", "eve", "ada"}) {
        begin(user);
    }
    go_on.set_value();
    while (builds.holds("")) {
        take_mail();
    }
    EXPECT_EQ(built, (std::vector<std::string>{"eve", "eve", "ada", "eve", "eve"}));
}

TEST_F(WorldBuildsTest, SmallWorldsAreConstructedAtOnce) {
    std::thread::id thread;
    builds.begin(order(
        [&](base::Executor&) {
            thread = std::this_thread::get_id();
            return small_world();
        },
        WorldBuilds::genes_built_at_once_max));
    EXPECT_EQ(thread, std::this_thread::get_id());
    ASSERT_TRUE(adopted && *adopted);
    EXPECT_EQ((*adopted)->world.hash(), small_world().hash());
    EXPECT_FALSE(builds.holds(""));
}

TEST_F(WorldBuildsTest, SharedWorldsAreConstructedAtOnce) {
    WorldBuilds::Order shared = order([](base::Executor&) { return small_world(); });
    shared.construction.is_shared = true;
    builds.begin(std::move(shared));
    EXPECT_TRUE(adopted);
}

TEST_F(WorldBuildsTest, LargeWorldsAreConstructedOnAnotherThread) {
    std::thread::id thread;
    std::promise<void> may_read, may_finish;
    WorldBuilds::Order large = order([&](base::Executor&) {
        thread = std::this_thread::get_id();
        may_read.get_future().wait();
        return small_world();
    });
    large.finish = [&](simulation::World world, base::Executor&) {
        may_finish.get_future().wait();
        return BuiltWorld{std::move(world), std::nullopt};
    };
    builds.begin(std::move(large));
    for (const char* held : {"new", "original", ""}) {
        EXPECT_TRUE(builds.holds(held)) << held;
    }
    EXPECT_FALSE(builds.holds("other"));
    may_read.set_value();
    take_mail();
    EXPECT_FALSE(builds.holds("original")) << "it has been read";
    EXPECT_TRUE(builds.holds("new"));
    EXPECT_FALSE(adopted);
    may_finish.set_value();
    take_mail();
    ASSERT_TRUE(adopted && *adopted);
    EXPECT_FALSE(builds.holds(""));
    EXPECT_NE(thread, std::this_thread::get_id());
}

TEST_F(WorldBuildsTest, AWorldWithoutMemoryIsRefused) {
    builds.begin(order([](base::Executor&) -> simulation::World { throw std::bad_alloc{}; }));
    take_mail();
    ASSERT_TRUE(adopted && !*adopted);
    EXPECT_EQ(adopted->error().code, base::RefusalCode::ResourceExhausted);
    EXPECT_FALSE(builds.holds(""));
}

/// A loop that records runs. Large worlds have more genes than the simulation thread constructs at once.
class LoopWithBuilds : public testing::Test {
  protected:
    LoopWithBuilds() {
        send(create("small", 5));
        send(simulation::Run{"small", {}});
        loops.pass();
    }
    ~LoopWithBuilds() override {
        loop.close();
        thread.finish(); // it gives receipts to the loops
    }

    static simulation::CreateWorld create(const char* name, std::uint32_t organisms, std::uint64_t seed = 1) {
        simulation::CreateWorld command{.name = name, .parameters = {}, .seed = {seed}, .run_id = {seed, organisms}};
        command.parameters.population_size = organisms;
        command.parameters.scale_with_population = true;
        return command;
    }
    void send(simulation::Command command) {
        loops.simulations.mailbox_of("").push(
            CommandMail{std::move(command), {}, "request " + std::to_string(++sent), session});
    }
    /// One pass after a length of time in which `small` takes a tick.
    void pass() {
        clock.advance(20ms);
        loops.pass();
    }
    void pass_until_answered(std::size_t count) {
        ASSERT_TRUE(wait_until([&] { return answers.size() >= count; }, [this] { pass(); }));
    }
    const simulation::Entry* find(const char* name) {
        const auto found = loop.laboratory().find(name);
        return found ? *found : nullptr;
    }
    std::uint64_t tick(const char* name) { return find(name)->world.moment().tick; }
    /// Creates "large" and simulates it up to this tick.
    void make_large(std::uint64_t at_tick) {
        send(create("large", 2'000));
        send(simulation::SetSpeed{"large", {}});
        send(simulation::RunUntilTick{"large", at_tick});
        ASSERT_TRUE(wait_until([&] { return find("large") && tick("large") == at_tick; }, [this] { pass(); }));
    }

    static constexpr std::uint64_t server_itself = 0;
    std::uint64_t session = 1;        // the sender of the commands
    std::vector<std::string> answers; // the requests, in the order of their answers; with the message if refused
    int sent = 0;
    recording::TemporaryFolder folder;
    run_file::DataFolder data{*run_file::DataFolder::open(folder.path())};
    recording::StorageThread thread{{}};
    recording::Recorder recorder{data, thread};
    base::InlineExecutor executor;
    support::ManualClock clock;
    support::TwoLoops loops{executor,
                            clock,
                            [this](const Answer& answer) {
                                if (const auto* done = std::get_if<CommandDone>(&answer)) {
                                    answers.push_back(done->mail.request_name +
                                                      (done->outcome ? "" : ": " + done->outcome.error().message));
                                }
                            },
                            {.events = [](auto&&...) {}, .snapshot = [](SnapshotPtr) {}},
                            {},
                            &recorder};
    SimulationLoop& loop = loops.live;
};

TEST_F(LoopWithBuilds, ALargeWorldIsCreatedWhileOthersAdvance) {
    const std::uint64_t before = tick("small");
    send(create("large", 2'000));
    send(simulation::SetSpeed{"large", 2.0});
    send(create("large", 7));
    send(simulation::SetSpeed{"small", 3.0});
    pass();
    EXPECT_FALSE(find("large")) << "it is adopted between two later ticks";
    EXPECT_GT(tick("small"), before);
    EXPECT_EQ(find("small")->control.speed, 3.0) << "the command to another world does not wait";
    pass_until_answered(6);
    EXPECT_EQ(find("large")->control.speed, 2.0) << "the command has waited for its world";
    EXPECT_EQ(find("large")->world.hash(), (simulation::World{create("large", 2'000).parameters, {1}}.hash()));
    EXPECT_EQ(find("large")->world.organism_count(0), 2'000);
    EXPECT_THAT(answers,
                testing::UnorderedElementsAre("request 1", "request 2", "request 3", "request 4",
                                              "request 5: a world with that name already exists", "request 6"));
}

TEST_F(LoopWithBuilds, TheFirstWorldOfAServerIsThereAtOnce) {
    session = server_itself;
    send(create("large", 2'000));
    pass();
    EXPECT_TRUE(find("large")) << "queries that arrive after the command must find it";
}

TEST_F(LoopWithBuilds, ALargeWorldIsForkedAsItWasWhenTheCommandArrived) {
    make_large(3);
    const base::StateHash hash = find("large")->world.hash();
    send(simulation::ForkWorld{"large", "fork", {}, {5, 5}});
    send(simulation::RunUntilTick{"large", 4}); // after the fork
    send(simulation::RunUntilTick{"fork", 5});
    send(simulation::ForkWorld{"large", "opening", 1, {6, 6}});
    pass();
    EXPECT_FALSE(find("fork"));
    EXPECT_EQ(tick("large"), 3) << "it waits until it has been read";
    const auto all_there = [&] { return tick("large") == 4 && find("fork") && tick("fork") == 5 && find("opening"); };
    ASSERT_TRUE(wait_until(all_there, [this] { pass(); }));
    pass_until_answered(9);
    EXPECT_EQ(tick("opening"), 0);
    EXPECT_EQ(find("opening")->world.hash(), (simulation::World{create("large", 2'000).parameters, {1}}.hash()));
    simulation::World again{create("large", 2'000).parameters, {1}};
    again.advance(3, executor);
    EXPECT_EQ(hash, again.hash());
    again.advance(5, executor);
    EXPECT_EQ(find("fork")->world.hash(), again.hash());
    EXPECT_THAT(answers, testing::Each(testing::Not(testing::HasSubstr(":"))));
}

TEST_F(LoopWithBuilds, ALargeWorldWaitsWhileItIsReset) {
    make_large(3);
    send(simulation::ResetWorld{"large", base::Seed{9}, {9, 9}});
    send(simulation::RunUntilTick{"large", 2});
    pass();
    EXPECT_EQ(tick("large"), 3);
    ASSERT_TRUE(wait_until([&] { return tick("large") == 2; }, [this] { pass(); }));
    simulation::World again{create("large", 2'000).parameters, {9}};
    again.advance(2, executor);
    EXPECT_EQ(find("large")->world.hash(), again.hash());
    EXPECT_EQ(find("large")->run_id, (simulation::RunId{9, 9}));
}

TEST_F(LoopWithBuilds, AServerThatStopsCompletesItsBuilds) {
    send(create("large", 2'000));
    send(simulation::ForkWorld{"large", "fork", {}, {5, 5}});
    loop.close();
    EXPECT_TRUE(find("large"));
    EXPECT_TRUE(find("fork"));
    EXPECT_TRUE(thread.finish());
    for (const char* name : {"large", "fork"}) {
        const auto file = run_file::RunFile::open_read_only(data.file_of(name));
        ASSERT_TRUE(file) << to_text(file.error());
        EXPECT_TRUE(replay::check_beginning(**file, find(name)->world.hash(), executor));
    }
}

} // namespace
} // namespace evod::runtime
