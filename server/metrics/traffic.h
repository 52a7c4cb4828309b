// Traffic: counters of all sessions of a server.
//
// Threads      counted on the network thread.
#pragma once

#include "server/metrics/counters.h"

namespace evod::metrics {

struct Traffic {
    Counter connections;                                           // accepted connections
    Counter requests;                                              // readable requests, including refused ones
    Counter received_bytes, sent_control_bytes, sent_stream_bytes; // without the overhead of TLS
    Counter snapshots_sent;                                        // of one island to one subscription
    Counter snapshots_dropped;                                     // replaced by newer ones before they were sent
    Counter events_dropped;                                        // not sent to a session, because it was too slow
};

} // namespace evod::metrics
