#include "client/core/actor.h"

namespace evod::core {

std::string to_text(const v1::Actor& actor) {
    switch (actor.kind()) {
    case v1::ACTOR_KIND_SCHEDULE:
        return "the schedule";
    case v1::ACTOR_KIND_GOAL:
        return "a goal";
    case v1::ACTOR_KIND_SERVER:
        return "evod";
    default:
        break;
    }
    std::string text = actor.user();
    if (!actor.client().empty()) {
        text += (text.empty() ? "" : ": ") + actor.client();
    }
    if (!actor.address().empty()) {
        text += " " + actor.address();
    }
    return text.empty() ? "a local client" : text;
}

} // namespace evod::core
