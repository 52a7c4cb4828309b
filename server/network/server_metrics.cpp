// The part of Server that collects metrics, checks the server's health, and opens the HTTP port that serves both and
// the browser viewer.
#include "proto/codec/compression.h"
#include "proto/codec/gzip.h"
#include "server/base/instructions.h"
#include "server/metrics/exposition.h"
#include "server/metrics/families.h"
#include "server/metrics/process.h"
#include "server/network/description.h"
#include "server/network/limits.h"
#include "server/network/server.h"
#include "server/network/web_assets.h"
#include "server/protocol/public_text.h"
#include "server/protocol/refusals.h"
#include "server/run_file/data_folder.h"
#include "server/run_file/ended_runs.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <climits>
#include <map>
#include <memory>
#include <span>

namespace evod::network {
namespace {

using metrics::add_counter;
using metrics::add_gauge;
using metrics::add_histogram;

double number(std::uint64_t count) {
    return static_cast<double>(count);
}

constexpr std::array storage_states{
    std::pair{v1::STORAGE_STATE_KEEPS_UP, "keeps_up"}, std::pair{v1::STORAGE_STATE_BEHIND, "behind"},
    std::pair{v1::STORAGE_STATE_FAILING, "failing"}, std::pair{v1::STORAGE_STATE_STALLED, "stalled"}};

void add_colonies(v1::Metrics& to, std::span<const std::shared_ptr<const metrics::World>> worlds) {
    constexpr std::array names{"prey", "predators"};
    auto living =
        add_gauge(to, "evod_colony_organisms", "Living organisms of a species at the end of the last interval");
    auto born = add_counter(to, "evod_colony_births_total", "Births of a species in the intervals that have ended");
    for (const auto& world : worlds) {
        for (std::size_t i = 0; i < names.size(); ++i) {
            if (const metrics::Species& species = world->species[i]; species.counted.value() > 0) {
                living.add(species.living.value(), {{"world", world->name}, {"species", names[i]}});
                born.add(number(species.born.value()), {{"world", world->name}, {"species", names[i]}});
            }
        }
    }
}

void add_worlds(v1::Metrics& to, const metrics::Worlds& counted) {
    const auto worlds = counted.list();
    add_gauge(to, "evod_worlds", "Worlds").add(number(worlds.size()));
    add_gauge(to, "evod_worlds_damaged", "Worlds that do not run because they cannot be restored from their run files")
        .add(number(counted.damaged().size()));
    auto ticks = add_counter(to, "evod_ticks_total", "Simulated ticks");
    auto rate = add_gauge(to, "evod_ticks_per_second",
                          "Ticks per second, measured over about one second; 0 while the world does not run");
    auto tick_time = add_histogram(to, "evod_tick_seconds", "Time per tick; at full speed, with journal and snapshots");
    auto snapshot_time = add_histogram(to, "evod_snapshot_seconds",
                                       "Time of the simulation thread to copy a snapshot, without encoding");
    for (const auto& world : worlds) {
        ticks.add(number(world->tick_time.count()), {{"world", world->name}});
        rate.add(world->ticks_per_s.value(), {{"world", world->name}});
        tick_time.add(world->tick_time, {{"world", world->name}});
        snapshot_time.add(world->snapshot_time, {{"world", world->name}});
    }
    add_colonies(to, worlds);
}

void add_queues(v1::Metrics& to, const base::Quota& mailbox, const runtime::Outbox::FillLevel& outbox) {
    add_gauge(to, "evod_mailbox_requests", "Requests waiting for the simulation").add(number(mailbox.held()));
    add_gauge(to, "evod_mailbox_requests_max", "Capacity of the mailbox; further requests are refused")
        .add(number(mailbox.total()));
    add_gauge(to, "evod_outbox_deliveries", "Answers and events that wait between simulation and network")
        .add(number(outbox.deliveries));
    add_gauge(to, "evod_outbox_events", "Events among the deliveries").add(number(outbox.events));
    add_gauge(to, "evod_outbox_events_max", "Capacity for events; further events are dropped")
        .add(number(outbox.events_max));
}

void add_sessions(v1::Metrics& to, const Sessions& all, std::size_t sessions_max) {
    std::map<std::string, std::uint64_t> by_role{
        {"admin", 0}, {"controller", 0}, {"teacher", 0}, {"viewer", 0}, {"none", 0}};
    std::uint64_t snapshots = 0, events = 0;
    for (const auto& [session_number, session] : all) {
        ++by_role[session->greeted() ? access::name_of(session->user().role) : "none"];
        snapshots += session->snapshots.subscriptions.size();
        events += session->events.size();
    }
    auto sessions = add_gauge(to, "evod_sessions", "Connected clients; role none: before the Hello");
    for (const auto& [role, count] : by_role) {
        sessions.add(number(count), {{"role", role}});
    }
    add_gauge(to, "evod_sessions_max", "Maximum number of sessions; further clients are refused")
        .add(number(sessions_max));
    add_gauge(to, "evod_subscriptions", "Subscriptions of all clients")
        .add(number(snapshots), {{"to", "snapshots"}})
        .add(number(events), {{"to", "events"}});
}

void add_traffic(v1::Metrics& to, const metrics::Traffic& traffic) {
    add_counter(to, "evod_connections_total", "Accepted connections").add(number(traffic.connections.value()));
    add_counter(to, "evod_websockets_total", "Accepted connections that are WebSockets of browsers")
        .add(number(traffic.websockets.value()));
    add_counter(to, "evod_http_refused_total", "HTTP requests refused because of their Host, Origin or missing token")
        .add(number(traffic.http_refused_hosts.value()), {{"because", "host"}})
        .add(number(traffic.http_refused_origins.value()), {{"because", "origin"}})
        .add(number(traffic.http_refused_tokens.value()), {{"because", "token"}});
    add_counter(to, "evod_requests_total", "Readable requests, including refused ones")
        .add(number(traffic.requests.value()));
    add_counter(to, "evod_received_bytes_total", "Bytes received from clients, without the overhead of TLS")
        .add(number(traffic.received_bytes.value()));
    add_counter(to, "evod_sent_bytes_total",
                "Bytes sent to clients, without the overhead of TLS; control: answers and events, stream: snapshots")
        .add(number(traffic.sent_control_bytes.value()), {{"channel", "control"}})
        .add(number(traffic.sent_stream_bytes.value()), {{"channel", "stream"}});
    add_counter(to, "evod_snapshots_sent_total", "Snapshots sent, counted per island and subscription")
        .add(number(traffic.snapshots_sent.value()));
    add_counter(to, "evod_snapshots_dropped_total", "Snapshots replaced by newer ones before they were sent")
        .add(number(traffic.snapshots_dropped.value()));
    add_counter(to, "evod_events_dropped_total", "Events that were not sent because a client was slow")
        .add(number(traffic.events_dropped.value()));
}

void add_limits(v1::Metrics& to, const LimitCounters& counters) {
    auto reached = add_counter(to, "evod_limit_reached_total", "How often each limit was reached");
    for (const LimitRow& row : limit_table()) {
        reached.add(number(counters.count(row.limit)), {{"limit", std::string{row.name}}});
    }
    auto taken_back = add_counter(to, "evod_limit_taken_back_total",
                                  "How often the user with the most lost its oldest, because another user wanted it");
    for (const LimitRow& row : limit_table()) {
        if (row.is_shared) {
            taken_back.add(number(counters.taken_back_count(row.limit)), {{"limit", std::string{row.name}}});
        }
    }
}

void add_pools(v1::Metrics& to, const std::vector<std::pair<Limit, base::Quota>>& pools) {
    const auto name_of = [](Limit limit) {
        return std::string{std::ranges::find(limit_table(), limit, &LimitRow::limit)->name};
    };
    auto totals = add_gauge(to, "evod_pool_total", "Size of each pool that all clients share; a user may hold half");
    auto held = add_gauge(to, "evod_pool_held", "What all clients together hold of it");
    auto most = add_gauge(to, "evod_pool_held_by_one", "What the user with the most holds of it");
    for (const auto& [limit, quota] : pools) {
        totals.add(number(quota.total()), {{"limit", name_of(limit)}});
        held.add(number(quota.held()), {{"limit", name_of(limit)}});
        most.add(number(quota.held(quota.largest())), {{"limit", name_of(limit)}});
    }
}

void add_storage(v1::Metrics& to, const std::string& folder, recording::StorageThread& thread,
                 const v1::Storage& storage) {
    auto world_bytes = add_gauge(to, "evod_world_bytes", "Bytes of the run file of a world, with its write-ahead log");
    if (const auto files = run_file::DataFolder::files_in(folder)) {
        for (const std::string& path : files->of_worlds) {
            world_bytes.add(number(run_file::bytes_of_run(path)), {{"world", run_file::world_of(path)}});
        }
    }
    add_gauge(to, "evod_disk_bytes", "Bytes of all files in the data folder")
        .add(number(run_file::bytes_of_folder(folder)));
    auto bytes_max = add_gauge(to, "evod_disk_bytes_max", "Limit of these bytes, --disk-max; without it, no value");
    if (const auto limit = thread.disk().limits().disk_bytes_max) {
        bytes_max.add(number(*limit));
    }
    auto state = add_gauge(to, "evod_storage_state", "State of the disk: 1 for the current state");
    for (const auto& [value, name] : storage_states) {
        state.add(storage.state() == value, {{"state", name}});
    }
    const auto since = thread.waiting_since();
    const std::chrono::duration<double> lag =
        since ? std::chrono::steady_clock::now() - *since : std::chrono::steady_clock::duration{0};
    add_gauge(to, "evod_journal_waiting_bytes", "Bytes waiting to be written to run files")
        .add(number(thread.disk().waiting_bytes()));
    add_gauge(to, "evod_journal_waiting_bytes_max", "Limit of the waiting bytes; above it, worlds wait for the disk")
        .add(number(recording::DiskState::waiting_bytes_max));
    add_gauge(to, "evod_journal_lag_seconds", "Age of the oldest waiting bytes; up to 0.2 s is normal")
        .add(std::max(lag.count(), 0.0));
    add_histogram(to, "evod_journal_wait_seconds", "Time from applying a command until it is on the disk and answered")
        .add(thread.times().journal_wait);
    add_histogram(to, "evod_journal_commit_seconds",
                  "Time of a group commit of commands, hashes and generations, including the sync to disk")
        .add(thread.times().commit);
}

/// The message schema, which clients without generated code load.
HttpFile schema_file() {
    const std::string& schema = description().file_descriptor_set();
    static const std::string compressed = codec::gzip(schema);
    return {
        .compressed = {.path = "/protocol.bin",
                       .type = "application/octet-stream",
                       .bytes = compressed,
                       .etag = '"' + std::to_string(codec::crc32(schema)) + '-' + std::to_string(schema.size()) + '"'},
        .plain = schema};
}

} // namespace

v1::Metrics Server::metrics() {
    v1::Metrics all;
    add_gauge(all, "evod_build_info", "Always 1; the labels are the version and the vector instructions in use")
        .add(1, {{"version", EVOD_VERSION}, {"instructions", std::string{base::name_of(base::instructions())}}});
    add_worlds(all, worlds_counted_);
    const auto* const live = std::get_if<LiveWorlds>(&options_.worlds);
    const runtime::Processes* const processes =
        live != nullptr && live->processes ? &live->processes->all.get() : nullptr;
    add_gauge(all, "evod_processes", "Processes of mpirun that share worlds, with this one")
        .add(processes != nullptr ? processes->size() : 1);
    add_counter(all, "evod_exchange_seconds_total",
                "Time for which the simulation has waited for the other processes and for what they send")
        .add(processes != nullptr ? processes->exchange_s() : 0);
    add_queues(all, simulations_.mailbox_places(), outbox_.fill());
    add_sessions(all, table_.sessions(), options_.limits.sessions_max);
    add_counter(all, "evod_logins_failed_total", "Logins with an unknown token")
        .add(number(authenticator_->failed_login_count()));
    add_gauge(all, "evod_client_buffer_bytes",
              "Memory of all sessions: data to send, requests and exports, subscriptions and snapshots, replays, "
              "incomplete frames")
        .add(number(send_memory_.bytes()));
    add_gauge(
        all, "evod_client_buffer_bytes_max",
        "Limit of that memory; above it, and if a user uses more than half of it, the largest sessions are closed")
        .add(number(client_buffer_bytes_max));
    add_traffic(all, host_.traffic);
    add_limits(all, limit_counters_);
    std::vector<std::pair<Limit, base::Quota>> pools{
        {Limit::Sessions, table_.places()},
        {Limit::Newcomers, table_.newcomers()},
        {Limit::MailboxCommands, simulations_.mailbox_places()},
        {Limit::Replays, dispatcher_.replay_places().quota()},
        {Limit::Exports, dispatcher_.background_queries().exports()},
        {Limit::RunningBreedings, dispatcher_.background_queries().breedings()},
        {Limit::ClientKeys, dispatcher_.commands().cached_keys()}};
    if (http_) {
        pools.emplace_back(Limit::HttpConnections, http_->places());
    }
    add_pools(all, pools);
    if (archive_ && archive_->thread() != nullptr && host_.storage) {
        add_storage(all, archive_->path(), *archive_->thread(), *host_.storage);
    }

    const metrics::Process process = metrics::read_process();
    add_gauge(all, "process_start_time_seconds", "Start of the server, in seconds since 1970")
        .add(process.start_time_s);
    add_counter(all, "process_cpu_seconds_total", "CPU time of all threads").add(process.cpu_s);
    auto threads = add_counter(all, "evod_thread_cpu_seconds_total", "CPU time by thread; the rest is the worker pool");
    const auto add_thread = [&](const char* name, pthread_t thread) {
        if (const auto cpu_s = metrics::cpu_s_of(thread)) {
            threads.add(*cpu_s, {{"thread", name}});
        }
    };
    add_thread("network", pthread_self());
    if (!going_away_) {
        simulations_.for_each_thread(add_thread);
    }
    if (archive_ && archive_->thread() != nullptr) {
        add_thread("storage", archive_->thread()->handle());
        add_thread("packing", archive_->thread()->packing_handle());
    }
    add_gauge(all, "process_resident_memory_bytes", "Resident memory").add(number(process.resident_bytes));
    add_gauge(all, "process_virtual_memory_bytes", "Virtual memory").add(number(process.virtual_bytes));
    add_gauge(all, "process_open_fds", "Open file descriptors").add(number(process.open_files));
    add_gauge(all, "process_max_fds", "Limit of open file descriptors").add(number(process.open_files_max));
    return all;
}

asio::awaitable<HttpAnswer> Server::health() {
    const auto ill = [](const std::string& why) {
        return HttpAnswer{.status = boost::beast::http::status::service_unavailable,
                          .text = protocol::quotable(protocol::public_text(why), 1000) + '\n'};
    };
    const bool answers = co_await dispatcher_.simulation_answers_within(simulation_patience);
    if (going_away_) {
        co_return ill("the server is shutting down");
    }
    if (!answers) {
        co_return ill("the simulation has not responded for " + std::to_string(simulation_patience.count()) + " s");
    }
    const auto state = host_.storage ? host_.storage->state() : v1::STORAGE_STATE_KEEPS_UP;
    if (state == v1::STORAGE_STATE_FAILING || state == v1::STORAGE_STATE_STALLED) {
        co_return ill("runs cannot be written: " + host_.storage->reason());
    }
    std::string text = "ok\n";
    for (const std::string& world : worlds_counted_.damaged()) {
        text += "damaged world: " + world + '\n';
    }
    co_return HttpAnswer{.text = std::move(text)};
}

base::Result<void> Server::open_http() {
    const std::optional<HttpOptions>& options = options_.listeners.http;
    if (!options) {
        return {};
    }
    boost::system::error_code no_address; // open() has already reported it
    std::array<char, HOST_NAME_MAX + 1> machine{};
    ::gethostname(machine.data(), machine.size() - 1); // without a name it stays empty
    auto host_names =
        HostNames::make(asio::ip::make_address(options->bind_address, no_address), machine.data(), options->host_names);
    if (!host_names) {
        return host_names.error();
    }
    HttpService service{.limit_counters = limit_counters_,
                        .traffic = host_.traffic,
                        .host_names = *std::move(host_names),
                        .tls = tls_.get(),
                        .embedders = options->embedders};
    service.pages["/metrics"] = {.make = [this]() -> asio::awaitable<HttpAnswer> {
                                     co_return HttpAnswer{.text = metrics::to_prometheus(metrics()),
                                                          .type = metrics::prometheus_content_type};
                                 },
                                 .needs_token = needs_token(options_.listeners)};
    service.pages["/healthz"] = {.make = [this] { return health(); }};
    for (const WebAsset& asset : web_assets()) {
        service.files.push_back({.compressed = asset, .plain = codec::gunzip(asset.bytes)});
    }
    service.files.push_back(schema_file());
    service.admit = host_.admit;
    service.session = [this](std::unique_ptr<Transport> transport) {
        host_.traffic.websockets.add();
        table_.accept(std::move(transport));
    };
    auto http = Http::open(context_, options->bind_address, options->port, std::move(service));
    if (!http) {
        return http.error();
    }
    http_ = *std::move(http);
    if (!web_assets().empty()) {
        host_.page = page_address(http_->endpoint(), options->host_names, options_.listeners.tls.has_value());
    }
    return {};
}

} // namespace evod::network
