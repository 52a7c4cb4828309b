// Recorded run: a world in a laboratory whose run is recorded as a server does it, in a folder of its own.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/base/inline_executor.h"
#include "server/protocol/commands.h"
#include "server/protocol/parameters.h"
#include "server/recording/recorder.h"
#include "server/run_file/database.h"
#include "tests/support/receipts.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

namespace evod::recording {
using namespace run_file;
using support::TemporaryFolder;

/// Changes a run file with SQL, without correcting checksums.
inline void change(const std::string& path, const std::string& sql) {
    Database database{path, Database::Mode::Write};
    database.run(sql.c_str());
    ASSERT_FALSE(database.failed()) << database.error();
}

/// A small world with some deaths: twelve organisms, generations of two seconds, two islands.
inline parameters::Parameters small_world() {
    parameters::Parameters parameters;
    parameters.population_size = 12;
    parameters.generation_s = 2;
    parameters.island_count = 2;
    parameters.migration = evolution::Topology::Ring;
    parameters.migration_epoch = 2;
    parameters.food_count = 40;
    return parameters;
}

inline v1::Request set_parameter(const std::string& name, parameters::ParameterValue value) {
    v1::Request request;
    v1::ParameterAssignment& assignment = *request.mutable_set_parameters()->add_parameters();
    assignment.set_name(name);
    *assignment.mutable_value() = protocol::to_proto(value);
    return request;
}

class RecordedRun {
  public:
    using OnReceipt = support::Receipts::Call;

    /// folder, thread: outlive it.
    RecordedRun(DataFolder& folder, StorageThread& thread, base::Seed seed = {7},
                simulation::FirstPopulation first_population = {}, const parameters::Schedule& schedule = {},
                const parameters::Parameters& initial = small_world())
        : receipts_{support::Receipts::of(thread)}, recorder_{folder, thread} {
        auto parameters = parameters::assign(initial, schedule.at(1));
        EXPECT_TRUE(parameters) << to_text(parameters.error());
        EXPECT_TRUE(laboratory_.apply(
            simulation::CreateWorld{"w", *parameters, seed, {1, 2}, std::move(first_population), schedule}));
        recorder_.begin(beginning());
    }

    simulation::Entry& entry() { return **laboratory_.find("w"); }
    run_file::RunBeginning beginning() { return run_file::beginning_of_run(world(), entry().name, entry().run_id); }
    simulation::World& world() { return entry().world; }
    Recorder& recorder() { return recorder_; }
    const simulation::Laboratory& laboratory() const { return laboratory_; }

    void advance(std::uint64_t ticks, const std::string& name = "w") {
        simulation::Entry& advanced = **laboratory_.find(name);
        for (std::uint64_t tick = 0; tick < ticks && advanced.world.outcome() == evolution::Outcome::Running; ++tick) {
            laboratory_.advance(advanced, executor_);
            recorder_.of(name)->follow(advanced.world);
        }
    }

    /// Makes a checkpoint of the last tick, before any command there, as a server does.
    void checkpoint() { recorder_.of("w")->make_checkpoint(world(), executor_); }

    /// Creates the world "fork", a fork of the present moment.
    void fork(const simulation::RunId& run_id, OnReceipt on_receipt = {}) {
        v1::Request request;
        request.mutable_fork_world()->set_world("w");
        request.mutable_fork_world()->set_name("fork");
        const auto applied = laboratory_.apply(simulation::ForkWorld{"w", "fork", {}, run_id});
        ASSERT_TRUE(applied) << to_text(applied.error());
        const simulation::Entry& fork = **laboratory_.find("fork");
        recorder_.begin(run_file::beginning_of_fork(fork.world, fork.name, run_id, entry().run_id, executor_),
                        record_of(request, *applied, std::move(on_receipt)));
    }

    /// Resets the world; the new run has a file of its own.
    void reset(base::Seed seed, const simulation::RunId& run_id, OnReceipt on_receipt = {}) {
        const simulation::RunId before = entry().run_id;
        const std::uint64_t tick = world().moment().tick;
        v1::Request request;
        request.mutable_reset_world()->set_world("w");
        const auto applied = laboratory_.apply(simulation::ResetWorld{"w", seed, run_id});
        ASSERT_TRUE(applied) << to_text(applied.error());
        recorder_.begin_after_reset(beginning(), before, tick, record_of(request, *applied, std::move(on_receipt)));
    }

    void command(v1::Request request, OnReceipt on_receipt = {}) {
        auto command = protocol::to_command(with_key(request), {});
        ASSERT_TRUE(command) << to_text(command.error());
        if (auto* set = std::get_if<simulation::SetParameters>(&*command)) {
            set->by = base::client_actor("alice", "evoctl", "127.0.0.1:5000"); // as a server does
        }
        const auto applied = laboratory_.apply(*command);
        ASSERT_TRUE(applied) << to_text(applied.error());
        recorder_.of("w")->journal(record_of(request, *applied, std::move(on_receipt)));
        recorder_.of("w")->follow(world());
    }

    void delete_world(OnReceipt on_receipt = {}) {
        v1::Request request;
        request.mutable_delete_world()->set_world("w");
        const simulation::RunId run_id = entry().run_id;
        const auto applied = laboratory_.apply(simulation::DeleteWorld{"w"});
        ASSERT_TRUE(applied) << to_text(applied.error());
        recorder_.end("w", run_id, record_of(request, *applied, std::move(on_receipt)));
    }

    /// Requests a receipt for everything recorded so far.
    void once_written() { recorder_.of("w")->once_written(ticket_ = receipts_->next_ticket()); }

    /// Waits for the last receipt that was requested, and returns it.
    Receipt receipt() { return receipts_->wait_for(ticket_); }
    bool has_receipt() { return receipts_->has(ticket_); }

  private:
    v1::Request& with_key(v1::Request& request) {
        request.set_client_key("test");
        request.set_request_id(++requests_);
        return request;
    }
    CommandRecord record_of(v1::Request& request, const simulation::Applied& applied, OnReceipt on_receipt) {
        if (request.client_key().empty()) {
            with_key(request);
        }
        const auto there = laboratory_.find("w");
        return {.tick = applied.tick,
                .control = there ? (*there)->control : simulation::RunControl{},
                .origin = {.by = base::client_actor("alice", "evoctl", "127.0.0.1:5000"),
                           .client_key = "test",
                           .request_id = requests_,
                           .request = request.SerializeAsString()},
                .answer = "answer " + std::to_string(requests_),
                .ticket = ticket_ = receipts_->next_ticket(std::move(on_receipt))};
    }

    base::InlineExecutor executor_;
    simulation::Laboratory laboratory_;
    const std::shared_ptr<support::Receipts> receipts_;
    Recorder recorder_;
    Ticket ticket_ = 0; // of the last receipt that was requested
    std::uint64_t requests_ = 0;
};

} // namespace evod::recording
