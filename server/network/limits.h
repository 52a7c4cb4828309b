// Limits: a table of all limits that apply to clients, the message from which clients read them, and a counter per
// limit.
//
// Threads      the table is constant. Any thread may increment or read a counter.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/simulation/laboratory.h"

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace evod::network {

// The table in limits.cpp describes each limit and what the server does when the limit is reached.
constexpr std::uint32_t requests_in_flight_max = 32;
constexpr std::uint32_t subscriptions_max = 128;
constexpr std::size_t watched_islands_max = 16'384; // four times the number of islands in the largest world
constexpr double snapshot_rate_hz_max = 120;
// The server raises lower rates to this rate, because the period of a much lower rate would overflow the clock.
constexpr double snapshot_rate_hz_min = 1e-6;
constexpr std::uint32_t answers_cached_max = 1000;
constexpr std::uint32_t client_keys_max = 256;
constexpr std::uint32_t exports_max = 8;
constexpr std::uint32_t breedings_max = 4;
constexpr std::size_t breedings_waiting_max = 64; // per user
constexpr std::chrono::seconds hello_timeout{5};
constexpr std::chrono::seconds frame_timeout{10};
constexpr std::chrono::seconds stalled_timeout{10};
constexpr std::chrono::seconds answers_timeout{3};
constexpr std::chrono::seconds lease_time{5};
constexpr std::uint32_t requests_per_s_max = 50'000; // a client that waits for each answer never reaches this rate
constexpr std::uint32_t request_burst_max = 5'000;
// For the rate limit, each further bytes_per_turn bytes of a frame, and each answer_bytes_per_turn bytes of its answer,
// count as one more frame.
constexpr std::size_t bytes_per_turn = 64, answer_bytes_per_turn = 1 << 10;
// Maximum body size for roles below admin. Only CreateWorld, which requires the role admin, needs longer frames.
constexpr std::uint32_t frame_bytes_max_below_admin = 64 << 10;
constexpr std::size_t client_buffer_bytes_max = 256 << 20;
constexpr std::size_t queued_event_bytes_max = 1 << 20;
constexpr std::size_t queued_response_bytes_max = 16 << 20;
constexpr std::size_t http_connections_max = 128; // a class behind one address, which gets half, loads the page at once
constexpr std::size_t http_header_bytes_max = 8 << 10;
constexpr std::chrono::seconds http_request_timeout{5};

constexpr std::uint32_t newcomers_max = 256;
constexpr double wrong_codes_per_s = 5, wrong_codes_burst = 50;

/// Limits that the options of the server can change.
struct LimitOptions {
    std::uint32_t sessions_max = 256;
    std::uint32_t worlds_max = simulation::worlds_max_by_default;
    std::uint32_t replays_max = 64;
};

enum class Limit : std::uint8_t {
    HelloFrameBytes,
    ControlFrameBytes,
    MessageDepth,
    HelloTimeout,
    FrameTimeout,
    StalledTimeout,
    AnswersTimeout,
    Sessions,
    Newcomers,
    RequestsPerSecond,
    RequestBurst,
    RequestsInFlight,
    MailboxCommands,
    Subscriptions,
    WatchedIslands,
    SnapshotRate,
    Tiles,
    Worlds,
    PlannedChanges,
    PlaceEntries,
    Placed,
    Replays,
    Lease,
    Exports,
    ExportPatience,
    RunningBreedings,
    WorldNameBytes,
    ClientKeyBytes,
    CachedAnswers,
    ClientKeys,
    HistoryGenerationsKept,
    HistoryGenerations,
    BreedingRows,
    PopulationRows,
    ClientBufferBytes,
    QueuedResponseBytes,
    QueuedEventBytes,
    OutboxEvents,
    HttpConnections,
    HttpHeaderBytes,
    HttpRequestTimeout,
    Classes,
    ClassMembers,
    MemberSessions,
    WrongCodes,
};

struct LimitRow {
    Limit limit;
    std::string_view name;    // name of the field in v1::Limits
    std::uint64_t value;      // default value
    std::string_view limited; // the limited quantity, in words
    std::string_view effect;  // what the server does when the limit is reached
    bool is_shared = false;   // all clients share it, and a user may hold at most half of it (base::Quota)
};

/// One row per Limit, in the order of the enum.
std::span<const LimitRow> limit_table();

/// Returns the table in Markdown, as `evod limits` prints it and docs/OPERATIONS.md contains it.
std::string limit_list();

/// The limits as the message that the server sends to clients.
v1::Limits limits_message(const LimitOptions& options);

/// Counts how often each limit was reached since the server started, and how often the holder of the most lost
/// something because another user wanted it.
class LimitCounters {
  public:
    static constexpr std::size_t limit_count = static_cast<std::size_t>(Limit::WrongCodes) + 1;

    void met(Limit limit, std::uint64_t times = 1) { add(met_, limit, times); }
    void took_back(Limit limit) { add(taken_back_, limit, 1); }
    std::uint64_t count(Limit limit) const { return met_[index(limit)].load(std::memory_order_relaxed); }
    std::uint64_t taken_back_count(Limit limit) const {
        return taken_back_[index(limit)].load(std::memory_order_relaxed);
    }

  private:
    using Counters = std::array<std::atomic<std::uint64_t>, limit_count>;
    static std::size_t index(Limit limit) { return static_cast<std::size_t>(limit); }
    static void add(Counters& counters, Limit limit, std::uint64_t times) {
        counters[index(limit)].fetch_add(times, std::memory_order_relaxed);
    }

    Counters met_{}, taken_back_{};
};

// ---- constants that tune connections but do not limit clients --------------------------------------------------

// Rate limit of log lines about the sessions of a user, and of those about all sessions that ended without a Hello.
constexpr double session_lines_per_s = 1, session_lines_burst = 20;
constexpr std::size_t log_users_max = 256;

// Maximum of unsent bytes in the kernel. It is small so that a slow viewer receives new snapshots instead of old ones.
constexpr int unsent_bytes_max = 128 << 10;

// TCP keepalive detects a peer whose machine no longer responds. The client program takes no part in it, so a busy or
// idle client stays connected. The first probe is sent after silence_max without data, further probes every
// probe_every. The peer must acknowledge sent data within untaken_max.
constexpr std::chrono::seconds silence_max{10}, probe_every{5};
constexpr int probes_max = 4;
constexpr std::chrono::milliseconds untaken_max{30'000};

// Frames of a WebSocket without content: pings, pongs, empty messages. A browser sends one per websocket_ping_after.
constexpr double empty_frames_per_s_max = 100, empty_frames_burst_max = 1000;
// The server sends a ping to the client of a WebSocket after this silence, and closes the session after that one.
// Proxies close connections on which nothing is sent.
constexpr std::chrono::seconds websocket_ping_after{10}, websocket_silence_max{30};

// Maximum size of all cached answers together.
constexpr std::size_t retry_bytes_max = 64 << 20;
// Number of evicted keys for which the cache remembers the highest request_id.
constexpr std::size_t evicted_keys_max = 100'000;

// Time between two checks of the token file and of stalled clients.
constexpr std::chrono::milliseconds housekeeping_interval{500};
// The server returns free memory to the system at most once per trim_every. It does so only after sessions have ended
// or after at least answered_to_trim_bytes of answers were sent.
constexpr std::chrono::seconds trim_every{2};
constexpr std::uint64_t answered_to_trim_bytes = 1 << 20;
constexpr std::chrono::seconds farewell_timeout{1}; // time to send the last bytes of a session
// The listener waits for this time after accept() has failed because no file descriptor was free.
constexpr std::chrono::milliseconds accept_pause{100};
// File descriptors reserved for run files. If the system allows only few, an eighth of them is reserved instead.
constexpr std::uint64_t descriptors_kept = 32;
// Number of connections that may receive a Goodbye at the same time.
constexpr std::size_t farewells_max = 64;

// Constants for HTTP.
constexpr std::chrono::seconds http_farewell_timeout{1}; // time to send the last bytes of a connection
// If the simulation thread does not respond within this time, /healthz answers 503.
constexpr std::chrono::seconds simulation_patience{3};

} // namespace evod::network
