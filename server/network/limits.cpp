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
     "body of a client's first frame", "told, and closed; no memory is taken for what a header declares"},
    {Limit::ControlFrameBytes, "control_frame_bytes_max", *codec::server_limits.control_bytes_max,
     "body of a later frame of a client; 65,536 below the role admin", "the same"},
    {Limit::MessageDepth, "message_depth_max", codec::message_depth_max, "messages within messages",
     "refused, `INVALID_ARGUMENT`, with `request_id` 0; in a first frame also closed"},
    {Limit::HelloTimeout, "hello_timeout_s", seconds(hello_timeout), "from connecting to a hello, TLS included",
     "told, unless TLS has not begun, and closed"},
    {Limit::FrameTimeout, "frame_timeout_s", seconds(frame_timeout), "from the first byte of a frame to its last",
     "told, and closed"},
    {Limit::StalledTimeout, "stalled_timeout_s", seconds(stalled_timeout),
     "a client's machine takes nothing of what waits for it", "closed"},
    {Limit::Sessions, "sessions_max", SessionBounds{}.sessions_max, "sessions; `--sessions-max`",
     "the first that has not said hello is told, and closed; if all have, the new one. Where 64 are being told, it is "
     "closed at once"},
    {Limit::SessionsPerAddress, "sessions_per_address_max", SessionBounds{}.sessions_per_address_max,
     "sessions from one address, of IPv6 from one /64; `--sessions-per-address-max`",
     "the same, among those of the address"},
    {Limit::RequestsPerSecond, "requests_per_s_max", requests_per_s_max,
     "frames of a session a second in the long run, damaged ones too; each 64 bytes of one and each 1,024 bytes of its "
     "answer count as another",
     "no more is read until it is time: nothing is refused"},
    {Limit::RequestBurst, "request_burst_max", request_burst_max, "the same, at once", "the same"},
    {Limit::RequestsInFlight, "requests_in_flight_max", requests_in_flight_max, "unanswered requests of a session",
     "refused, `RESOURCE_EXHAUSTED`: wait for an answer"},
    {Limit::MailboxCommands, "mailbox_commands_max", runtime::mailbox_commands_max,
     "requests of all sessions waiting for the simulation", "refused, `RESOURCE_EXHAUSTED`: try again"},
    {Limit::Subscriptions, "subscriptions_max", subscriptions_max, "subscriptions of a session",
     "refused, `RESOURCE_EXHAUSTED`"},
    {Limit::WatchedIslands, "watched_islands_max", watched_islands_max,
     "islands in all snapshot subscriptions of a session together", "refused, `RESOURCE_EXHAUSTED`"},
    {Limit::SnapshotRate, "snapshot_rate_hz_max", static_cast<std::uint64_t>(snapshot_rate_hz_max),
     "pictures a second of a subscription", "lowered to it, and the answer says so"},
    {Limit::Tiles, "tiles_max", codec::tiles_max, "tiles of an island", "tiles are larger"},
    {Limit::Worlds, "worlds_max", simulation::worlds_max, "worlds", "refused, `RESOURCE_EXHAUSTED`"},
    {Limit::PlannedChanges, "planned_changes_max", parameters::planned_changes_max, "changes planned in a world",
     "refused, `RESOURCE_EXHAUSTED`"},
    {Limit::Pasts, "replays_max", runtime::Replays::replays_max, "worlds of a session that show the past",
     "refused, `RESOURCE_EXHAUSTED`; so too beyond 64 of all sessions"},
    {Limit::Lease, "lease_s", seconds(lease_time), "a world is lent to who steps it, from the last step", "it goes on"},
    {Limit::Exports, "exports_max", exports_max, "exports under way, of all sessions", "refused, `RESOURCE_EXHAUSTED`"},
    {Limit::ExportPatience, "export_patience_s", seconds(runtime::ExportJob::patience),
     "until the next part of an export is asked for", "the export is given up"},
    {Limit::WorldNameBytes, "world_name_bytes_max", simulation::world_name_bytes_max, "a new world's name",
     "refused, `INVALID_ARGUMENT`"},
    {Limit::ClientKeyBytes, "client_key_bytes_max", protocol::client_key_bytes_max, "a `client_key`",
     "refused, `INVALID_ARGUMENT`"},
    {Limit::RetriesKept, "retries_kept", retries_kept, "answers kept of each `client_key`, for retries",
     "an older request is refused, `FAILED_PRECONDITION`"},
    {Limit::ClientKeys, "client_keys_max", client_keys_max, "keys whose answers are kept; 64 MiB in all",
     "those of a key that sent a single command go first, then those of the key longest unused; its requests up to the "
     "highest id it used are then refused, `FAILED_PRECONDITION`, until 100,000 further keys have gone"},
    {Limit::HistoryGenerationsKept, "history_generations_kept", simulation::World::history_generations_kept,
     "generations of statistics kept of each world; with more than 13 islands as many as come to 131,072 rows",
     "the oldest are forgotten; a `History` begins after them"},
    {Limit::HistoryGenerations, "history_generations_max", protocol::history_statistics_max,
     "`GenerationStatistics` in a `History`, but one generation at least", "cut, and the answer says where to go on"},
    {Limit::BreedingRows, "breeding_rows_max", protocol::breeding_rows_max, "rows of each list of a `Breeding`",
     "cut; who asks says where the next answer begins"},
    {Limit::PopulationRows, "population_rows_max", protocol::population_rows_max, "organisms in a `Population`",
     "cut: ask again from the next organism"},
    {Limit::ClientBufferBytes, "client_buffer_bytes_max", client_buffer_bytes_max,
     "what waits or is got together for all clients, and what they have sent of frames that are not whole",
     "the sessions with the most are closed"},
    {Limit::QueuedResponseBytes, "queued_response_bytes_max", queued_response_bytes_max,
     "answers that a session has not read", "closed"},
    {Limit::QueuedEventBytes, "queued_event_bytes_max", queued_event_bytes_max, "events that a session has not read",
     "the next are dropped, and `EventsDropped` tells how many"},
    {Limit::OutboxEvents, "waiting_events_max", runtime::outbox_events_max,
     "events of all worlds on their way from the simulation", "the same, for all"},
    {Limit::HttpConnections, "http_connections_max", http_connections_max, "connections by HTTP",
     "a new one is told, `503`, and closed; with as many again it is closed at once"},
    {Limit::HttpHeaderBytes, "http_header_bytes_max", http_header_bytes_max, "header of a request by HTTP",
     "told, `431`, and closed"},
    {Limit::HttpRequestTimeout, "http_request_timeout_s", seconds(http_request_timeout),
     "for a request by HTTP to come whole, and for its answer to be taken", "closed"},
};

} // namespace

std::span<const LimitRow> limit_table() {
    return table;
}

std::string limit_list() {
    std::string text = "| name | default | of what | what happens |\n|---|---|---|---|\n";
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
