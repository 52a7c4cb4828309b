#include "server/network/client_watch.h"

namespace evod::network {

bool ClientWatch::is_stalled(const std::optional<Transport::Progress>& sent, Duration watched) {
    if (!sent || sent != sent_) {
        sent_ = sent;
        stalled_ = {};
        return false;
    }
    stalled_ += watched;
    return stalled_ >= stalled_timeout;
}

ClientWatch::Silence ClientWatch::silence_after(Duration watched) {
    if (!silent_) {
        return Silence::Short;
    }
    const Duration before = *silent_;
    *silent_ += watched;
    if (before < websocket_ping_after && *silent_ >= websocket_ping_after) {
        return Silence::PingDue;
    }
    return *silent_ >= websocket_silence_max ? Silence::TooLong : Silence::Short;
}

} // namespace evod::network
