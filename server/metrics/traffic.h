// Traffic: what goes over the sessions of a server.
//
// Threads      counted on the network thread.
#pragma once

#include "server/metrics/counters.h"

namespace evod::metrics {

struct Traffic {
    Counter connections;                                           // that came
    Counter requests;                                              // that could be read, those refused too
    Counter received_bytes, sent_control_bytes, sent_stream_bytes; // without what TLS adds
    Counter pictures_sent;                                         // to somebody, of one island
    Counter pictures_dropped;                                      // for somebody: replaced by newer ones
    Counter events_dropped;                                        // for somebody
};

} // namespace evod::metrics
