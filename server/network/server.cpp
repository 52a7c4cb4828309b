#include "server/network/server.h"

#include "server/log/log.h"
#include "server/network/detached.h"
#include "server/network/limits.h"
#include "server/network/random_ids.h"
#include "server/protocol/commands.h"
#include "server/protocol/parameters.h"
#include "server/protocol/populations.h"
#include "server/protocol/public_text.h"
#include "server/protocol/worlds.h"
#include "server/runtime/worker_pool.h"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/post.hpp>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <functional>
#include <utility>

namespace evod::network {

namespace {

/// Lists the parameters that differ: "population_size (50, not 60), selection (roulette, not tournament)".
std::string differences_of(const parameters::Parameters& there, const parameters::Parameters& wanted) {
    std::string text;
    for (const parameters::ParameterDescription* parameter : parameters::parameters_that_differ(there, wanted)) {
        text += (text.empty() ? "" : ", ") + std::string{parameter->name} + " (" +
                parameters::to_text(parameter->get(there)) + ", not " + parameters::to_text(parameter->get(wanted)) +
                ")";
    }
    return text;
}

} // namespace

base::Result<std::unique_ptr<Server>> Server::open(ServerOptions options) {
    std::unique_ptr<Server> server{new Server{std::move(options)}};
    // From here on signals are queued, even while worlds are being restored. run() handles them.
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        server->signals_.add(signal);
    }
    // Check the command line before files are opened and worlds are restored.
    if (auto sound = Listener::check(server->options_.bind_address, "--bind"); !sound) {
        return sound.error();
    }
    if (server->options_.http) {
        if (auto sound = Listener::check(server->options_.http->bind_address, "--http-bind"); !sound) {
            return sound.error();
        }
    }
    auto tls = access::server_context(server->options_.tls);
    if (!tls) {
        return tls.error();
    }
    server->tls_ = *std::move(tls);
    server->host_.tls = server->tls_.get();
    protocol::hide_folder(server->options_.data_folder);
    protocol::hide_folder(server->options_.token_folder);
    if (server->options_.replay) {
        protocol::hide_folder(std::filesystem::path{server->options_.replay->path}.parent_path().string());
        auto replay = runtime::FileReplay::open(server->options_.replay->path, server->options_.replay->generation,
                                                *server->executor_);
        if (!replay) {
            base::Refusal refused = replay.error();
            for (base::Violation& violation : refused.violations) {
                if (violation.field == "generation") {
                    violation.field = "--generation";
                }
            }
            return refused;
        }
        server->replay_ = *std::move(replay);
    } else if (auto opened = server->open_archive(); !opened) {
        return opened.error();
    } else if (auto begun = server->world_to_begin(); !begun) {
        return begun.error();
    }
    auto gate = access::Gate::open(server->options_.token_folder, server->needs_token());
    if (!gate) {
        return gate.error();
    }
    server->gate_ = *std::move(gate);
    auto listener = Listener::open(server->context_, server->options_.bind_address, server->options_.port);
    if (!listener) {
        return listener.error();
    }
    server->listener_ = *std::move(listener);
    if (auto opened = server->open_http(); !opened) {
        return opened.error();
    }
    std::signal(SIGPIPE, SIG_IGN); // writing the log to a closed pipe must not end the server
    return server;
}

bool Server::needs_token() const {
    const auto is_reachable = [](const std::string& text) {
        boost::system::error_code no_address; // Listener::check() has already reported it
        const auto address = asio::ip::make_address(text, no_address);
        return !no_address && !address.is_loopback();
    };
    // A proxy on this machine has a loopback address, whatever the address of its clients. --http-host announces one.
    return options_.token_needed || is_reachable(options_.bind_address) ||
           (options_.http && (is_reachable(options_.http->bind_address) || !options_.http->host_names.empty()));
}

Server::Server(ServerOptions options)
    : options_{std::move(options)}
    , send_memory_{client_buffer_bytes_max,
                   [this] {
                       asio::post(context_, [this] {
                           table_.evict();
                           // The closed sessions release their memory in handlers that are already posted. rearm() runs
                           // after these handlers.
                           asio::post(context_, [this] { send_memory_.rearm(); });
                       });
                   }}
    , executor_{runtime::make_executor(options_.threads)}
    , outbox_{[this] { asio::post(context_, [this] { deliver(); }); }}
    , table_{host_, options_.session_bounds}
    , streams_{table_.sessions(), demand_, mailbox_}
    , dispatcher_{context_,
                  mailbox_,
                  outbox_,
                  table_.sessions(),
                  streams_,
                  host_,
                  [this] { stop(); },
                  [this] { return metrics(); }} {
    host_.limits = limits_message(options_.session_bounds);
    host_.instance_id = to_text(draw_run_id());
    host_.clock = &clock_;
    host_.handle = [this](Session& session, v1::Request request) { dispatcher_.handle(session, std::move(request)); };
    host_.admit = [this](const std::string& token, const std::string& address) {
        return gate_->admit(token, address, access::Gate::Clock::now());
    };
    host_.ended = [this](Session& session) {
        dispatcher_.forget(session);
        table_.forget(session);
        streams_.forget(session);
    };
}

Server::~Server() {
    if (stopping_.joinable()) {
        stopping_.join();
    }
}

base::Result<void> Server::open_archive() {
    const std::string& path = options_.data_folder;
    if (path.empty()) {
        return {};
    }
    auto archive = replay::Archive::open(path, options_.run_files, *executor_);
    if (!archive) {
        return archive.error();
    }
    archive_ = *std::move(archive);
    host_.storage = protocol::to_proto(simulation::Storage{});
    host_.durability =
        options_.run_files.durability == run_file::Durability::Full ? v1::DURABILITY_FULL : v1::DURABILITY_RELAXED;
    if (!options_.first_world_asked) {
        return {};
    }
    const simulation::CreateWorld& wanted = options_.first_world;
    const run_file::RunIdentity* there = archive_->identity_of(wanted.name);
    const auto differs = [&](const std::string& in_what) {
        return base::Refusal{.code = base::RefusalCode::FailedPrecondition,
                             .message = path + " contains a world \"" + wanted.name + "\" with other " + in_what +
                                        ": use another --data folder, or start without --experiment, --seed "
                                        "and --population, and reset or delete that world",
                             .violations = {}};
    };
    if (archive_->is_damaged(wanted.name)) {
        log::error({.world = wanted.name},
                   "--experiment, --seed and --population have no effect: world \"{}\" exists and is damaged",
                   wanted.name);
        return {};
    }
    if (there && !(there->requested_parameters().values == wanted.parameters)) {
        return differs("parameters: " + differences_of(there->requested_parameters().values, wanted.parameters));
    }
    if (there && there->schedule != wanted.schedule) {
        return differs("schedule of parameters");
    }
    if (there && options_.first_seed_asked && there->seed.value != wanted.seed.value) {
        return differs("seed (" + std::to_string(there->seed.value) + ", not " + std::to_string(wanted.seed.value) +
                       ")");
    }
    if (there && wanted.first_population && !simulation::same(there->first_population, wanted.first_population)) {
        return differs("organisms");
    }
    return {};
}

bool Server::creates_first_world() const {
    if (options_.replay) {
        return false;
    }
    if (!archive_) {
        return true;
    }
    const std::vector<std::string> names = archive_->world_names();
    return options_.first_world_asked ? std::ranges::find(names, options_.first_world.name) == names.end()
                                      : names.empty();
}

base::Result<std::string> Server::world_to_begin() const {
    const std::string& first = options_.first_world.name;
    if (creates_first_world() || options_.first_world_asked || !(options_.first_speed || options_.first_run)) {
        return first;
    }
    const std::vector<std::string> names = archive_->world_names();
    if (names.size() == 1) {
        return names.front();
    }
    std::string all;
    for (const std::string& name : names) {
        if (name == first) {
            return first;
        }
        all += (all.empty() ? "" : ", ") + name;
    }
    return refusal(base::RefusalCode::FailedPrecondition,
                   "--speed and --start apply to one world, but " + options_.data_folder + " contains the worlds " +
                       all + ": start without them, then use evoctl --world NAME speed and run");
}

std::optional<base::Seed> Server::first_seed() const {
    if (creates_first_world()) {
        return options_.first_world.seed;
    }
    if (!archive_) {
        return std::nullopt;
    }
    const run_file::RunIdentity* there = archive_->identity_of(options_.first_world.name);
    return there ? std::optional{there->seed} : std::nullopt;
}

void Server::begin_first_world() {
    const simulation::CreateWorld& world = options_.first_world;
    if (creates_first_world()) {
        v1::Request request;
        v1::CreateWorld& create = *request.mutable_create_world();
        create.set_name(world.name);
        create.set_seed(world.seed.value);
        for (const parameters::ParameterDescription* parameter :
             parameters::parameters_that_differ(world.parameters, {})) {
            v1::ParameterAssignment& assignment = *create.add_parameters();
            assignment.set_name(std::string{parameter->name});
            *assignment.mutable_value() = protocol::to_proto(parameter->get(world.parameters));
        }
        *create.mutable_schedule() = protocol::to_proto(world.schedule, 1);
        protocol::add_population(create, world.first_population);
        dispatcher_.handle_own(std::move(request));
    }
    const std::string begun = *world_to_begin(); // open() has already checked that there is such a world
    const std::size_t others = archive_ && !creates_first_world() ? archive_->world_names().size() - 1 : 0;
    if (archive_ && archive_->is_damaged(begun)) {
        if (options_.first_speed || options_.first_run) {
            log::warn({.world = begun}, "--speed and --start have no effect: world \"{}\" is damaged", begun);
        }
        return;
    }
    if ((options_.first_speed || options_.first_run) && others > 0) {
        log::info({.world = begun}, "--speed and --start apply to world \"{}\" only; {} others continue as before",
                  begun, others);
    }
    if (options_.first_speed) {
        v1::Request request;
        request.mutable_set_speed()->set_world(begun);
        if (*options_.first_speed) {
            request.mutable_set_speed()->mutable_speed()->set_real_time_factor(**options_.first_speed);
        } else {
            request.mutable_set_speed()->mutable_speed()->set_max(true);
        }
        dispatcher_.handle_own(std::move(request));
    }
    if (options_.first_run) {
        v1::Request request;
        request.mutable_run()->set_world(begun);
        dispatcher_.handle_own(std::move(request));
    }
}

bool Server::run() {
    simulation::Laboratory worlds;
    if (archive_) {
        static_assert(replay::Archive::answers_kept_of_ended == retries_kept &&
                      replay::Archive::answers_of_ended_bytes_max == retry_bytes_max);
        dispatcher_.commands().restore(archive_->take_answers());
        worlds = archive_->take_laboratory();
        for (const auto& entry : worlds.entries()) {
            if (entry->control.leased) {
                dispatcher_.commands().restart_lease(entry->name);
            }
        }
    }
    if (options_.leader != nullptr) {
        worlds.share(*options_.leader, *executor_);
    }
    begin_first_world();
    simulation_ = std::make_unique<runtime::SimulationThread>(
        mailbox_, demand_, *executor_, clock_,
        runtime::LoopOutputs{
            .events = streams_.outlet(outbox_),
            .snapshot = [this](runtime::SnapshotPtr snapshot) { outbox_.snapshot(std::move(snapshot)); },
            .reply = [this](runtime::Reply reply) { outbox_.reply(std::move(reply)); },
            .storage = [this](const simulation::Storage& storage) { outbox_.storage({.storage = storage}); },
            .storage_of_world =
                [this](const std::string& world, const simulation::Storage& storage) {
                    outbox_.storage({.storage = storage, .world = world});
                },
            .damaged = [this](const simulation::DamagedWorld& damaged) { outbox_.damaged(damaged); },
            .counted = &worlds_counted_,
        },
        std::move(worlds), archive_ ? &archive_->recorder() : nullptr, std::exchange(replay_, std::nullopt));

    wait_for_signal();
    housekeeping_.start(*gate_);
    asio::co_spawn(context_, listener_->accept([this](tcp::socket socket) {
        table_.accept(std::make_unique<Transport>(std::move(socket), tls_.get()));
    }),
                   detached);
    if (http_) {
        http_->start();
    }
    context_.run();
    if (stopping_.joinable()) {
        stopping_.join();
    }
    return all_written_;
}

void Server::wait_for_signal() {
    signals_.async_wait([this](boost::system::error_code error, int signal) {
        if (error) {
            return;
        }
        const char* const name = signal == SIGINT ? "SIGINT" : signal == SIGTERM ? "SIGTERM" : "SIGHUP";
        if (signal == SIGHUP) {
            reread_certificate();
        } else if (!going_away_) {
            log::info("{}: shutting down", name);
            begin_shutdown();
        } else {
            log::warn("{} again: ending at once; after a restart the worlds continue from the state on the disk", name);
            signals_.remove(signal); // restores the default action: the next signal ends the process
            std::raise(signal);
        }
        wait_for_signal();
    });
}

void Server::reread_certificate() {
    auto tls = access::server_context(options_.tls);
    if (!tls) {
        log::error("SIGHUP: keeping the old certificate: {}", to_text(tls.error()));
    } else if (!*tls) {
        log::info("SIGHUP: no certificate to reload; a changed token file is reloaded without a signal");
    } else {
        tls_ = *std::move(tls); // existing connections keep the old certificate
        host_.tls = tls_.get();
        if (http_) {
            http_->set_tls(tls_.get());
        }
        log::info("SIGHUP: certificate reloaded for new connections");
    }
}

void Server::stop() {
    asio::post(context_, [this] { begin_shutdown(); });
}

void Server::deliver() {
    runtime::Outbox::Taken taken = outbox_.take();
    if (taken.dropped_events > 0) {
        limit_counters_.met(Limit::OutboxEvents, taken.dropped_events);
    }
    dispatcher_.deliver(std::move(taken.deliveries));
    streams_.deliver(std::move(taken));
    send_snapshots();
}

void Server::send_snapshots() {
    if (sends_snapshots_) {
        return;
    }
    sends_snapshots_ = streams_.send_some(clock_.now());
    if (sends_snapshots_) {
        asio::post(context_, [this] {
            sends_snapshots_ = false;
            send_snapshots();
        });
    }
}

void Server::begin_shutdown() {
    if (std::exchange(going_away_, true)) {
        return;
    }
    housekeeping_.stop();
    table_.refuse_all();
    listener_->close();
    if (http_) {
        http_->close();
    }
    dispatcher_.refuse_all();
    streams_.announce_end();
    // A separate thread stops the simulation, so that the network thread can send pending answers in the meantime.
    stopping_ = std::thread{[this, work = asio::make_work_guard(context_)] {
        simulation_->stop();
        const bool all_written = !archive_ || archive_->close();
        asio::post(context_, [this, all_written] {
            all_written_ = all_written;
            signals_.cancel();
            deliver();
            while (streams_.send_some(clock_.now())) {
                // Send the newest snapshots before the sessions end.
            }
            streams_.end_sessions();
        });
    }};
}

} // namespace evod::network
