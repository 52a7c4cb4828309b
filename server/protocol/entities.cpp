#include "server/protocol/entities.h"

#include "server/protocol/commands.h"

#include <algorithm>
#include <string>

namespace evod::protocol {
namespace {

using simulation::place_entries_max;
using Violations = std::vector<base::Violation>;

/// Returns whether a request has an allowed number of entries; otherwise adds a violation.
bool has_entries(const char* field, std::size_t count, Violations& violations) {
    if (count >= 1 && count <= place_entries_max) {
        return true;
    }
    violations.push_back(
        {field, "1 to " + std::to_string(place_entries_max) + " items and organisms", std::to_string(count)});
    return false;
}

template <class Message>
Message message_of(const simulation::EntityIds& ids) {
    Message message;
    message.set_island(ids.island);
    message.set_generation(ids.generation);
    message.mutable_food()->Assign(ids.food.begin(), ids.food.end());
    message.mutable_poison()->Assign(ids.poison.begin(), ids.poison.end());
    message.mutable_organisms()->Assign(ids.organisms.begin(), ids.organisms.end());
    return message;
}

} // namespace

simulation::PlaceEntities command_of(const v1::Place& request, Violations& violations) {
    simulation::PlaceEntities command{.world = lookup_name(request.world()), .island = request.island()};
    const auto count =
        static_cast<std::size_t>(request.items_size()) + static_cast<std::size_t>(request.organisms_size());
    if (!has_entries("place.items", count, violations)) {
        return command;
    }
    for (int i = 0; i < request.items_size(); ++i) {
        const v1::PlacedItem& item = request.items(i);
        if (item.kind() != v1::ITEM_KIND_FOOD && item.kind() != v1::ITEM_KIND_POISON) {
            violations.push_back({"place.items[" + std::to_string(i) + "].kind",
                                  "ITEM_KIND_FOOD (1) or ITEM_KIND_POISON (2)", std::to_string(item.kind())});
        }
        const auto kind =
            item.kind() == v1::ITEM_KIND_POISON ? simulation::ItemKind::Poison : simulation::ItemKind::Food;
        command.items.push_back({kind, item.x_px(), item.y_px()});
    }
    for (int i = 0; i < request.organisms_size(); ++i) {
        const v1::PlacedOrganism& organism = request.organisms(i);
        command.organisms.push_back(simulation::PlaceEntities::Organism{
            organism.x_px(), organism.y_px(), {organism.genes().begin(), organism.genes().end()}});
    }
    return command;
}

simulation::RemoveEntities command_of(const v1::Remove& request, Violations& violations) {
    simulation::RemoveEntities command{.world = lookup_name(request.world()), .island = request.island()};
    if (request.has_generation()) {
        command.generation = request.generation();
    }
    const auto size = [](const auto& ids) { return static_cast<std::size_t>(ids.size()); };
    if (has_entries("remove.food", size(request.food()) + size(request.poison()) + size(request.organisms()),
                    violations)) {
        command.food.assign(request.food().begin(), request.food().end());
        command.poison.assign(request.poison().begin(), request.poison().end());
        command.organisms.assign(request.organisms().begin(), request.organisms().end());
    }
    return command;
}

v1::Placed placed_message(const simulation::EntityIds& ids) {
    return message_of<v1::Placed>(ids);
}

v1::Removed removed_message(const simulation::EntityIds& ids) {
    return message_of<v1::Removed>(ids);
}

} // namespace evod::protocol
