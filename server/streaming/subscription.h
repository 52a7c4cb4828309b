// Subscription: the part of a world that one session wants to receive, and the record of the snapshots sent to it.
//
// Owner        the session's SnapshotQueue.
// Threads      the network thread.
#pragma once

#include "evod/v1/commands.pb.h"
#include "evod/v1/stream.pb.h"
#include "server/runtime/clock.h"
#include "server/streaming/bandwidth.h"
#include "server/streaming/delta_stream.h"
#include "server/streaming/quantise.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace evod::streaming {

struct SnapshotSubscription {
    std::string world;
    std::optional<std::uint32_t> island; // index of the island; nullopt: all islands
    std::uint32_t island_count = 1;      // number of subscribed islands when the subscription began
    double rate_hz = 1;
    // 0 if a snapshot for the subscription existed when it began. Otherwise a number that is higher for later
    // subscriptions.
    std::uint64_t newcomer = 0;
    std::uint64_t dropped_count = 0;
    runtime::Clock::time_point keyframes_from; // requested keyframes are sent at this time or later
    v1::Codec codec = v1::CODEC_PLAIN;
    v1::Compression compression = v1::COMPRESSION_NONE;
    // Limit of unacknowledged snapshots of one island; nullopt: no limit.
    std::optional<std::uint32_t> unacknowledged_max;
    OptionalColumns with;               // what snapshots contain in addition
    std::optional<v1::View> view;       // CODEC_DELTA only: snapshots are sent in tiles
    std::optional<Bandwidth> bandwidth; // the bandwidth limit of the view

    void set_view(const v1::View& wanted);
    Form form() const;

    struct Island {
        StreamedSnapshotPtr waiting;           // the newest snapshot, until it is sent in the wanted detail
        std::optional<v1::Detail> shown;       // detail in which `waiting` was sent; nullopt: it was not sent
        runtime::Clock::time_point not_before; // the snapshot waits until this time
        SentState sent;                        // decides which tiles of the next snapshot can be deltas
        // Sequences in rising order; empty without unacknowledged_max. A vector, because an empty one needs no memory.
        std::vector<std::uint64_t> unacknowledged;
        // Number of its turn to be sent; 0: nothing waits, or it waits for an acknowledgement.
        std::uint64_t turn = 0;
    };
    std::map<std::uint32_t, Island> islands; // key: index of the island
};

/// Converts a valid request into a subscription.
///
/// world         name of the world.
/// island_count  number of islands of that world.
/// rate_hz       rate within the limits of the server.
SnapshotSubscription to_subscription(const v1::SubscribeSnapshots& request, const std::string& world,
                                     std::uint32_t island_count, double rate_hz);

} // namespace evod::streaming
