// Limits: all bounds of the network in one table, with the message that clients read and a counter for each.
//
// Threads      the table is constant. Any thread may raise and read a counter.
#pragma once

#include "evod/v1/commands.pb.h"

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace evod::network {

// The table in limits.cpp says what each bounds and what happens at the bound.
constexpr std::uint32_t requests_in_flight_max = 32;
constexpr std::uint32_t subscriptions_max = 32;
constexpr std::size_t watched_islands_max = 16'384; // four times the islands of the largest world
constexpr double snapshot_rate_hz_max = 120;
constexpr double snapshot_rate_hz_min = 1e-6; // slower rates are raised to it, since a clock overflows at the period
constexpr std::uint32_t retries_kept = 1000;
constexpr std::uint32_t client_keys_max = 256;
constexpr std::uint32_t exports_max = 8;
constexpr std::chrono::seconds hello_timeout{5};
constexpr std::chrono::seconds frame_timeout{10};
constexpr std::chrono::seconds stalled_timeout{10};
constexpr std::chrono::seconds lease_time{5};
constexpr std::uint32_t requests_per_s_max = 50'000; // more than a client reaches that waits for each answer
constexpr std::uint32_t request_burst_max = 5'000;
// A long frame counts as several, in proportion to the cost of reading and answering it.
constexpr std::size_t bytes_per_turn = 64, answer_bytes_per_turn = 1 << 10;
constexpr std::uint32_t frame_bytes_max_below_admin = 64 << 10; // only CreateWorld, which needs admin, may be longer
constexpr std::size_t client_buffer_bytes_max = 256 << 20;
constexpr std::size_t queued_event_bytes_max = 1 << 20;
constexpr std::size_t queued_response_bytes_max = 16 << 20;
constexpr std::size_t http_connections_max = 16;
constexpr std::size_t http_header_bytes_max = 8 << 10;
constexpr std::chrono::seconds http_request_timeout{5};

/// The bounds that the options of the server set.
struct SessionBounds {
    std::uint32_t sessions_max = 256;
    std::uint32_t sessions_per_address_max = 128; // leaves sessions for other machines
};

enum class Limit : std::uint8_t {
    HelloFrameBytes,
    ControlFrameBytes,
    MessageDepth,
    HelloTimeout,
    FrameTimeout,
    StalledTimeout,
    Sessions,
    SessionsPerAddress,
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
    Replays,
    Lease,
    Exports,
    ExportPatience,
    WorldNameBytes,
    ClientKeyBytes,
    RetriesKept,
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
};

struct LimitRow {
    Limit limit;
    std::string_view name; // the field of v1::Limits
    std::uint64_t value;   // the default
    std::string_view of;   // what is bounded
    std::string_view then; // what happens at the bound
};

/// One row per Limit, in the order of the enum.
std::span<const LimitRow> limit_table();

/// The table as docs/OPERATIONS.md contains it and `evod limits` prints it.
std::string limit_list();

/// The table as the message that clients read.
v1::Limits limits_message(const SessionBounds& bounds);

/// How often each limit was reached since the server started.
class LimitCounters {
  public:
    static constexpr std::size_t limit_count = static_cast<std::size_t>(Limit::HttpRequestTimeout) + 1;

    void met(Limit limit, std::uint64_t times = 1) { of(limit).fetch_add(times, std::memory_order_relaxed); }
    std::uint64_t count(Limit limit) const {
        return counters_[static_cast<std::size_t>(limit)].load(std::memory_order_relaxed);
    }

  private:
    std::atomic<std::uint64_t>& of(Limit limit) { return counters_[static_cast<std::size_t>(limit)]; }
    std::array<std::atomic<std::uint64_t>, limit_count> counters_{};
};

// ---- tuning of connections, not limits of a client -------------------------------------------------------------

// log lines about sessions that ended without a Hello
constexpr double ungreeted_lines_per_s = 1, ungreeted_lines_burst = 20;

// in the kernel; small, so that a slow viewer receives new snapshots instead of old ones
constexpr int unsent_bytes_max = 128 << 10;

// TCP keepalive finds dead peers; the client program need not react, so a busy or idle client stays connected. The
// first probe follows silence_max, further ones every probe_every. Sent data must be acknowledged within untaken_max.
constexpr std::chrono::seconds silence_max{10}, probe_every{5};
constexpr int probes_max = 4;
constexpr std::chrono::milliseconds untaken_max{30'000};

// The bytes of all cached answers together; the least recently used keys are evicted first.
constexpr std::size_t retry_bytes_max = 64 << 20;
// Evicted keys for which the highest request_id is remembered.
constexpr std::size_t evicted_keys_max = 100'000;

// between checks of the token file and of stalled clients
constexpr std::chrono::milliseconds housekeeping_interval{500};
// The server returns free memory to the system at most so often, and only after sessions have ended or so many bytes
// were answered.
constexpr std::chrono::seconds trim_every{2};
constexpr std::uint64_t answered_to_trim_bytes = 1 << 20;
constexpr std::chrono::seconds farewell_timeout{1};    // for the last bytes of a session that ends
constexpr std::chrono::milliseconds accept_pause{100}; // after accept() failed for want of file descriptors
// reserved for run files; an eighth of all descriptors if the system allows few
constexpr std::uint64_t descriptors_kept = 32;
// refused connections that receive a Goodbye at the same time; others are closed without one
constexpr std::size_t farewells_max = 64;

// HTTP.
constexpr std::chrono::seconds http_farewell_timeout{1}; // for the last bytes of a connection that ends
// for the simulation thread to respond; then /healthz answers 503
constexpr std::chrono::seconds simulation_patience{3};

} // namespace evod::network
