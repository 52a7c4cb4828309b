// The loop with the worlds of a class: one command for all, freezing, and who may send what.
#include "server/protocol/request_rules.h"
#include "tests/support/waiting.h"
#include "tests/unit/recording/recorded_run.h"
#include "tests/unit/runtime/loop_with_clock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace evod::runtime {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

simulation::CreateWorld of_member(const char* name, const char* user, std::uint64_t seed) {
    simulation::CreateWorld command = create(name, seed);
    command.ownership = {.user = user, .class_name = "bio", .teacher = "kant"};
    return command;
}

const access::Requester teacher{"kant", access::Role::Teacher}, ann{"bio/ann", access::Role::Viewer},
    ben{"bio/ben", access::Role::Viewer};

class ClassLoop : public testing::Test {
  protected:
    explicit ClassLoop(recording::Recorder* recorder = nullptr)
        : loop{{mailbox, demand, executor, clock},
               {.events = [](auto&&...) {},
                .snapshot = [](auto&&) {},
                .reply = [this](Reply reply) { replies.push_back(std::move(reply)); }},
               {},
               recorder} {
        send(of_member("bio_ann", "bio/ann", 1));
        send(of_member("bio_ben", "bio/ben", 2));
        send(of_member("bio_ann_2", "bio/ann", 3));
        send(create("alone", 4));
        replies.clear();
    }
    void pass() {
        clock.advance(1ms);
        loop.pass();
    }
    void send(Mail mail) {
        mailbox.push(std::move(mail));
        pass();
    }
    void send(simulation::Command command) { send(CommandMail{std::move(command), {}, "command"}); }
    /// Returns the refusal of a request by this user; nullopt if it is applied.
    std::optional<base::Refusal> ask(v1::Request request, const access::Requester& requester) {
        request.set_client_key("key");
        request.set_request_id(1);
        send(CommandMail{.command = *protocol::to_command(request, {base::Seed{9}, {9, ++runs}}),
                         .origin = {},
                         .request_name = protocol::name_of(request),
                         .session = 1,
                         .requester = requester,
                         .rules = protocol::rules_of(request)});
        const auto done = std::get<CommandDone>(replies.back());
        return done.outcome ? std::nullopt : std::optional{done.outcome.error()};
    }
    std::optional<base::Refusal> pause(const char* name, const access::Requester& requester) {
        v1::Request request;
        request.mutable_pause()->set_world(name);
        return ask(std::move(request), requester);
    }
    std::optional<base::Refusal> fork(const char* name, const char* fork, const access::Requester& requester) {
        v1::Request request;
        request.mutable_fork_world()->set_world(name);
        request.mutable_fork_world()->set_name(fork);
        return ask(std::move(request), requester);
    }
    void for_each(v1::ForEachWorld action, const access::Requester& requester) {
        v1::Request request;
        request.set_client_key("key");
        request.set_request_id(5);
        *request.mutable_for_each_world() = std::move(action);
        request.mutable_for_each_world()->set_class_("bio");
        send(ForEachWorld{.class_name = "bio",
                          .request = std::make_shared<const v1::Request>(std::move(request)),
                          .by = base::client_actor(requester.user, "test", "127.0.0.1:1"),
                          .session = 1,
                          .requester = requester,
                          .batch = 3});
    }
    void set_class(bool frozen) {
        send(SetClass{"bio", simulation::ClassRules{.frozen = frozen, .ranges = {}, .worlds_per_member = 8}, {}, 7});
    }
    /// The worlds to which a ForEachWorld was applied.
    std::vector<std::string> applied() {
        std::vector<std::string> worlds;
        for (const Reply& reply : replies) {
            if (const auto* done = std::get_if<CommandDone>(&reply); done && done->mail.batch == 3 && done->outcome) {
                worlds.push_back(done->outcome->world);
            }
        }
        return worlds;
    }
    const simulation::Entry& world(std::string_view name) { return **loop.laboratory().find(name); }
    std::uint64_t tick(std::string_view name) { return world(name).world.moment().tick; }

    Mailbox mailbox;
    StreamDemand demand;
    base::InlineExecutor executor;
    support::ManualClock clock;
    std::vector<Reply> replies;
    std::uint64_t runs = 0;
    SimulationLoop loop;
};

TEST_F(ClassLoop, OneCommandReachesAllWorldsOfTheClassAtOnce) {
    v1::ForEachWorld run;
    run.mutable_run();
    for_each(run, teacher);
    const auto& begun = std::get<BatchBegun>(replies.front());
    EXPECT_EQ(begun.batch, 3u);
    EXPECT_THAT(begun.worlds, ElementsAre("bio_ann", "bio_ben", "bio_ann_2"));
    EXPECT_THAT(applied(), ElementsAre("bio_ann", "bio_ben", "bio_ann_2"));
    EXPECT_TRUE(world("bio_ben").wants_tick());
    EXPECT_FALSE(world("alone").wants_tick());
}

TEST_F(ClassLoop, AResetForAllLeavesTheForks) {
    const auto run_of_fork = world("bio_ann_2").run_id;
    const auto run_of_ann = world("bio_ann").run_id;
    v1::ForEachWorld reset;
    reset.mutable_reset_world();
    for_each(reset, teacher);
    EXPECT_THAT(applied(), ElementsAre("bio_ann", "bio_ben"));
    EXPECT_EQ(world("bio_ann_2").run_id, run_of_fork);
    EXPECT_NE(world("bio_ann").run_id, run_of_ann);
    EXPECT_NE(world("bio_ann").run_id, world("bio_ben").run_id);
    EXPECT_EQ(world("bio_ann").ownership.user, "bio/ann");
}

TEST_F(ClassLoop, AnotherTeacherReachesNoWorld) {
    v1::ForEachWorld run;
    run.mutable_run();
    for_each(run, {"hume", access::Role::Teacher});
    EXPECT_THAT(applied(), IsEmpty());
    EXPECT_EQ(replies.size(), 4u) << "a beginning, and a refusal for each world";
    for_each(run, {"root", access::Role::Controller});
    EXPECT_EQ(applied().size(), 3u);
}

TEST_F(ClassLoop, MembersControlTheirOwnWorldOnly) {
    EXPECT_FALSE(pause("bio_ann", ann));
    EXPECT_FALSE(pause("bio_ann_2", ann));
    EXPECT_EQ(pause("bio_ben", ann)->code, base::RefusalCode::PermissionDenied);
    EXPECT_EQ(pause("alone", ann)->code, base::RefusalCode::PermissionDenied);
    EXPECT_EQ(pause("missing", ann)->code, base::RefusalCode::NotFound);
    EXPECT_FALSE(pause("bio_ann", teacher));
    EXPECT_EQ(pause("alone", teacher)->code, base::RefusalCode::PermissionDenied);
}

TEST_F(ClassLoop, AForkByAMemberBelongsToTheMember) {
    set_class(false);
    EXPECT_FALSE(fork("bio_ann", "bio_ann_3", ann));
    EXPECT_EQ(world("bio_ann_3").ownership, world("bio_ann").ownership);
    EXPECT_EQ(fork("bio_ann", "bio_ben_3", ann)->code, base::RefusalCode::InvalidArgument);
    EXPECT_EQ(fork("bio_ann", "bio_ann_4", ben)->code, base::RefusalCode::PermissionDenied);
}

TEST_F(ClassLoop, AFrozenClassStopsInTheSamePass) {
    v1::ForEachWorld run;
    run.mutable_run();
    for_each(run, teacher);
    send(simulation::Run{"alone", {}});
    for (int i = 0; i < 100; ++i) {
        pass();
    }
    EXPECT_GT(tick("bio_ann"), 0u);
    set_class(true);
    const auto& done = std::get<ClassSet>(replies.back());
    EXPECT_EQ(done.number, 7u);
    ASSERT_EQ(done.events.size(), 3u);
    EXPECT_TRUE(done.events[0].run_control_changed().world().frozen());
    const std::uint64_t before[] = {tick("bio_ann"), tick("bio_ben"), tick("alone")};
    for (int i = 0; i < 100; ++i) {
        pass();
    }
    EXPECT_EQ(tick("bio_ann"), before[0]);
    EXPECT_EQ(tick("bio_ben"), before[1]);
    EXPECT_GT(tick("alone"), before[2]);
    EXPECT_EQ(pause("bio_ann", ann)->reason, base::Reason::WorldFrozen);
    EXPECT_FALSE(pause("bio_ann", teacher));
    set_class(false);
    for (int i = 0; i < 100; ++i) {
        pass();
    }
    EXPECT_GT(tick("bio_ben"), before[1]);
    EXPECT_EQ(tick("bio_ann"), before[0]) << "the teacher has paused it";
}

TEST_F(ClassLoop, OwnersShareTheTimeWhateverTheNumberOfTheirWorlds) {
    clock.per_look = 100us; // so that slices end
    send(simulation::DeleteWorld{"alone"});
    for (const char* name : {"bio_ann", "bio_ann_2", "bio_ben"}) {
        send(simulation::SetSpeed{name, {}});
        send(simulation::Run{name, {}});
    }
    const std::uint64_t before[] = {tick("bio_ann") + tick("bio_ann_2"), tick("bio_ben")};
    for (int i = 0; i < 200; ++i) {
        pass();
    }
    const auto of_ann = static_cast<double>(tick("bio_ann") + tick("bio_ann_2") - before[0]);
    const auto of_ben = static_cast<double>(tick("bio_ben") - before[1]);
    EXPECT_NEAR(of_ann / (of_ann + of_ben), 0.5, 0.02);
}

TEST(ClassFiles, TheOwnerIsStoredWithEveryRunOfTheWorld) {
    recording::TemporaryFolder folder;
    auto data = run_file::DataFolder::open(folder.path());
    recording::StorageThread thread{{}};
    recording::Recorder recorder{*data, thread};
    Mailbox mailbox;
    StreamDemand demand;
    base::InlineExecutor executor;
    support::ManualClock clock;
    SimulationLoop loop{
        {mailbox, demand, executor, clock}, {.events = [](auto&&...) {}, .snapshot = [](auto&&) {}}, {}, &recorder};
    const auto apply = [&](simulation::Command command) {
        mailbox.push(CommandMail{std::move(command), {}, "command"});
        loop.pass();
    };
    const auto stored = [&](const char* world) {
        EXPECT_TRUE(wait_until([&] { return thread.idle(); }));
        const auto file = run_file::RunFile::open_read_only(data->file_of(world));
        EXPECT_TRUE(file) << to_text(file.error());
        return file ? (*file)->identity().ownership : simulation::Ownership{};
    };
    const simulation::Ownership owner{.user = "bio/ann", .class_name = "bio", .teacher = "kant"};
    apply(of_member("bio_ann", "bio/ann", 1));
    EXPECT_EQ(stored("bio_ann"), owner);
    apply(simulation::ResetWorld{"bio_ann", {}, {8, 8}});
    EXPECT_EQ(stored("bio_ann"), owner);
    apply(simulation::ForkWorld{"bio_ann", "bio_ann_2", {}, {9, 9}, owner});
    EXPECT_EQ(stored("bio_ann_2"), owner);
    apply(create("alone", 5));
    EXPECT_EQ(stored("alone"), simulation::Ownership{});
}

} // namespace
} // namespace evod::runtime
