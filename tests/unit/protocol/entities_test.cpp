#include "server/protocol/entities.h"

#include "server/protocol/commands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace evod::protocol {
namespace {

using testing::ElementsAre;

std::vector<std::string> fields_of(const base::Result<simulation::Command>& command) {
    std::vector<std::string> fields;
    if (!command) {
        for (const base::Violation& violation : command.error().violations) {
            fields.push_back(violation.field + ": got " + violation.got);
        }
    }
    return fields;
}

base::Result<simulation::Command> command_of(v1::Request request) {
    request.set_request_id(1);
    request.set_client_key("test");
    return to_command(request, {});
}

TEST(Place, BecomesACommand) {
    v1::Request request;
    v1::Place& place = *request.mutable_place();
    place.set_world("w");
    place.set_island(2);
    v1::PlacedItem& item = *place.add_items();
    item.set_kind(v1::ITEM_KIND_POISON);
    item.set_x_px(3.5);
    item.set_y_px(4);
    v1::PlacedOrganism& organism = *place.add_organisms();
    organism.set_x_px(7);
    organism.mutable_genes()->Resize(6, 80.0f);
    const auto command = command_of(request);
    ASSERT_TRUE(command) << to_text(command.error());
    const auto& entities = std::get<simulation::PlaceEntities>(*command);
    EXPECT_EQ(entities.world, "w");
    EXPECT_EQ(entities.island, 2u);
    EXPECT_EQ(entities.items.at(0).kind, simulation::ItemKind::Poison);
    EXPECT_EQ(entities.items.at(0).x_px, 3.5);
    EXPECT_EQ(entities.items.at(0).y_px, 4);
    EXPECT_EQ(entities.organisms.at(0).x_px, 7);
    EXPECT_EQ(entities.organisms.at(0).genes, std::vector<float>(6, 80.0f));
}

TEST(Place, NamesEveryWrongField) {
    v1::Request request;
    request.mutable_place()->add_items();
    request.mutable_place()->add_items()->set_kind(static_cast<v1::ItemKind>(3));
    EXPECT_THAT(fields_of(command_of(request)),
                ElementsAre("place.items[0].kind: got 0", "place.items[1].kind: got 3"));
}

TEST(Place, HasABoundedNumberOfEntries) {
    v1::Request none, many;
    none.mutable_place();
    EXPECT_THAT(fields_of(command_of(none)), ElementsAre("place.items: got 0"));
    for (std::size_t i = 0; i < simulation::place_entries_max; ++i) {
        many.mutable_place()->add_items()->set_kind(v1::ITEM_KIND_FOOD);
    }
    EXPECT_TRUE(command_of(many));
    many.mutable_place()->add_organisms()->mutable_genes()->Resize(6, 80.0f);
    EXPECT_THAT(fields_of(command_of(many)), ElementsAre("place.items: got 1001"));
}

TEST(Remove, BecomesACommand) {
    v1::Request request;
    v1::Remove& remove = *request.mutable_remove();
    remove.set_generation(4);
    remove.add_food(1);
    remove.add_poison(2);
    remove.add_organisms(3);
    const auto command = command_of(request);
    ASSERT_TRUE(command) << to_text(command.error());
    const auto& entities = std::get<simulation::RemoveEntities>(*command);
    EXPECT_EQ(entities.generation, 4u);
    EXPECT_THAT(entities.food, ElementsAre(1u));
    EXPECT_THAT(entities.poison, ElementsAre(2u));
    EXPECT_THAT(entities.organisms, ElementsAre(3u));
    v1::Request none;
    none.mutable_remove();
    EXPECT_THAT(fields_of(command_of(none)), ElementsAre("remove.food: got 0"));
}

TEST(EntityIds, BecomeMessages) {
    const simulation::EntityIds ids{.island = 1, .generation = 2, .food = {3, 4}, .poison = {5}, .organisms = {6}};
    const v1::Placed placed = placed_message(ids);
    EXPECT_EQ(placed.island(), 1u);
    EXPECT_EQ(placed.generation(), 2u);
    EXPECT_THAT(placed.food(), ElementsAre(3u, 4u));
    EXPECT_THAT(placed.poison(), ElementsAre(5u));
    EXPECT_THAT(placed.organisms(), ElementsAre(6u));
    EXPECT_EQ(removed_message(ids).SerializeAsString(), placed.SerializeAsString());
}

} // namespace
} // namespace evod::protocol
