// Limits: every bound of the network in one table, and how clients are told of them.
#pragma once

#include "evod/v1/commands.pb.h"
#include "proto/wire/framing.h"
#include "proto/wire/tiles.h"
#include "server/protocol/commands.h"
#include "server/protocol/queries.h"
#include "server/runtime/export_thread.h"
#include "server/runtime/mailbox.h"
#include "server/runtime/time_travel.h"
#include "server/simulation/world.h"
#include "server/simulation/world_name.h"

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace evod::network {

// Told to clients.
constexpr std::uint32_t requests_in_flight_max = 32; // more: refused with RESOURCE_EXHAUSTED
constexpr std::uint32_t subscriptions_max = 32;      // of a session; more: refused
constexpr std::uint32_t sessions_max = 256;          // more: told so, and closed
constexpr std::uint32_t sessions_per_address_max =
    128;                                          // so that no single machine takes all; more: told so, and closed
constexpr double snapshot_rate_hz_max = 120;      // more: capped
constexpr std::uint32_t retries_kept = 1000;      // answers per client_key; an older request is refused
constexpr std::uint32_t client_keys_max = 256;    // the longest unused is forgotten
constexpr std::uint32_t exports_max = 8;          // of all sessions; more: refused
constexpr std::chrono::seconds hello_timeout{5};  // then the session is closed
constexpr std::chrono::seconds frame_timeout{10}; // from its first byte to its last; then the same
constexpr std::chrono::seconds lease_time{5};     // of a world that is lent; then it goes on

// Of a session's send queue.
constexpr std::size_t queued_event_bytes_max = 1 << 20;     // more: events are dropped and counted
constexpr std::size_t queued_response_bytes_max = 16 << 20; // more: the client does not read, and is closed
constexpr int unsent_bytes_max = 128 << 10; // in the kernel, so that a slow viewer gets new pictures and not old ones

// Whether somebody is still there is asked by TCP itself, whose answer a busy or patient client need not give: after so
// much silence, so often; and what was sent has to be taken by the other end within the last.
constexpr std::chrono::seconds silence_max{10}, probe_every{5};
constexpr int probes_max = 4;
constexpr std::chrono::milliseconds untaken_max{30'000};

// Of all retries together: the answers of the longest unused keys go first.
constexpr std::size_t retry_bytes_max = 64 << 20;

constexpr std::chrono::milliseconds tokens_look_every{500}; // for a token file that has changed
constexpr std::chrono::seconds farewell_timeout{1};         // for the last bytes of a session that ends
constexpr std::chrono::milliseconds accept_pause{100};      // when the system has no file descriptors left

/// The table as clients read it.
inline v1::Limits limits_message() {
    v1::Limits limits;
    limits.set_control_frame_bytes_max(*wire::server_limits.control_bytes_max);
    limits.set_hello_frame_bytes_max(*wire::hello_limits.control_bytes_max);
    limits.set_requests_in_flight_max(requests_in_flight_max);
    limits.set_subscriptions_max(subscriptions_max);
    limits.set_sessions_max(sessions_max);
    limits.set_worlds_max(simulation::worlds_max);
    limits.set_sessions_per_address_max(sessions_per_address_max);
    limits.set_lease_s(static_cast<std::uint32_t>(lease_time.count()));
    limits.set_frame_timeout_s(static_cast<std::uint32_t>(frame_timeout.count()));
    limits.set_snapshot_rate_hz_max(snapshot_rate_hz_max);
    limits.set_history_generations_kept(simulation::World::history_generations_kept);
    limits.set_history_generations_max(protocol::history_statistics_max);
    limits.set_mailbox_commands_max(runtime::mailbox_commands_max);
    limits.set_retries_kept(retries_kept);
    limits.set_world_name_bytes_max(simulation::world_name_bytes_max);
    limits.set_client_key_bytes_max(protocol::client_key_bytes_max);
    limits.set_client_keys_max(client_keys_max);
    limits.set_hello_timeout_s(static_cast<std::uint32_t>(hello_timeout.count()));
    limits.set_pasts_max(runtime::TimeTravel::pasts_max);
    limits.set_tiles_max(wire::tiles_max);
    limits.set_exports_max(exports_max);
    limits.set_export_patience_s(static_cast<std::uint32_t>(
        std::chrono::duration_cast<std::chrono::seconds>(runtime::ExportThread::patience).count()));
    return limits;
}

} // namespace evod::network
