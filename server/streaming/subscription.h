// Subscription: what one session wants to see of one world, and what it has been sent of it.
//
// Owner        the session's SnapshotQueue.
// Threads      the network thread.
#pragma once

#include "evod/v1/commands.pb.h"
#include "evod/v1/stream.pb.h"
#include "server/runtime/clock.h"
#include "server/streaming/bandwidth.h"
#include "server/streaming/delta_stream.h"

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

namespace evod::streaming {

struct SnapshotSubscription {
    std::string world;
    std::optional<std::uint32_t> island; // nullopt: all
    std::uint32_t island_count = 1;      // number of subscribed islands at the start
    double rate_hz = 1;
    std::uint64_t newcomer = 0; // its number among the subscriptions of the server that began without a snapshot
    std::uint64_t dropped_count = 0;
    v1::Codec codec = v1::CODEC_PLAIN;
    v1::Compression compression = v1::COMPRESSION_NONE;
    std::optional<std::uint32_t> unacknowledged_max; // snapshots of one island in flight; nullopt: any number
    std::optional<v1::View> view;                    // CODEC_DELTA: snapshots are sent in tiles
    std::optional<Bandwidth> bandwidth;              // of view

    void set_view(const v1::View& wanted);
    Form form() const;

    struct Island {
        StreamedSnapshotPtr waiting;              // the newest, if it has not been sent, or not in the wanted detail
        std::optional<v1::Detail> shown;          // the detail in which `waiting` was sent; nullopt: it was not sent
        runtime::Clock::time_point not_before;    // the bandwidth limit delays it until then
        SentState sent;                           // what the next snapshot can be encoded against
        std::deque<std::uint64_t> unacknowledged; // sequences, rising; empty without unacknowledged_max
        std::uint64_t turn = 0;                   // number of its turn to be sent; 0: it waits for an acknowledgement
    };
    std::map<std::uint32_t, Island> islands; // by index
};

/// The subscription that a valid request describes.
///
/// world         name of the world.
/// island_count  of that world.
/// rate_hz       within the server's limits.
SnapshotSubscription to_subscription(const v1::SubscribeSnapshots& request, const std::string& world,
                                     std::uint32_t island_count, double rate_hz);

} // namespace evod::streaming
