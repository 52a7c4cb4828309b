// Limits: every bound of the network in one table, how clients are told of them, and how often each was met.
//
// Threads      the table never changes. Counters are raised and read by any thread.
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

// What they are about and what happens beyond them is said in the table below, in limits.cpp.
constexpr std::uint32_t requests_in_flight_max = 32;
constexpr std::uint32_t subscriptions_max = 32;
constexpr std::size_t watched_islands_max = 16'384; // four times the islands of the largest world
constexpr double snapshot_rate_hz_max = 120;
constexpr double snapshot_rate_hz_min = 1e-6; // slower ones are raised to it: a clock's numbers have an end
constexpr std::uint32_t retries_kept = 1000;
constexpr std::uint32_t client_keys_max = 256;
constexpr std::uint32_t exports_max = 8;
constexpr std::chrono::seconds hello_timeout{5};
constexpr std::chrono::seconds frame_timeout{10};
constexpr std::chrono::seconds stalled_timeout{10};
constexpr std::chrono::seconds lease_time{5};
constexpr std::uint32_t requests_per_s_max = 50'000; // more than one client asks for that waits for each answer
constexpr std::uint32_t request_burst_max = 5'000;
// A long frame counts as several, for what it costs to read and to answer.
constexpr std::size_t bytes_per_turn = 64, answer_bytes_per_turn = 1 << 10;
constexpr std::uint32_t frame_bytes_max_below_admin = 64 << 10; // only an admin's CreateWorld may need more
constexpr std::size_t client_buffer_bytes_max = 256 << 20;
constexpr std::size_t queued_event_bytes_max = 1 << 20;
constexpr std::size_t queued_response_bytes_max = 16 << 20;
constexpr std::size_t http_connections_max = 16;
constexpr std::size_t http_header_bytes_max = 8 << 10;
constexpr std::chrono::seconds http_request_timeout{5};

/// Those that whoever starts a server may set.
struct SessionBounds {
    std::uint32_t sessions_max = 256;
    std::uint32_t sessions_per_address_max = 128; // so that no single machine takes all
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
    Pasts,
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
    std::string_view name; // of the field of v1::Limits that tells it
    std::uint64_t value;   // unless set otherwise
    std::string_view of;   // what is bounded
    std::string_view then; // what happens at the bound
};

/// A row for each Limit, in their order.
std::span<const LimitRow> limit_table();

/// The table as docs/OPERATIONS.md has it and `evod limits` prints it.
std::string limit_list();

/// The table as clients read it.
v1::Limits limits_message(const SessionBounds& bounds);

/// How often each limit was met since the server started.
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

// ---- not limits of a client: how the server goes about its connections --------------------------------------------

constexpr double stranger_lines_per_s = 1, stranger_lines_burst = 20; // of the log, about sessions without a hello

constexpr int unsent_bytes_max = 128 << 10; // in the kernel, so that a slow viewer gets new pictures and not old ones

// Whether somebody is still there is asked by TCP itself, whose answer a busy or patient client need not give: after so
// much silence, so often; and what was sent has to be taken by the other end within the last.
constexpr std::chrono::seconds silence_max{10}, probe_every{5};
constexpr int probes_max = 4;
constexpr std::chrono::milliseconds untaken_max{30'000};

// Of all retries together: the answers of the longest unused keys go first.
constexpr std::size_t retry_bytes_max = 64 << 20;
// Keys whose answers are gone, but not the highest request_id that they used.
constexpr std::size_t evicted_keys_max = 100'000;

constexpr std::chrono::milliseconds look_every{500}; // for a token file that has changed, and who is stalled
// Free memory is given back to the system: so often at most, and only after sessions have ended or so much was
// answered.
constexpr std::chrono::seconds trim_every{2};
constexpr std::uint64_t answered_to_trim_bytes = 1 << 20;
constexpr std::chrono::seconds farewell_timeout{1};    // for the last bytes of a session that ends
constexpr std::chrono::milliseconds accept_pause{100}; // when the system has no file descriptors left
constexpr std::uint64_t descriptors_kept = 32;         // of the system's, for files: an eighth, if it gives few
constexpr std::size_t farewells_max = 64; // connections that are told why they have no place; others are not

// Of HTTP.
constexpr std::chrono::seconds http_farewell_timeout{1}; // for the last bytes of a connection that ends
constexpr std::chrono::seconds simulation_patience{3};   // for the simulation thread to answer; then 503

} // namespace evod::network
