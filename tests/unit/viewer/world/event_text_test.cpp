#include "client/viewer/world/event_text.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

template <class Message>
void by_evoctl(Message& message) {
    message.mutable_by()->set_client("evoctl");
    message.mutable_by()->set_address("127.0.0.1");
}

TEST(EventText, NamesTheClientAndTheChangedParameters) {
    evod::v1::Event event;
    auto& changed = *event.mutable_parameters_changed();
    by_evoctl(changed);
    changed.add_changed()->set_name("mutation_chance");
    changed.add_changed()->set_name("food_count");
    EXPECT_EQ(event_text(event), "evoctl 127.0.0.1 changed mutation_chance, food_count");
}

TEST(EventText, SaysWhenAPlannedChangeTakesEffect) {
    evod::v1::Event event;
    auto& change = *event.mutable_change_planned()->mutable_change();
    by_evoctl(change);
    change.add_parameters()->set_name("food_count");
    change.set_tick(600);
    EXPECT_EQ(event_text(event), "evoctl 127.0.0.1 plans to change food_count after tick 600");
    change.set_generation(12);
    EXPECT_EQ(event_text(event), "evoctl 127.0.0.1 plans to change food_count from generation 12");
    const evod::v1::PlannedChange planned = change;
    by_evoctl(*event.mutable_change_cancelled());
    *event.mutable_change_cancelled()->mutable_change() = planned;
    EXPECT_EQ(event_text(event), "evoctl 127.0.0.1 cancelled the change of food_count from generation 12");
}

TEST(EventText, SaysWhyAPlannedChangeWasNotMade) {
    evod::v1::Event event;
    by_evoctl(*event.mutable_change_dropped());
    event.mutable_change_dropped()->add_name("food_count");
    EXPECT_EQ(event_text(event), "The change of food_count that evoctl 127.0.0.1 planned was dropped, because it "
                                 "conflicts with the other parameters");
}

TEST(EventText, CountsWhatWasPlacedOrRemoved) {
    evod::v1::Event event;
    auto& placed = *event.mutable_placed();
    by_evoctl(placed);
    placed.set_island(2);
    for (const std::uint32_t id : {25u, 26u, 27u}) {
        placed.add_food(id);
    }
    EXPECT_EQ(event_text(event), "evoctl 127.0.0.1 placed 3 food");
    placed.add_organisms(50);
    EXPECT_EQ(event_text(event, true), "evoctl 127.0.0.1 placed 3 food, 1 organism on island 2");
    auto& removed = *event.mutable_removed();
    removed.mutable_by()->set_user("anna");
    removed.add_poison(4);
    removed.add_organisms(1);
    removed.add_organisms(2);
    EXPECT_EQ(event_text(event), "anna removed 1 poison, 2 organisms");
}

TEST(EventText, IsEmptyForEventsThatNeedNoNotice) {
    evod::v1::Event event;
    event.mutable_generation_finished();
    EXPECT_EQ(event_text(event), "");
}

} // namespace
} // namespace evod::viewer
