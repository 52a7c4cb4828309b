#include "server/network/limits.h"

#include "proto/codec/framing.h"
#include "proto/codec/tiles.h"
#include "server/base/assert.h"
#include "server/base/quota.h"
#include "server/classes/class.h"
#include "server/protocol/breeding.h"
#include "server/protocol/commands.h"
#include "server/protocol/queries.h"
#include "server/runtime/export_job.h"
#include "server/runtime/mailbox.h"
#include "server/runtime/outbox.h"
#include "server/simulation/world.h"
#include "server/simulation/world_name.h"

#include <google/protobuf/descriptor.h>

namespace evod::network {
namespace {

constexpr std::uint64_t seconds(std::chrono::milliseconds duration) {
    return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::seconds>(duration).count());
}

constexpr bool shared = true;

constexpr LimitRow table[] = {
    {Limit::HelloFrameBytes, "hello_frame_bytes_max", *codec::hello_limits.control_bytes_max,
     "bytes in the body of a client's first frame",
     "the server sends a Goodbye and closes the session; it allocates memory only for bytes that have arrived"},
    {Limit::ControlFrameBytes, "control_frame_bytes_max", *codec::server_limits.control_bytes_max,
     "bytes in the body of each later frame of a client; 65,536 for the roles viewer and controller",
     "the server sends a Goodbye and closes the session"},
    {Limit::MessageDepth, "message_depth_max", codec::message_depth_max, "nesting depth of a message",
     "the server refuses the message with `INVALID_ARGUMENT` and `request_id` 0; after a first message it sends a "
     "Goodbye and closes the session"},
    {Limit::HelloTimeout, "hello_timeout_s", seconds(hello_timeout),
     "seconds from connecting until the Hello arrives, including the TLS handshake",
     "the server sends a Goodbye, unless the TLS handshake is incomplete, and closes the session"},
    {Limit::FrameTimeout, "frame_timeout_s", seconds(frame_timeout),
     "seconds from the first to the last byte of a frame", "the server sends a Goodbye and closes the session"},
    {Limit::StalledTimeout, "stalled_timeout_s", seconds(stalled_timeout),
     "seconds in which a client receives none of the data that waits for it", "the server closes the session"},
    {Limit::AnswersTimeout, "answers_timeout_s", seconds(answers_timeout),
     "seconds in which a client that has closed its sending side receives pending answers",
     "the server closes the session"},
    {Limit::Sessions, "sessions_max", LimitOptions{}.sessions_max, "sessions; option `--sessions-max`",
     "the server sends the new session a Goodbye and closes it; if only other users hold more, the one with the most "
     "loses its oldest session without a command under way",
     shared},
    {Limit::Newcomers, "newcomers_max", newcomers_max, "connections whose Hello has not arrived",
     "the server sends a Goodbye to the oldest of them, of the same address if it holds half, otherwise of the address "
     "with the most",
     shared},
    {Limit::RequestsPerSecond, "requests_per_s_max", requests_per_s_max,
     "average number of frames per second from a session, including invalid ones; each further 64 bytes of a frame, "
     "each 1,024 bytes of its answer, and each island whose snapshot it asks for count as one more frame",
     "rate limit: the server pauses reading from the session; it refuses nothing"},
    {Limit::RequestBurst, "request_burst_max", request_burst_max,
     "frames that a session may send at once, counted in the same way", "as for `requests_per_s_max`"},
    {Limit::RequestsInFlight, "requests_in_flight_max", requests_in_flight_max, "unanswered requests of a session",
     "the server refuses the request with `RESOURCE_EXHAUSTED`; wait for an answer"},
    {Limit::MailboxCommands, "mailbox_commands_max", runtime::mailbox_commands_max,
     "requests of all sessions that wait for the simulation",
     "the server refuses the request with `RESOURCE_EXHAUSTED`; try again", shared},
    {Limit::Subscriptions, "subscriptions_max", subscriptions_max, "subscriptions of a session",
     "the server refuses the request with `RESOURCE_EXHAUSTED`"},
    {Limit::WatchedIslands, "watched_islands_max", watched_islands_max,
     "islands in all snapshot subscriptions of a session together",
     "the server refuses the request with `RESOURCE_EXHAUSTED`"},
    {Limit::SnapshotRate, "snapshot_rate_hz_max", static_cast<std::uint64_t>(snapshot_rate_hz_max),
     "snapshots per second of a subscription",
     "the server lowers the rate to this limit; its answer contains the new rate"},
    {Limit::Tiles, "tiles_max", codec::tiles_max, "tiles of an island", "the server uses larger tiles"},
    {Limit::Worlds, "worlds_max", LimitOptions{}.worlds_max, "worlds, without replays; option `--worlds-max`",
     "the server refuses the request with `RESOURCE_EXHAUSTED`"},
    {Limit::PlannedChanges, "planned_changes_max", parameters::planned_changes_max,
     "planned changes of a world that are not due yet", "the server refuses the request with `RESOURCE_EXHAUSTED`"},
    {Limit::PlaceEntries, "place_entries_max", simulation::place_entries_max,
     "items and organisms in one Place or Remove", "the server refuses the request with `INVALID_ARGUMENT`"},
    {Limit::Placed, "placed_max", simulation::placed_max,
     "food items, poison items and organisms, counted separately, that are placed on an island in one generation",
     "the server refuses the request with `RESOURCE_EXHAUSTED`"},
    {Limit::Replays, "replays_max", LimitOptions{}.replays_max, "replays of all sessions; option `--replays-max`",
     "the server refuses the request with `RESOURCE_EXHAUSTED`; if only other users hold more, it closes the oldest "
     "replay of the one with the most and reports it with `world_deleted`",
     shared},
    {Limit::Lease, "lease_s", seconds(lease_time),
     "seconds that a lease lasts after the last RunUntilTick or RenewLease", "the lease ends, and the world continues"},
    {Limit::Exports, "exports_max", exports_max, "running exports of all sessions",
     "the server refuses the request with `RESOURCE_EXHAUSTED`; if only other users hold more, it cancels the oldest "
     "export of the one with the most",
     shared},
    {Limit::ExportPatience, "export_patience_s", seconds(runtime::ExportJob::patience),
     "seconds from one part of an export until the client requests the next", "the server cancels the export"},
    {Limit::RunningBreedings, "breedings_max", breedings_max, "GetBreeding that run at once",
     "further ones wait, and users are served in turn. Above 64 that wait for one user, the server refuses the request "
     "with `RESOURCE_EXHAUSTED`",
     shared},
    {Limit::WorldNameBytes, "world_name_bytes_max", simulation::world_name_bytes_max,
     "bytes in the name of a new world", "the server refuses the request with `INVALID_ARGUMENT`"},
    {Limit::ClientKeyBytes, "client_key_bytes_max", protocol::client_key_bytes_max, "bytes in a `client_key`",
     "the server refuses the request with `INVALID_ARGUMENT`"},
    {Limit::CachedAnswers, "answers_cached_max", answers_cached_max, "cached answers of each `client_key`",
     "the server evicts the oldest answer; if the client repeats that command, the server refuses it with "
     "`FAILED_PRECONDITION`"},
    {Limit::ClientKeys, "client_keys_max", client_keys_max,
     "keys with cached answers; all cached answers together have at most 64 MiB",
     "the server evicts keys of the user who has the most: keys with a single command first, then the least recently "
     "used keys. It remembers the highest `request_id` of the last 100,000 evicted keys, and refuses their commands up "
     "to that id with `FAILED_PRECONDITION`",
     shared},
    {Limit::HistoryGenerationsKept, "history_generations_kept", simulation::history_generations_kept,
     "generations per world whose statistics the server keeps; with more than 13 islands, as many as fit into 131,072 "
     "rows",
     "the server drops the oldest generation"},
    {Limit::HistoryGenerations, "history_generations_max", protocol::history_statistics_max,
     "`GenerationStatistics` in a `History`; one whole generation is always allowed",
     "the server shortens the answer; `next_generation` states where to continue"},
    {Limit::BreedingRows, "breeding_rows_max", protocol::breeding_rows_max, "rows in each list of a `Breeding`",
     "the server shortens the lists; request the next rows"},
    {Limit::PopulationRows, "population_rows_max", protocol::population_rows_max, "organisms in a `Population`",
     "the server shortens the answer; request the next organisms"},
    {Limit::ClientBufferBytes, "client_buffer_bytes_max", client_buffer_bytes_max,
     "bytes of memory for all sessions: data to send, requests and exports, subscriptions and snapshots, "
     "replays, incomplete frames",
     "the server closes the largest sessions of the user that uses the most memory; it "
     "does so, too, if a user uses more than half",
     shared},
    {Limit::QueuedResponseBytes, "queued_response_bytes_max", queued_response_bytes_max,
     "bytes of answers that a session has not read", "the server closes the session"},
    {Limit::QueuedEventBytes, "queued_event_bytes_max", queued_event_bytes_max,
     "bytes of events that a session has not read",
     "the server drops further events and reports their number in `EventsDropped`"},
    {Limit::OutboxEvents, "waiting_events_max", runtime::outbox_events_max,
     "events of all worlds that wait between simulation and network",
     "the server drops further events and reports their number in `EventsDropped`. At most half may be of replays, and "
     "half of these of one user's replays; their drops are reported to this user only"},
    {Limit::HttpConnections, "http_connections_max", http_connections_max,
     "open HTTP connections; a WebSocket counts as a session instead",
     "the server closes the oldest connection that waits for a request, of the same address if it holds half, "
     "otherwise of the address with the most. If none waits, it closes the oldest connection of an address that has "
     "clearly more, or answers the new one with `503`; from twice as many connections it closes new ones at once",
     shared},
    {Limit::HttpHeaderBytes, "http_header_bytes_max", http_header_bytes_max, "bytes in the header of an HTTP request",
     "the server answers with `431` and closes the connection"},
    {Limit::HttpRequestTimeout, "http_request_timeout_s", seconds(http_request_timeout),
     "seconds until an HTTP request has arrived, and again until its answer is sent",
     "the server closes the connection"},
    {Limit::Classes, "classes_max", classes::classes_max, "classes",
     "the server refuses the request with `RESOURCE_EXHAUSTED`; delete a class first"},
    {Limit::ClassMembers, "class_members_max", classes::members_max, "members of a class, with those who were removed",
     "the server refuses the request, or sends a Goodbye, with `RESOURCE_EXHAUSTED`"},
    {Limit::MemberSessions, "member_sessions_max", classes::member_sessions_max, "sessions of a member of a class",
     "the server sends the oldest of them a Goodbye and closes it"},
    {Limit::WrongCodes, "wrong_codes_per_s_max", static_cast<std::uint64_t>(wrong_codes_per_s),
     "wrong codes per second in a `join`, of all clients together, after the first 50; a right code is always admitted",
     "the server sends a Goodbye with `RESOURCE_EXHAUSTED` and closes the session; the teachers' pages show a warning"},
};

} // namespace

std::span<const LimitRow> limit_table() {
    return table;
}

std::string limit_list() {
    std::string text =
        "| name | default | of one user | what is limited | when the limit is reached |\n|---|---|---|---|---|\n";
    for (const LimitRow& row : table) {
        text += "| `" + std::string{row.name} + "` | " + std::to_string(row.value) + " | " +
                (row.is_shared ? std::to_string(base::Quota{row.value}.share()) : "") + " | " +
                std::string{row.limited} + " | " + std::string{row.effect} + " |\n";
    }
    return text;
}

v1::Limits limits_message(const LimitOptions& options) {
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
    limits.set_sessions_max(options.sessions_max);
    limits.set_worlds_max(options.worlds_max);
    limits.set_replays_max(options.replays_max);
    return limits;
}

} // namespace evod::network
