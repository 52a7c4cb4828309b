// Traffic: counters for all sessions of a server together.
//
// Threads      the network thread increments them.
#pragma once

#include "server/metrics/counters.h"

namespace evod::metrics {

struct Traffic {
    Counter connections; // accepted connections
    Counter websockets;  // connections of browsers among them
    Counter requests;    // readable requests, including those that were refused
    Counter received_bytes, sent_control_bytes, sent_stream_bytes; // without the overhead of TLS
    Counter snapshots_sent;                                        // counted per island and subscription
    Counter snapshots_dropped; // snapshots that newer ones replaced before they were sent
    Counter events_dropped;    // events that were not sent because a session was too slow
    Counter http_refused_hosts, http_refused_origins, http_refused_tokens; // HTTP requests with another Host, ...
};

} // namespace evod::metrics
