#include "server/base/actor.h"

namespace evod::base {

std::string to_text(const Actor& actor) {
    switch (actor.kind) {
    case Actor::Kind::Schedule:
        return "the schedule";
    case Actor::Kind::Server:
        return "evod";
    case Actor::Kind::Client:
        break;
    }
    return (actor.user.empty() ? "" : actor.user + ": ") + actor.program + " " + actor.address;
}

} // namespace evod::base
