#include "server/protocol/events.h"

#include "tests/unit/protocol/messages.h"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

namespace evod::protocol {
namespace {

TEST_F(Lived, EveryKindOfEventIsConverted) {
    const base::Actor by = base::client_actor("karl", "evoctl", "127.0.0.1:5000");
    const simulation::EventKind kinds[] = {simulation::GenerationFinished{{{}}},
                                           simulation::MigrationHappened{1, {{0, 1, 2}}},
                                           simulation::Extinction{1, 2, 30},
                                           simulation::RunTerminated{evolution::Outcome::Stagnation},
                                           simulation::ParametersChanged{3, by, {"mutation_chance"}, 7},
                                           simulation::ChangeDropped{3, by, {"mutation_chance"}, {{"a", "b", "c"}}},
                                           simulation::GoalReached{}};
    std::set<int> cases;
    for (const auto& kind : kinds) {
        const auto event = to_proto(simulation::Event{"w", {1, 2}, 3, kind}, laboratory);
        cases.insert(event.kind_case());
        EXPECT_EQ(event.world(), "w");
        EXPECT_EQ(event.tick(), 3);
        EXPECT_EQ(event.run_id().size(), 32);
        if (event.has_parameters_changed()) {
            EXPECT_THAT(unset_in(event.parameters_changed()),
                        testing::ElementsAre("changed.effect", "changed.max", "changed.min", "changed.pending",
                                             "changed.value.choice", "changed.value.count", "changed.value.flag"));
            EXPECT_EQ(event.parameters_changed().by().user(), "karl");
        }
        if (event.has_change_dropped()) {
            EXPECT_THAT(unset_in(event.change_dropped()), testing::IsEmpty());
        }
    }
    const simulation::EventKind scheduled = simulation::ParametersChanged{0, {}, {"mutation_chance"}, 7};
    EXPECT_EQ(to_proto(simulation::Event{"w", {1, 2}, 3, scheduled}, laboratory).parameters_changed().by().kind(),
              v1::ACTOR_KIND_SCHEDULE);
    const parameters::PlannedChange change{
        .id = 4, .at = {.generation = 9, .tick = {}}, .assignments = {{"food_health", 1.0}}, .by = by};
    const simulation::Applied planned{.world = "w", .tick = 3, .parameters = {}, .planned = change};
    for (const simulation::Command& command :
         {simulation::Command{simulation::SetParameters{"w", {{"food_health", 1.0}}, false, {}, change.at, by}},
          simulation::Command{simulation::CancelChange{"w", 4}}}) {
        const auto event = event_of(command, planned, by, laboratory);
        ASSERT_TRUE(event);
        cases.insert(event->kind_case());
        auto unset = unset_in(*event);
        for (const char* part : {"change_planned.change.", "change_cancelled.change."}) {
            for (const char* other :
                 {"tick", "parameters.value.choice", "parameters.value.count", "parameters.value.flag"}) {
                unset.erase(std::string{part} + other);
            }
        }
        for (const std::string& field : unset) {
            EXPECT_EQ(field.find('.'), std::string::npos) << field;
        }
    }
    const simulation::Applied applied{.world = "w", .tick = 3, .parameters = parameters::ParameterSet{}};
    const simulation::Command commands[] = {
        simulation::CreateWorld{}, simulation::DeleteWorld{},
        simulation::ResetWorld{},  simulation::Pause{},
        simulation::AddNote{},     simulation::SetParameters{"w", {{"food_health", 1.0}}, false, {}}};
    for (const auto& command : commands) {
        const auto event = event_of(command, applied, base::client_actor({}, "a client", "::1:5000"), laboratory);
        ASSERT_TRUE(event);
        cases.insert(event->kind_case());
    }
    const simulation::EntityIds ids{.island = 1, .generation = 2, .food = {3}, .poison = {4}, .organisms = {5}};
    const simulation::Applied changed{.world = "w", .tick = 3, .parameters = {}, .placed = ids, .removed = ids};
    for (const simulation::Command& command : {simulation::Command{simulation::PlaceEntities{.world = "w"}},
                                               simulation::Command{simulation::RemoveEntities{.world = "w"}}}) {
        cases.insert(event_of(command, changed, by, laboratory)->kind_case());
    }
    cases.insert(event_of(simulation::Storage{}).kind_case());
    cases.insert(event_of(simulation::DamagedWorld{}).kind_case());
    EXPECT_FALSE(event_of(simulation::SetParameters{"w", {}, true, {}}, applied, {}, laboratory)) << "a dry run";
    // All but the three events that the network itself creates, and the two about fitness (ratings_test.cpp).
    EXPECT_EQ(static_cast<int>(cases.size()) + 5, v1::Event::descriptor()->oneof_decl(0)->field_count());
}

TEST(EventMessage, EveryStateOfTheDiskIsConverted) {
    const std::pair<simulation::StorageState, v1::StorageState> states[] = {
        {simulation::StorageState::KeepsUp, v1::STORAGE_STATE_KEEPS_UP},
        {simulation::StorageState::Behind, v1::STORAGE_STATE_BEHIND},
        {simulation::StorageState::Failing, v1::STORAGE_STATE_FAILING},
        {simulation::StorageState::Stalled, v1::STORAGE_STATE_STALLED}};
    for (const auto& [state, message] : states) {
        const auto event = event_of(simulation::Storage{state, "it is full"});
        EXPECT_EQ(event.world(), "") << "the event is for all subscribers";
        EXPECT_EQ(event.storage_changed().storage().state(), message);
        EXPECT_EQ(event.storage_changed().storage().reason(), "it is full");
    }
    EXPECT_EQ(event_of(simulation::Storage{}, "w").world(), "w") << "the event is about the file of one world";
}

TEST(EventMessage, ADamagedWorldIsReportedWithItsReason) {
    const auto event =
        event_of(simulation::DamagedWorld{.name = "w", .run_id = simulation::RunId{1, 2}, .reason = "bad"});
    EXPECT_EQ(event.world(), "w");
    EXPECT_EQ(event.run_id(), to_text(simulation::RunId{1, 2}));
    EXPECT_EQ(event.world_damaged().reason(), "bad");
}

} // namespace
} // namespace evod::protocol
