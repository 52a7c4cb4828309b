// Loops with a disk: the loops of a server whose runs are stored in a folder, which can be taken away, so that creating
// a file fails.
#pragma once

#include "server/base/inline_executor.h"
#include "tests/support/manual_clock.h"
#include "tests/support/two_loops.h"
#include "tests/support/waiting.h"
#include "tests/unit/recording/recorded_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <functional>
#include <future>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace evod::runtime {

using namespace std::chrono_literals;

class LoopsWithDisk : public testing::Test {
  protected:
    LoopsWithDisk() : data{*run_file::DataFolder::open(folder.path())}, thread{{}, 1ms}, recorder{data, thread} {
        loops.handles = [this](const Reply& reply) {
            const auto* receipt = std::get_if<recording::Receipt>(&reply);
            const bool holds = receipt && receipt->ticket == holding_ticket;
            if (holds) {
                at_work.set_value();
                go_on.get_future().wait();
            }
            return holds;
        };
        thread.disk().when_changed([this] { ++news; });
        clock.per_look = 100us; // so that slices end
    }
    ~LoopsWithDisk() override {
        give_back();
        thread.finish(); // it gives receipts to the loops
    }

    void on_answer(const Answer& answer) {
        if (const auto* done = std::get_if<ReplayDone>(&answer)) {
            waiting.extract(done->mail.request_id).mapped()(done->world);
        } else if (const auto* command = std::get_if<CommandDone>(&answer)) {
            answered.emplace(command->mail.origin.request_id, command->outcome);
        }
    }
    /// Holds the storage thread until go_on is set, after it has written everything passed so far.
    void hold_storage_thread() {
        recorder.of("w")->once_written(holding_ticket);
        at_work.get_future().wait();
    }

    /// With a serialised request, because replays parse it.
    void ask(v1::Request request) {
        request.set_client_key("test");
        request.set_request_id(++requests);
        const auto command = protocol::to_command(request, {base::Seed{7}, {requests, 1}});
        ASSERT_TRUE(command) << to_text(command.error());
        ASSERT_TRUE(loops.simulations.try_send(CommandMail{*command,
                                                           {.by = base::client_actor({}, "a client", "127.0.0.1:5000"),
                                                            .client_key = "test",
                                                            .request_id = requests,
                                                            .request = request.SerializeAsString()},
                                                           "command"}));
    }
    void ask_create(const std::string& name) {
        v1::Request request;
        request.mutable_create_world()->set_name(name);
        auto& size = *request.mutable_create_world()->add_parameters();
        size.set_name("population_size");
        size.mutable_value()->set_count(5);
        ask(std::move(request));
    }
    void ask_run(const std::string& name) {
        v1::Request request;
        request.mutable_run()->set_world(name);
        ask(std::move(request));
    }
    void ask_pause(const std::string& name) {
        v1::Request request;
        request.mutable_pause()->set_world(name);
        ask(std::move(request));
    }
    /// factor  nullopt: as fast as possible.
    void ask_speed(const std::string& name, std::optional<double> factor) {
        v1::Request request;
        request.mutable_set_speed()->set_world(name);
        factor ? request.mutable_set_speed()->mutable_speed()->set_real_time_factor(*factor)
               : request.mutable_set_speed()->mutable_speed()->set_max(true);
        ask(std::move(request));
    }

    /// replied  called with the name of the replay.
    void ask(decltype(ReplayMail::request) request, std::uint64_t session,
             std::function<void(const base::Result<std::string>&)> replied, const std::string& user = "user") {
        waiting.emplace(++requests, std::move(replied));
        ASSERT_TRUE(loops.simulations.try_send(
            ReplayMail{.request = std::move(request), .session = session, .user = user, .request_id = requests}));
    }
    /// Opens a replay of a world. Returns its name.
    std::string open_replay(const std::string& world, std::optional<replay::WantedMoment> at = {},
                            std::uint64_t session = 1, const std::string& user = "user") {
        std::string name;
        ask(
            OpenReplay{.world = world, .at = at}, session,
            [&](const base::Result<std::string>& replay) {
                ASSERT_TRUE(replay) << to_text(replay.error());
                name = *replay;
            },
            user);
        pass_until([&] { return !name.empty(); });
        return name;
    }
    /// fork  at a generation, or as the original is now.
    void ask_fork(const std::string& of, const std::string& fork, std::optional<std::uint64_t> generation = {}) {
        v1::Request request;
        request.mutable_fork_world()->set_world(of);
        request.mutable_fork_world()->set_name(fork);
        if (generation) {
            request.mutable_fork_world()->set_at_generation(*generation);
        }
        ask(std::move(request));
    }
    /// Opens a replay of a paused world with 300 ticks. Returns its name.
    std::string look_at_the_past_of_a_run() {
        ask_create("long");
        ask_run("long");
        pass_until([&] { return tick("long") > 300; });
        ask_pause("long");
        return open_replay("long");
    }

    /// The outcome of the last command; nullopt: it is not answered yet.
    std::optional<base::Result<simulation::Applied>> answer() {
        const auto found = answered.find(requests);
        return found == answered.end() ? std::nullopt : std::optional{found->second};
    }
    /// Passes until the last command is answered.
    base::Result<simulation::Applied> answer_of_last() {
        pass_until([&] { return answer().has_value(); });
        return *answer();
    }

    void take_away() { std::filesystem::rename(folder.path(), away); }
    void give_back() {
        if (std::filesystem::exists(away)) {
            std::filesystem::rename(away, folder.path());
        }
    }
    void pass_until(const std::function<bool()>& condition) {
        pass_once();
        ASSERT_TRUE(wait_until(condition, [this] { pass_once(); }));
    }
    void pass_once() {
        clock.advance(1ms);
        loops.pass();
        std::this_thread::sleep_for(100us);
    }
    const simulation::Laboratory& laboratory() { return loops.live.laboratory(); }
    simulation::StorageState state() { return laboratory().storage()->state; }
    const simulation::Entry& entry(std::string_view name) { return *loops.find(name); }
    std::uint64_t tick(std::string_view name) { return entry(name).world.moment().tick; }

    /// Creates a fast world whose generations are half a megabyte each.
    void make_crowd() {
        simulation::CreateWorld crowd{.name = "crowd", .parameters = {}, .seed = base::Seed{2}, .run_id = {2, 1}};
        crowd.parameters.tick_s = 0.01;
        crowd.parameters.population_size = 10'000;
        crowd.parameters.scale_with_population = true;
        crowd.parameters.fitness = parameters::FitnessFunction::GeneSum;
        send(crowd);
        send(simulation::SetSpeed{"crowd", {}});
    }
    /// Sends a command to the live worlds.
    void send(simulation::Command command) {
        loops.simulations.mailbox_of("").push(CommandMail{std::move(command), {}, "command"});
    }

    static constexpr recording::Ticket holding_ticket = 1'000'000; // no command has it
    std::promise<void> at_work, go_on;
    recording::TemporaryFolder folder;
    const std::string away = folder.path() + "_away";
    run_file::DataFolder data;
    std::vector<SnapshotPtr> snapshots;
    std::vector<simulation::StorageState> reported;
    std::vector<std::pair<std::string, simulation::StorageState>> reported_of_world;
    std::vector<simulation::DamagedWorld> damaged;
    std::map<std::uint64_t, base::Result<simulation::Applied>> answered;
    std::atomic<int> news = 0;
    std::uint64_t requests = 0;
    std::map<std::uint64_t, std::function<void(const base::Result<std::string>&)>> waiting; // key: request id
    metrics::Worlds counted;
    base::InlineExecutor executor;
    support::ManualClock clock;
    recording::StorageThread thread;
    recording::Recorder recorder;
    support::TwoLoops loops{executor,
                            clock,
                            [this](const Answer& answer) { on_answer(answer); },
                            {.events = [](auto&&...) {},
                             .snapshot = [this](SnapshotPtr snapshot) { snapshots.push_back(std::move(snapshot)); },
                             .storage = [this](const simulation::Storage& s) { reported.push_back(s.state); },
                             .storage_of_world =
                                 [this](const std::string& world, const simulation::Storage& storage) {
                                     reported_of_world.emplace_back(world, storage.state);
                                 },
                             .damaged = [this](const simulation::DamagedWorld& world) { damaged.push_back(world); },
                             .counted = &counted},
                            {},
                            &recorder};
};

} // namespace evod::runtime
