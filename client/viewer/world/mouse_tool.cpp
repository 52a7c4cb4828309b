#include "client/viewer/world/mouse_tool.h"

#include <utility>

namespace evod::viewer {

void MouseTool::place(Model model) {
    model_ = std::move(model);
    kind_ = Kind::Organism;
}

void MouseTool::drag(Model model) {
    place(std::move(model));
    drag_ = Drag::Held;
}

std::string MouseTool::problem(Kind kind, const ViewedWorld& world) const {
    if (kind == Kind::Select) {
        return "";
    }
    if (!world.server.supports("place")) {
        return "This server cannot place or remove anything; a newer version of evod can";
    }
    if (!world.feed.control().known()) {
        return "No world is open yet";
    }
    if (world.replay.info() != nullptr) {
        return "A replay cannot be changed; fork it, and change the fork";
    }
    if (const std::string_view why = world.commands.read_only_reason(); !why.empty()) {
        return std::string{why};
    }
    if (kind == Kind::Organism && !model_) {
        return "Select an organism to place copies of it, or thaw one in the panel Freezer (F10)";
    }
    return "";
}

std::string MouseTool::hint(const Target& target) const {
    switch (kind_) {
    case Kind::Select:
        return "";
    case Kind::Food:
        return "Place food";
    case Kind::Poison:
        return "Place poison";
    case Kind::Organism:
        return "Place " + model_.value_or(Model{"an organism", {}}).name;
    case Kind::Remove:
        break;
    }
    return target.organism ? "Remove organism " + std::to_string(*target.organism)
           : target.food   ? "Remove food"
           : target.poison ? "Remove poison"
                           : "Nothing to remove here";
}

std::optional<evod::v1::Request> MouseTool::request(const std::string& world, const Target& target) const {
    evod::v1::Request request;
    if (kind_ == Kind::Remove) {
        evod::v1::Remove& remove = *request.mutable_remove();
        remove.set_world(world);
        remove.set_island(target.island);
        remove.set_generation(target.generation);
        if (target.organism) {
            remove.add_organisms(*target.organism);
        } else if (target.food) {
            remove.add_food(*target.food);
        } else if (target.poison) {
            remove.add_poison(*target.poison);
        } else {
            return std::nullopt;
        }
        return request;
    }
    evod::v1::Place& place = *request.mutable_place();
    place.set_world(world);
    place.set_island(target.island);
    const auto at = [&](auto& placed) {
        placed.set_x_px(target.x_px);
        placed.set_y_px(target.y_px);
    };
    if (kind_ == Kind::Organism) {
        evod::v1::PlacedOrganism& organism = *place.add_organisms();
        at(organism);
        organism.mutable_genes()->Assign(model_->genes.begin(), model_->genes.end());
    } else {
        evod::v1::PlacedItem& item = *place.add_items();
        at(item);
        item.set_kind(kind_ == Kind::Food ? evod::v1::ITEM_KIND_FOOD : evod::v1::ITEM_KIND_POISON);
    }
    return request;
}

void MouseTool::click(ViewedWorld& world, const Target& target) const {
    if (std::string why = problem(kind_, world); !why.empty()) {
        return world.server.notice(std::move(why));
    }
    if (auto wanted = request(world.feed.name(), target)) {
        world.change_entities(*std::move(wanted));
    } else {
        world.server.notice(hint(target));
    }
}

} // namespace evod::viewer
