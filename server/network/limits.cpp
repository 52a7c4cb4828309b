#include "server/network/limits.h"

#include "proto/codec/framing.h"
#include "proto/codec/tiles.h"
#include "server/base/assert.h"
#include "server/protocol/breeding.h"
#include "server/protocol/commands.h"
#include "server/protocol/queries.h"
#include "server/runtime/export_job.h"
#include "server/runtime/mailbox.h"
#include "server/runtime/outbox.h"
#include "server/runtime/replays.h"
#include "server/simulation/world.h"
#include "server/simulation/world_name.h"

#include <google/protobuf/descriptor.h>

namespace evod::network {
namespace {

constexpr std::uint64_t seconds(std::chrono::milliseconds duration) {
    return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::seconds>(duration).count());
}

constexpr LimitRow table[] = {
    {Limit::HelloFrameBytes, "hello_frame_bytes_max", *codec::hello_limits.control_bytes_max,
     "body of a client's first frame", "Goodbye, and closed; the length in a header reserves no memory"},
    {Limit::ControlFrameBytes, "control_frame_bytes_max", *codec::server_limits.control_bytes_max,
     "body of a later frame of a client; 65,536 below the role admin", "Goodbye, and closed"},
    {Limit::MessageDepth, "message_depth_max", codec::message_depth_max, "nesting of messages",
     "refused, `INVALID_ARGUMENT`, with `request_id` 0; a first frame also closes the session"},
    {Limit::HelloTimeout, "hello_timeout_s", seconds(hello_timeout), "from connecting to the Hello, TLS included",
     "Goodbye, unless TLS has not begun, and closed"},
    {Limit::FrameTimeout, "frame_timeout_s", seconds(frame_timeout), "from the first to the last byte of a frame",
     "Goodbye, and closed"},
    {Limit::StalledTimeout, "stalled_timeout_s", seconds(stalled_timeout),
     "a client receives nothing although data waits for it", "closed"},
    {Limit::Sessions, "sessions_max", SessionBounds{}.sessions_max, "sessions; `--sessions-max`",
     "the oldest session without a Hello gets a Goodbye and is closed; if there is none, the new one. While 64 "
     "Goodbyes are "
     "being sent, it is closed without one"},
    {Limit::SessionsPerAddress, "sessions_per_address_max", SessionBounds{}.sessions_per_address_max,
     "sessions from one address, with IPv6 from one /64; `--sessions-per-address-max`",
     "as for `sessions_max`, among the sessions of the address"},
    {Limit::RequestsPerSecond, "requests_per_s_max", requests_per_s_max,
     "frames of a session per second, averaged, invalid ones included; each further 64 bytes of a frame and each 1,024 "
     "bytes "
     "of its answer count as one more frame",
     "rate limit: the server reads further frames later and refuses nothing"},
    {Limit::RequestBurst, "request_burst_max", request_burst_max, "frames of a session at once, counted likewise",
     "as for `requests_per_s_max`"},
    {Limit::RequestsInFlight, "requests_in_flight_max", requests_in_flight_max, "unanswered requests of a session",
     "refused, `RESOURCE_EXHAUSTED`: wait for an answer"},
    {Limit::MailboxCommands, "mailbox_commands_max", runtime::mailbox_commands_max,
     "requests of all sessions waiting for the simulation", "refused, `RESOURCE_EXHAUSTED`: try again"},
    {Limit::Subscriptions, "subscriptions_max", subscriptions_max, "subscriptions of a session",
     "refused, `RESOURCE_EXHAUSTED`"},
    {Limit::WatchedIslands, "watched_islands_max", watched_islands_max,
     "islands in all snapshot subscriptions of a session together", "refused, `RESOURCE_EXHAUSTED`"},
    {Limit::SnapshotRate, "snapshot_rate_hz_max", static_cast<std::uint64_t>(snapshot_rate_hz_max),
     "snapshots per second of a subscription", "lowered to it; the answer contains the new rate"},
    {Limit::Tiles, "tiles_max", codec::tiles_max, "tiles of an island", "the server makes larger tiles"},
    {Limit::Worlds, "worlds_max", simulation::worlds_max, "worlds", "refused, `RESOURCE_EXHAUSTED`"},
    {Limit::PlannedChanges, "planned_changes_max", parameters::planned_changes_max,
     "planned changes waiting in a world", "refused, `RESOURCE_EXHAUSTED`"},
    {Limit::Replays, "replays_max", runtime::Replays::replays_max, "replays of a session",
     "refused, `RESOURCE_EXHAUSTED`; so is the 65th replay of all sessions"},
    {Limit::Lease, "lease_s", seconds(lease_time), "duration of a lease after the last RunUntilTick or RenewLease",
     "the world continues"},
    {Limit::Exports, "exports_max", exports_max, "running exports of all sessions", "refused, `RESOURCE_EXHAUSTED`"},
    {Limit::ExportPatience, "export_patience_s", seconds(runtime::ExportJob::patience),
     "from a part of an export to the next ContinueExport", "the export is cancelled"},
    {Limit::WorldNameBytes, "world_name_bytes_max", simulation::world_name_bytes_max, "name of a new world",
     "refused, `INVALID_ARGUMENT`"},
    {Limit::ClientKeyBytes, "client_key_bytes_max", protocol::client_key_bytes_max, "a `client_key`",
     "refused, `INVALID_ARGUMENT`"},
    {Limit::RetriesKept, "retries_kept", retries_kept, "cached answers of each `client_key`, for retries",
     "an older request is refused, `FAILED_PRECONDITION`"},
    {Limit::ClientKeys, "client_keys_max", client_keys_max,
     "keys with cached answers; all answers together at most 64 MiB",
     "keys with a single command are evicted first, then the least recently used; requests of an evicted key up to its "
     "highest id are refused, `FAILED_PRECONDITION`, until 100,000 further keys are evicted"},
    {Limit::HistoryGenerationsKept, "history_generations_kept", simulation::World::history_generations_kept,
     "generations of statistics kept per world; above 13 islands as many as fit into 131,072 rows",
     "the oldest are dropped; a `History` begins after them"},
    {Limit::HistoryGenerations, "history_generations_max", protocol::history_statistics_max,
     "`GenerationStatistics` in a `History`, but at least one generation",
     "cut; `next_generation` says where to continue"},
    {Limit::BreedingRows, "breeding_rows_max", protocol::breeding_rows_max, "rows of each list of a `Breeding`",
     "cut: ask again with the next first row"},
    {Limit::PopulationRows, "population_rows_max", protocol::population_rows_max, "organisms in a `Population`",
     "cut: ask again from the next organism"},
    {Limit::ClientBufferBytes, "client_buffer_bytes_max", client_buffer_bytes_max,
     "memory of all sessions: data to send, answers in preparation, incomplete frames",
     "the sessions with the most memory are closed"},
    {Limit::QueuedResponseBytes, "queued_response_bytes_max", queued_response_bytes_max,
     "answers that a session has not read", "closed"},
    {Limit::QueuedEventBytes, "queued_event_bytes_max", queued_event_bytes_max, "events that a session has not read",
     "further events are dropped; `EventsDropped` contains their number"},
    {Limit::OutboxEvents, "waiting_events_max", runtime::outbox_events_max,
     "events of all worlds between simulation and network", "as for `queued_event_bytes_max`, for all sessions"},
    {Limit::HttpConnections, "http_connections_max", http_connections_max, "HTTP connections",
     "a new one gets `503` and is closed; beyond twice as many it is closed at once"},
    {Limit::HttpHeaderBytes, "http_header_bytes_max", http_header_bytes_max, "header of an HTTP request",
     "`431`, and closed"},
    {Limit::HttpRequestTimeout, "http_request_timeout_s", seconds(http_request_timeout),
     "for an HTTP request to arrive completely, and for its answer to be received", "closed"},
};

} // namespace

std::span<const LimitRow> limit_table() {
    return table;
}

std::string limit_list() {
    std::string text = "| name | default | bounds | at the bound |\n|---|---|---|---|\n";
    for (const LimitRow& row : table) {
        text += "| `" + std::string{row.name} + "` | " + std::to_string(row.value) + " | " + std::string{row.of} +
                " | " + std::string{row.then} + " |\n";
    }
    return text;
}

v1::Limits limits_message(const SessionBounds& bounds) {
    v1::Limits limits;
    for (const LimitRow& row : table) {
        const auto* field = v1::Limits::descriptor()->FindFieldByName(std::string{row.name});
        EVOD_ASSERT(field != nullptr);
        const auto& in = *v1::Limits::GetReflection();
        if (field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_DOUBLE) {
            in.SetDouble(&limits, field, static_cast<double>(row.value));
        } else if (field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_UINT64) {
            in.SetUInt64(&limits, field, row.value);
        } else {
            in.SetUInt32(&limits, field, static_cast<std::uint32_t>(row.value));
        }
    }
    limits.set_sessions_max(bounds.sessions_max);
    limits.set_sessions_per_address_max(bounds.sessions_per_address_max);
    return limits;
}

} // namespace evod::network
