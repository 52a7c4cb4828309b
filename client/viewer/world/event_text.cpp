#include "client/viewer/world/event_text.h"

#include "client/core/actor.h"

namespace evod::viewer {

namespace {

/// Returns the names of the items as a list: "a, b, c".
template <class Items, class NameOf>
std::string name_list(const Items& items, NameOf name_of) {
    std::string names;
    for (const auto& item : items) {
        names += (names.empty() ? "" : ", ") + name_of(item);
    }
    return names;
}

constexpr auto name_of_item = [](const auto& item) -> std::string { return item.name(); };

std::string planned_text(const evod::v1::Event& event) {
    const bool planned = event.has_change_planned();
    const auto& change = planned ? event.change_planned().change() : event.change_cancelled().change();
    return core::to_text(planned ? change.by() : event.change_cancelled().by()) +
           (planned ? " plans to change " : " cancelled the change of ") +
           name_list(change.parameters(), name_of_item) +
           (change.has_tick() ? " after tick " + std::to_string(change.tick())
                              : " from generation " + std::to_string(change.generation()));
}

/// Returns what a client has placed or removed: "placed 3 food, 1 organism on island 2".
template <class Entities>
std::string entities_text(const char* verb, const Entities& entities, bool several_islands) {
    std::string text;
    const auto add = [&](int count, const char* one, const char* many) {
        if (count > 0) {
            text += (text.empty() ? " " : ", ") + std::to_string(count) + " " + (count == 1 ? one : many);
        }
    };
    add(entities.food_size(), "food", "food");
    add(entities.poison_size(), "poison", "poison");
    add(entities.organisms_size(), "organism", "organisms");
    return core::to_text(entities.by()) + " " + verb + text +
           (several_islands ? " on island " + std::to_string(entities.island()) : "");
}

} // namespace

std::string event_text(const evod::v1::Event& event, bool several_islands) {
    switch (event.kind_case()) {
    case evod::v1::Event::kServerGoingAway:
        return "The server is shutting down";
    case evod::v1::Event::kWorldReset:
        return core::to_text(event.world_reset().by()) + " reset the world";
    case evod::v1::Event::kWorldDeleted:
        return core::to_text(event.world_deleted().by()) + " deleted the world " + event.world();
    case evod::v1::Event::kWorldDamaged:
        return "The world " + event.world() + " does not run: " + event.world_damaged().reason();
    case evod::v1::Event::kParametersChanged:
        return core::to_text(event.parameters_changed().by()) + " changed " +
               name_list(event.parameters_changed().changed(), name_of_item);
    case evod::v1::Event::kChangePlanned:
    case evod::v1::Event::kChangeCancelled:
        return planned_text(event);
    case evod::v1::Event::kChangeDropped:
        return "The change of " +
               name_list(event.change_dropped().name(), [](const std::string& name) { return name; }) + " that " +
               core::to_text(event.change_dropped().by()) +
               " planned was dropped, because it conflicts with the other parameters";
    case evod::v1::Event::kPlaced:
        return entities_text("placed", event.placed(), several_islands);
    case evod::v1::Event::kRemoved:
        return entities_text("removed", event.removed(), several_islands);
    default:
        return "";
    }
}

} // namespace evod::viewer
