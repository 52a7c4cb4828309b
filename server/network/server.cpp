#include "server/network/server.h"

#include "server/base/overloaded.h"
#include "server/log/log.h"
#include "server/network/detached.h"
#include "server/network/limits.h"
#include "server/protocol/commands.h"
#include "server/protocol/public_text.h"
#include "server/protocol/worlds.h"
#include "server/run_file/ended_runs.h"
#include "server/runtime/random_ids.h"
#include "server/runtime/worker_pool.h"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/post.hpp>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <functional>
#include <utility>
#include <variant>

namespace evod::network {

base::Result<void> Server::check(const ListenerOptions& listeners) {
    if (auto sound = Listener::check(listeners.bind_address, "--bind"); !sound) {
        return sound;
    }
    if (listeners.http) {
        if (auto sound = Listener::check(listeners.http->bind_address, "--http-bind"); !sound) {
            return sound;
        }
    }
    if (listeners.tls) {
        if (auto tls = access::server_context(*listeners.tls); !tls) {
            return tls.error();
        }
    }
    return {};
}

base::Result<std::unique_ptr<Server>> Server::open(ServerOptions options) {
    std::unique_ptr<Server> server{new Server{std::move(options)}};
    // From here on signals are queued, even while worlds are being restored. run() handles them.
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        server->signals_.add(signal);
    }
    // Check the options before files are opened and worlds are restored.
    const ListenerOptions& listeners = server->options_.listeners;
    if (auto sound = check(listeners); !sound) {
        return sound.error();
    }
    if (listeners.tls) {
        auto tls = access::server_context(*listeners.tls);
        if (!tls) {
            return tls.error();
        }
        server->tls_ = *std::move(tls);
        server->host_.tls = server->tls_.get();
    }
    if (listeners.token_folder) {
        protocol::hide_folder(*listeners.token_folder);
    }
    const base::Overloaded open_content{[&](const LiveWorlds& worlds) { return server->open_worlds(worlds); },
                                        [&](const ReplayedRun& run) { return server->open_replay(run); }};
    auto opened = std::visit(open_content, server->options_.worlds);
    if (!opened) {
        return opened.error();
    }
    auto authenticator = access::Authenticator::open(listeners.token_folder, needs_token(listeners));
    if (!authenticator) {
        return authenticator.error();
    }
    server->authenticator_ = *std::move(authenticator);
    auto listener = Listener::open(server->context_, listeners.bind_address, listeners.port);
    if (!listener) {
        return listener.error();
    }
    server->listener_ = *std::move(listener);
    if (opened = server->open_http(); !opened) {
        return opened.error();
    }
    std::signal(SIGPIPE, SIG_IGN); // writing the log to a closed pipe must not end the server
    return server;
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
    , simulations_{std::holds_alternative<ReplayedRun>(options_.worlds)}
    , outbox_{[this] { asio::post(context_, [this] { deliver(); }); }}
    , table_{host_, options_.limits.sessions_max}
    , streams_{table_.sessions(), simulations_, send_memory_}
    , dispatcher_{context_,
                  simulations_,
                  outbox_,
                  table_.sessions(),
                  streams_,
                  host_,
                  options_.limits.replays_max,
                  classes_,
                  [this] { stop(); },
                  [this] { return metrics(); }} {
    host_.limits = limits_message(options_.limits);
    host_.instance_id = to_text(runtime::draw_run_id());
    host_.clock = &clock_;
    host_.make_room = [this](const std::string& account) { return table_.make_room(account); };
    host_.handle = [this](Session& session, v1::Request request) { dispatcher_.handle(session, std::move(request)); };
    host_.admit = [this](const std::string& token, const std::string& address) {
        return authenticator_->admit(token, address, access::Authenticator::Clock::now());
    };
    host_.admit_member = [this](const v1::Hello& hello) { return dispatcher_.class_requests().admit(hello); };
    host_.shared_snapshot_bytes = [this] { return streams_.shared_bytes(); };
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

base::Result<void> Server::open_worlds(const LiveWorlds& worlds) {
    if (worlds.storage) {
        protocol::hide_folder(worlds.storage->folder);
        auto archive = replay::Archive::open(worlds.storage->folder, worlds.storage->run_files, *executor_);
        if (!archive) {
            return archive.error();
        }
        archive_ = *std::move(archive);
        auto registry = classes::Registry::open(
            classes::Registry::File{worlds.storage->folder, worlds.storage->run_files.durability});
        if (!registry) {
            return registry.error();
        }
        classes_ = *std::move(registry);
        archive_->thread()->disk().set_limits(worlds.storage->limits);
        if (const auto keep = worlds.storage->limits.keep_runs) {
            const auto deleted = run_file::prune(worlds.storage->folder, *keep);
            if (!deleted) {
                return deleted.error();
            }
            for (const std::string& failure : deleted->failures) {
                log::warn("--keep-runs: {}", failure);
            }
            if (!deleted->deleted.empty()) {
                log::info("--keep-runs {}: deleted {} runs", *keep, deleted->deleted.size());
            }
        }
        host_.storage = protocol::to_proto(simulation::Storage{});
        host_.durability =
            archive_->durability() == run_file::Durability::Full ? v1::DURABILITY_FULL : v1::DURABILITY_RELAXED;
    }
    auto first_world = FirstWorld::choose(worlds, archive_.get());
    if (!first_world) {
        return first_world.error();
    }
    first_world_ = *std::move(first_world);
    return {};
}

base::Result<void> Server::open_replay(const ReplayedRun& run) {
    protocol::hide_folder(std::filesystem::path{run.path}.parent_path().string());
    auto replay = runtime::FileReplay::open(run.path, run.generation, *executor_);
    if (!replay) {
        base::Refusal refused = replay.error();
        for (base::Violation& violation : refused.violations) {
            if (violation.field == "generation") {
                violation.field = "--generation";
            }
        }
        return refused;
    }
    replay_ = *std::move(replay);
    return {};
}

bool Server::run() {
    simulation::Laboratory worlds;
    if (archive_) {
        static_assert(replay::Archive::answers_kept_of_ended == answers_cached_max &&
                      replay::Archive::answers_of_ended_bytes_max == retry_bytes_max &&
                      replay::Archive::keys_kept_of_ended == evicted_keys_max);
        dispatcher_.commands().restore(archive_->take_used_keys(), archive_->take_answers());
        worlds = archive_->take_laboratory();
        for (const auto& entry : worlds.entries()) {
            if (entry->control.leased) {
                dispatcher_.commands().restart_lease(entry->name);
            }
        }
    }
    if (const auto* live = std::get_if<LiveWorlds>(&options_.worlds); live != nullptr && live->processes) {
        worlds.share(live->processes->islands_maker, *executor_);
    }
    worlds.set_worlds_max(options_.limits.worlds_max);
    if (first_world_) {
        first_world_->begin([this](v1::Request request) { dispatcher_.commands().handle_own(std::move(request)); });
    }
    simulations_.start({
        .executor = *executor_,
        .clock = clock_,
        .outputs = {
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
        .laboratory = std::move(worlds),
        .recorder = archive_ ? &archive_->recorder() : nullptr,
        .file = std::exchange(replay_, std::nullopt),
    });

    dispatcher_.class_requests().begin();
    wait_for_signal();
    housekeeping_.start(*authenticator_);
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
            reread();
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

void Server::reread() {
    if (options_.reread) {
        auto now = options_.reread();
        if (!now) {
            return;
        }
        if (options_.listeners.tls && now->tls) {
            options_.listeners.tls = *std::move(now->tls);
        }
        if (archive_ && archive_->thread() != nullptr) {
            archive_->thread()->disk().set_limits(now->storage);
        }
    }
    reread_certificate();
}

void Server::reread_certificate() {
    if (!options_.listeners.tls) {
        log::info("SIGHUP: no certificate to reload; a changed token file is reloaded without a signal");
        return;
    }
    auto tls = access::server_context(*options_.listeners.tls);
    if (!tls) {
        log::error("SIGHUP: keeping the old certificate: {}", to_text(tls.error()));
        return;
    }
    tls_ = *std::move(tls); // existing connections keep the old certificate
    host_.tls = tls_.get();
    if (http_) {
        http_->set_tls(tls_.get());
    }
    log::info("SIGHUP: certificate reloaded for new connections");
}

void Server::stop() {
    asio::post(context_, [this] { begin_shutdown(); });
}

void Server::deliver() {
    runtime::Outbox::Taken taken = outbox_.take();
    for (const auto& [user, count] : taken.dropped_events) {
        limit_counters_.met(Limit::OutboxEvents, count);
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
        simulations_.stop();
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
