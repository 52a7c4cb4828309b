// What goes out is complete, what comes in is checked: every field is found by walking the descriptors, so one that is
// added later is tested too.
#include "server/base/inline_executor.h"
#include "server/protocol/breeding.h"
#include "server/protocol/commands.h"
#include "server/protocol/events.h"
#include "server/protocol/parameters.h"
#include "server/protocol/populations.h"
#include "server/protocol/queries.h"
#include "server/protocol/refusals.h"
#include "server/protocol/worlds.h"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <tuple>

namespace evod::protocol {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

/// Fields of `message`, and of the messages in it, that have no value, as paths.
void find_unset(const Message& message, const std::string& path, std::set<std::string>& unset) {
    const auto& reflection = *message.GetReflection();
    for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
        const FieldDescriptor& field = *message.GetDescriptor()->field(i);
        const std::string name = path + field.name();
        if (field.is_repeated() ? reflection.FieldSize(message, &field) == 0 : !reflection.HasField(message, &field)) {
            unset.insert(name);
        } else if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
            find_unset(field.is_repeated() ? reflection.GetRepeatedMessage(message, &field, 0)
                                           : reflection.GetMessage(message, &field),
                       name + ".", unset);
        }
    }
}

std::set<std::string> unset_in(const Message& message) {
    std::set<std::string> unset;
    find_unset(message, "", unset);
    return unset;
}

/// Every number in a message, however deep.
void collect_numbers(const Message& message, std::vector<double>& numbers) {
    const auto& reflection = *message.GetReflection();
    std::vector<const FieldDescriptor*> fields;
    reflection.ListFields(message, &fields);
    for (const FieldDescriptor* field : fields) {
        if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
            if (field->is_repeated()) {
                for (int i = 0; i < reflection.FieldSize(message, field); ++i) {
                    collect_numbers(reflection.GetRepeatedMessage(message, field, i), numbers);
                }
            } else {
                collect_numbers(reflection.GetMessage(message, field), numbers);
            }
        } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE) {
            numbers.push_back(reflection.GetDouble(message, field));
        } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_UINT64) {
            numbers.push_back(static_cast<double>(reflection.GetUInt64(message, field)));
        } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_UINT32) {
            numbers.push_back(reflection.GetUInt32(message, field));
        }
    }
}

/// A world that has lived: three islands, two generations.
class Lived : public testing::Test {
  protected:
    Lived() {
        simulation::CreateWorld create{.name = "w", .parameters = {}, .seed = base::Seed{5}, .run_id = {1, 2}};
        create.parameters.island_count = 3;
        create.parameters.generation_s = 0.5;
        EXPECT_TRUE(laboratory.apply(create));
        EXPECT_TRUE(laboratory.apply(simulation::Run{"w", 100}));
        EXPECT_TRUE(laboratory.apply(simulation::RunUntilTick{"w", 1000}));
        for (int tick = 0; tick < 45; ++tick) {
            laboratory.advance(entry(), executor);
        }
    }
    simulation::Entry& entry() { return **laboratory.find("w"); }

    base::InlineExecutor executor;
    simulation::Laboratory laboratory;
};

TEST_F(Lived, AWorldIsToldCompletely) {
    entry().ticks_per_s = 60;
    entry().slowed = true;
    // It has not ended, it lives, and is paced.
    EXPECT_THAT(unset_in(to_proto(entry())), testing::ElementsAre("outcome", "replay", "speed.max", "storage"));
    entry().storage = {.state = simulation::StorageState::Failing, .reason = "it is full"};
    EXPECT_THAT(unset_in(to_proto(entry())), testing::ElementsAre("outcome", "replay", "speed.max"));
    entry().replay = {.replay_of = "v", .first_generation = 1, .last_generation = 2, .first_tick = 3, .last_tick = 4};
    EXPECT_THAT(unset_in(to_proto(entry())), testing::ElementsAre("outcome", "speed.max"));
    EXPECT_EQ(to_proto(entry()).run_until_generation(), 101);
}

TEST(Conversions, GenerationStatisticsAreToldCompletelyAndEachInItsPlace) {
    simulation::GenerationStatistics s;
    double next = 1;
    const auto number = [&] { return next++; };
    const auto count = [&] { return static_cast<std::uint32_t>(next++); };
    s.generation = count(), s.island = count(), s.end_tick = count(), s.organism_count = count();
    s.fitness_best = number(), s.fitness_mean = number(), s.fitness_median = number(), s.fitness_worst = number();
    s.fitness_deviation = number();
    s.account.emplace();
    for (std::size_t gene = 0; gene < s.genes.size(); ++gene) {
        s.genes[gene] = {number(), number(), number(), number()};
        (*s.account)[gene] = {number(), number(), number(), number()};
    }
    s.diversity = number(), s.alive_count = count(), s.starved_count = count(), s.poisoned_count = count();
    s.food_eaten = count(), s.poison_eaten = count(), s.clamp_count = count(), s.too_fast_count = count();
    s.speed_limit_count = count(), s.best_organism = count(), s.simulated_s = number();
    const auto told = to_proto(s);
    EXPECT_THAT(unset_in(told), testing::IsEmpty());
    // The fields of the struct stand in the order of the message's, so the numbers must rise.
    std::vector<double> numbers, expected;
    collect_numbers(told, numbers);
    for (double n = 1; n < next; ++n) {
        expected.push_back(n);
    }
    EXPECT_EQ(numbers, expected);
    s.account.reset();
    EXPECT_THAT(unset_in(to_proto(s)), testing::ElementsAre("genes.account"));
}

TEST(Conversions, LiveStatisticsAreToldCompletely) {
    const simulation::LiveStatistics s{.organism_count = 2,
                                       .alive_count = 3,
                                       .health_mean = 4,
                                       .food_eaten = 5,
                                       .poison_eaten = 6,
                                       .starved_count = 7,
                                       .poisoned_count = 8};
    std::vector<double> numbers;
    collect_numbers(to_proto(s, 1), numbers);
    EXPECT_THAT(numbers, testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
}

TEST(Conversions, ABreedingIsToldCompletely) {
    const evolution::Chromosome genes = evolution::Chromosome::Constant(100);
    evolution::BreedingRecord record;
    record.places = {.elite = 1, .survivors = 3, .children = 5};
    record.contender_count = 7;
    record.pick_count = 9;
    record.contenders.push_back({1, 2, 3, 4, 5, {6, 11, 12}, 7, evolution::Migrant{8, 99, 9, 99}, 10});
    record.picks.push_back({1, 2.5, 3, {4, 5, 6}});
    for (const std::uint32_t id : {0, 2, 3}) {
        record.descendants.push_back({.id = id,
                                      .parents = {1, 2},
                                      .first_genes = genes,
                                      .second_genes = genes,
                                      .from_second = 3,
                                      .crossed = true,
                                      .order = {{1, 0, 2, 3, 4, 5}},
                                      .changes = {{1, evolution::ChangeKind::Creep, 2, 3},
                                                  {1, evolution::ChangeKind::Reset, 2, 3},
                                                  {1, evolution::ChangeKind::BitFlip, 2, 3},
                                                  {1, evolution::ChangeKind::Clamp, 2, 3}},
                                      .genes = genes});
    }
    parameters::Parameters parameters;
    parameters.rearranging = evolution::OrderMutationMethod::Scramble;
    const v1::Breeding told = to_proto(record, parameters);
    auto unset = unset_in(told);
    // Those of the request are added by who answers it. The first descendant's id is 0.
    EXPECT_EQ(unset.erase("generation") + unset.erase("island") + unset.erase("descendants.id"), 3u);
    std::erase_if(unset, [](const std::string& path) { return path.starts_with("parameters."); }); // one kind of value
    EXPECT_THAT(unset, testing::IsEmpty());
    std::vector<double> contender;
    collect_numbers(told.contenders(0), contender);
    EXPECT_THAT(contender, testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12));
    EXPECT_EQ(told.descendant_count(), 8u);
    EXPECT_EQ(told.descendants(0).kind(), v1::DESCENDANT_KIND_ELITE);
    EXPECT_EQ(told.descendants(1).kind(), v1::DESCENDANT_KIND_SURVIVOR);
    EXPECT_EQ(told.descendants(2).kind(), v1::DESCENDANT_KIND_CHILD);
    EXPECT_EQ(told.descendants(0).order_mutation().method(), "scramble");
    std::set<int> kinds;
    for (const auto& mutation : told.descendants(0).mutations()) {
        kinds.insert(mutation.kind());
    }
    EXPECT_EQ(kinds.size(), 4u);
    EXPECT_FALSE(kinds.contains(v1::MUTATION_KIND_UNSPECIFIED));
    std::set<std::string> parameter_names;
    for (const auto& assignment : told.parameters()) {
        parameter_names.insert(assignment.name());
    }
    EXPECT_TRUE(parameter_names.contains("population_size") && parameter_names.contains("immigrants_replace"));
    EXPECT_FALSE(parameter_names.contains("generation_s")); // of the model
}

TEST_F(Lived, AnOrganismIsToldCompletely) {
    std::set<std::string> never;
    for (std::uint32_t id = 0; id < 50; ++id) {
        const auto unset = unset_in(organism_info(entry().world, entry().world.islands()[1], id));
        if (id == 0) {
            never = unset;
            continue;
        }
        std::set<std::string> both;
        std::set_intersection(never.begin(), never.end(), unset.begin(), unset.end(), std::inserter(both, both.end()));
        never = both;
    }
    never.erase("poison_eaten"), never.erase("cause_of_death"); // in a quarter of a second nobody need have
    EXPECT_THAT(never, testing::IsEmpty());
}

TEST_F(Lived, EveryKindOfEventIsTold) {
    const std::string by = "karl: evoctl 127.0.0.1:5000";
    const simulation::EventKind kinds[] = {simulation::GenerationFinished{{{}}},
                                           simulation::MigrationHappened{1, {{0, 1, 2}}},
                                           simulation::Extinction{1, 2},
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
                        testing::ElementsAre("changed.pending", "changed.value.choice", "changed.value.count",
                                             "changed.value.flag"));
            EXPECT_EQ(event.parameters_changed().by().user(), "karl");
        }
        if (event.has_change_dropped()) {
            EXPECT_THAT(unset_in(event.change_dropped()), testing::IsEmpty());
        }
    }
    const simulation::EventKind scheduled = simulation::ParametersChanged{0, "", {"mutation_chance"}, 7};
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
    const simulation::Command commands[] = {simulation::CreateWorld{}, simulation::DeleteWorld{},
                                            simulation::ResetWorld{}, simulation::Pause{},
                                            simulation::SetParameters{"w", {{"food_health", 1.0}}, false, {}}};
    for (const auto& command : commands) {
        const auto event = event_of(command, applied, "somebody", laboratory);
        ASSERT_TRUE(event);
        cases.insert(event->kind_case());
    }
    cases.insert(event_of(simulation::Storage{}).kind_case());
    EXPECT_FALSE(event_of(simulation::SetParameters{"w", {}, true, {}}, applied, "", laboratory)) << "a dry run";
    // All but the two that the network itself tells.
    EXPECT_EQ(static_cast<int>(cases.size()) + 2, v1::Event::descriptor()->oneof_decl(0)->field_count());
}

TEST(Conversions, EveryStateOfTheDiskIsTold) {
    const std::pair<simulation::StorageState, v1::StorageState> states[] = {
        {simulation::StorageState::KeepsUp, v1::STORAGE_STATE_KEEPS_UP},
        {simulation::StorageState::Behind, v1::STORAGE_STATE_BEHIND},
        {simulation::StorageState::Failing, v1::STORAGE_STATE_FAILING},
        {simulation::StorageState::Stalled, v1::STORAGE_STATE_STALLED}};
    for (const auto& [state, told] : states) {
        const auto event = event_of(simulation::Storage{state, "it is full"});
        EXPECT_EQ(event.world(), "") << "is told to all";
        EXPECT_EQ(event.storage_changed().storage().state(), told);
        EXPECT_EQ(event.storage_changed().storage().reason(), "it is full");
    }
}

TEST(Conversions, EveryParameterComesBackAsItWent) {
    for (const auto& description : parameters::parameter_registry()) {
        v1::SetParameters message;
        auto& assignment = *message.add_parameters();
        assignment.set_name(std::string{description.name});
        *assignment.mutable_value() = to_proto(description.default_value());
        std::vector<base::Violation> violations;
        const auto made = to_assignments(message.parameters(), "", violations);
        ASSERT_TRUE(violations.empty()) << description.name;
        ASSERT_EQ(made.size(), 1);
        EXPECT_EQ(made[0].name, description.name);
        EXPECT_EQ(made[0].value, description.default_value()) << description.name;
        EXPECT_FALSE(parameters::fault_of(made[0])) << description.name;

        const auto told = to_proto(description);
        EXPECT_NE(told.kind(), v1::PARAMETER_KIND_UNSPECIFIED);
        EXPECT_NE(told.effect(), v1::PARAMETER_EFFECT_UNSPECIFIED);
        EXPECT_TRUE(told.has_default_value());
    }
}

TEST(Conversions, ASetTellsWhatHoldsAndWhatWaits) {
    parameters::ParameterSet set;
    set.requested.population_size = 60;
    set.revision = 9;
    const auto told = to_proto(set);
    EXPECT_EQ(told.revision(), 9);
    EXPECT_EQ(static_cast<std::size_t>(told.parameters_size()), parameters::parameter_registry().size());
    for (const auto& state : told.parameters()) {
        EXPECT_EQ(state.has_pending(), state.name() == "population_size") << state.name();
    }
}

TEST(Conversions, AScheduleComesBackAsItWent) {
    parameters::Schedule schedule;
    schedule.add(3, {"mutation_chance", 0.05});
    schedule.add(3, {"population_size", 70u});
    schedule.add(9, {"selection", std::string{"tournament"}});
    schedule.begin_with({});
    std::vector<base::Violation> violations;
    EXPECT_EQ(to_schedule(to_proto(schedule, 1), {}, "", violations), schedule);
    EXPECT_THAT(violations, testing::IsEmpty());
    const auto later = to_proto(schedule, 3);
    ASSERT_EQ(later.size(), 1);
    EXPECT_EQ(later[0].generation(), 9);
    EXPECT_EQ(later[0].name(), "selection");
    EXPECT_EQ(later[0].value().choice(), "tournament");
    EXPECT_EQ(to_proto(schedule, 9).size(), 0);
}

TEST(Conversions, WhatIsWrongWithAScheduleIsNamed) {
    const auto fields = [](std::vector<std::tuple<std::string, std::uint64_t, double>> values) {
        google::protobuf::RepeatedPtrField<v1::ScheduledValue> message;
        for (const auto& [name, generation, value] : values) {
            auto& to = *message.Add();
            to.set_name(name);
            to.set_generation(generation);
            if (value >= 0) {
                to.mutable_value()->set_real(value);
            }
        }
        std::vector<base::Violation> violations;
        (void)to_schedule(message, {}, "create_world.", violations);
        std::vector<std::string> named;
        for (const auto& violation : violations) {
            named.push_back(violation.field + ": got " + violation.got);
        }
        return named;
    };
    using testing::ElementsAre;
    using testing::HasSubstr;
    EXPECT_THAT(fields({{"mutation_chance", 2, 1.5}}),
                ElementsAre("create_world.mutation_chance at generation 2: got 1.5"));
    EXPECT_THAT(fields({{"mutation_chance", 2, -1}}), ElementsAre(HasSubstr("generation 2: got no value")));
    EXPECT_THAT(fields({{"mutation_chance", 0, 0.1}, {"mutation_step", 1, 3}}),
                ElementsAre(HasSubstr("generation 0: got 0"), HasSubstr("generation 1: got 1")));
    EXPECT_THAT(fields({{"mutation_chance", 2, 0.1}, {"mutation_chance", 2, 0.1}}),
                ElementsAre(HasSubstr("given twice")));
    EXPECT_THAT(fields({{"initial_gene_min", 2, 90}}), ElementsAre(HasSubstr("create_world.initial_gene_min at")));
    EXPECT_THAT(fields({{"no_such", 2, 1}}), ElementsAre(HasSubstr("create_world.no_such at")));
    EXPECT_THAT(fields({{"impulse_min", 5, 300}}), ElementsAre("create_world.impulse_max at generation 5: got 250"));
    std::vector<std::tuple<std::string, std::uint64_t, double>> many;
    for (std::uint64_t i = 0; i < 4097; ++i) {
        many.emplace_back("mutation_chance", i + 2, 0.5);
    }
    EXPECT_THAT(fields(many), ElementsAre("create_world.schedule: got 4097"));
    many.pop_back();
    EXPECT_THAT(fields(many), testing::IsEmpty());
}

// ---- requests --------------------------------------------------------------------------------------------------

const Draws draws{.seed = base::Seed{1}, .run_id = {2, 3}};

TEST(Requests, EveryOneIsOfAKind) {
    const auto& requests = *v1::Request::descriptor()->FindOneofByName("kind");
    for (int i = 0; i < requests.field_count(); ++i) {
        v1::Request request;
        request.GetReflection()->MutableMessage(&request, requests.field(i));
        const auto kind = kind_of(request);
        EXPECT_NE(kind, RequestKind::Unknown) << requests.field(i)->name();
        if (kind == RequestKind::Command) {
            const auto command = to_command(request, draws);
            ASSERT_FALSE(command) << "it has no client_key";
            EXPECT_EQ(command.error().violations.front().field, "client_key");
        }
    }
    EXPECT_EQ(kind_of(v1::Request{}), RequestKind::Unknown);
}

/// Sets every double in a request, one at a time, to something that is no number, and expects a refusal that names it.
void poison_doubles(v1::Request& request, Message& part, double poison, int& poisoned) {
    const auto& reflection = *part.GetReflection();
    for (int i = 0; i < part.GetDescriptor()->field_count(); ++i) {
        const FieldDescriptor& field = *part.GetDescriptor()->field(i);
        if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
            Message& inner =
                field.is_repeated() ? *reflection.AddMessage(&part, &field) : *reflection.MutableMessage(&part, &field);
            if (inner.GetDescriptor()->name() == "ParameterAssignment") {
                static_cast<v1::ParameterAssignment&>(inner).set_name("mutation_chance");
            }
            if (auto* scheduled = dynamic_cast<v1::ScheduledValue*>(&inner)) {
                scheduled->set_name("mutation_chance");
                scheduled->set_generation(2);
            }
            poison_doubles(request, inner, poison, poisoned);
            reflection.ClearField(&part, &field);
        } else if (field.cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE) {
            reflection.SetDouble(&part, &field, poison);
            ++poisoned;
            if (kind_of(request) == RequestKind::Command) {
                auto command = to_command(request, draws);
                if (command) { // then it is for the world to refuse
                    simulation::Laboratory laboratory;
                    ASSERT_TRUE(laboratory.apply(simulation::CreateWorld{"w", {}, {}, {}}));
                    const auto applied = laboratory.apply(*command);
                    ASSERT_FALSE(applied) << request.ShortDebugString();
                    EXPECT_THAT(applied.error().violations, testing::Not(testing::IsEmpty()));
                }
            } else {
                EXPECT_THAT(faults_of(request), testing::Contains(testing::Field(
                                                    &base::Violation::field, testing::EndsWith("." + field.name()))))
                    << request.ShortDebugString();
            }
            reflection.ClearField(&part, &field);
        }
    }
}

TEST(Requests, NoNumberInThemMayBeNoneOrInfinite) {
    const auto& requests = *v1::Request::descriptor()->FindOneofByName("kind");
    int poisoned = 0;
    for (const double poison : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                                -std::numeric_limits<double>::infinity()}) {
        for (int i = 0; i < requests.field_count(); ++i) {
            v1::Request request;
            request.set_client_key("k");
            auto& part = *request.GetReflection()->MutableMessage(&request, requests.field(i));
            if (request.has_create_world()) {
                request.mutable_create_world()->set_name("new");
            }
            poison_doubles(request, part, poison, poisoned);
        }
    }
    EXPECT_EQ(poisoned, 3 * 13); // two lists of parameters, a schedule, a speed, a rate, two regions
}

TEST(Requests, EveryFaultIsNamedAtOnce) {
    v1::Request request;
    auto& create = *request.mutable_create_world();
    create.set_name("no good");
    create.add_parameters()->set_name("food_count"); // no value
    auto& wrong = *create.add_parameters();
    wrong.set_name("mutation_chance");
    wrong.mutable_value()->set_real(2);
    const auto command = to_command(request, draws);
    ASSERT_FALSE(command);
    std::vector<std::string> fields;
    for (const auto& violation : command.error().violations) {
        fields.push_back(violation.field);
    }
    EXPECT_THAT(fields, testing::UnorderedElementsAre("client_key", "create_world.name", "create_world.food_count",
                                                      "create_world.mutation_chance"));
}

TEST(Requests, APopulationMustBeOneThatTheWorldCanHave) {
    v1::Request request;
    request.set_client_key("k");
    auto& create = *request.mutable_create_world();
    create.set_name("w");
    auto& size = *create.add_parameters();
    size.set_name("population_size");
    size.mutable_value()->set_count(2);
    auto& genes = *create.add_population()->mutable_genes();
    const auto fields = [&] {
        std::vector<std::string> found;
        const auto command = to_command(request, draws);
        if (!command) {
            for (const auto& violation : command.error().violations) {
                found.push_back(to_text(violation));
            }
        }
        return found;
    };
    for (int i = 0; i < 11; ++i) {
        genes.Add(100 + static_cast<float>(i) / 8);
    }
    EXPECT_THAT(fields(),
                testing::ElementsAre("create_world.population[0].genes: got 11, allowed a multiple of 6 numbers"));
    genes.Add(100);
    EXPECT_THAT(fields(), testing::IsEmpty());
    const auto population = std::get<simulation::CreateWorld>(*to_command(request, draws)).first_population;
    ASSERT_EQ(population->size(), 1u);
    EXPECT_EQ(population->front()(3, 0), 100.375f);
    EXPECT_EQ(population->front()(0, 1), 100.75f);
    v1::CreateWorld again;
    add_population(again, population);
    EXPECT_EQ(again.population(0).SerializeAsString(), create.population(0).SerializeAsString());

    genes.Set(8, 300);
    genes.Set(11, std::numeric_limits<float>::quiet_NaN());
    EXPECT_THAT(fields(),
                testing::ElementsAre("create_world.population[0].organism[1].body_size: got 300, allowed 40 to "
                                     "200 (body_size_min, body_size_max)",
                                     "create_world.population[0].organism[1].poison_radius: got nan, allowed "
                                     "20 to 200 (poison_radius_min, poison_radius_max)"));
    genes.Truncate(6);
    create.add_population();
    EXPECT_THAT(fields(), testing::ElementsAre(
                              "create_world.population: got 2 islands, allowed 1 island (island_count)",
                              "create_world.population[0]: got 1 organism, allowed 2 organisms (population_size)",
                              "create_world.population[1]: got 0 organisms, allowed 2 organisms (population_size)"));
}

TEST(Requests, WhatIsLeftOutIsDrawnAndWhatIs0IsKept) {
    v1::Request request;
    request.set_client_key("k");
    request.mutable_create_world()->set_name("w");
    EXPECT_EQ(std::get<simulation::CreateWorld>(*to_command(request, draws)).seed, draws.seed);
    EXPECT_EQ(std::get<simulation::CreateWorld>(*to_command(request, draws)).run_id, draws.run_id);
    request.mutable_create_world()->set_seed(0);
    EXPECT_EQ(std::get<simulation::CreateWorld>(*to_command(request, draws)).seed, base::Seed{0});
    request.mutable_reset_world()->set_world("w");
    EXPECT_FALSE(std::get<simulation::ResetWorld>(*to_command(request, draws)).seed);
    request.mutable_set_parameters();
    EXPECT_FALSE(std::get<simulation::SetParameters>(*to_command(request, draws)).expected_revision);
    request.mutable_set_parameters()->set_expected_revision(0);
    EXPECT_EQ(std::get<simulation::SetParameters>(*to_command(request, draws)).expected_revision, 0);
}

TEST(Requests, ThatDestroyNameTheirWorld) {
    v1::Request request;
    request.set_client_key("k");
    request.mutable_reset_world();
    const auto reset = to_command(request, draws);
    ASSERT_FALSE(reset);
    EXPECT_EQ(reset.error().violations.at(0).field, "reset_world.world");
    request.mutable_delete_world();
    const auto deleted = to_command(request, draws);
    ASSERT_FALSE(deleted);
    EXPECT_EQ(deleted.error().violations.at(0).field, "delete_world.world");
}

TEST(Requests, NameTheirFirstUnknownFieldAtAnyDepth) {
    v1::Request request;
    v1::ParameterAssignment& assignment = *request.mutable_set_parameters()->add_parameters();
    assignment.mutable_value()->set_real(1);
    EXPECT_EQ(unknown_field_of(request), std::nullopt);
    assignment.GetReflection()->MutableUnknownFields(&assignment)->AddVarint(99, 1);
    EXPECT_EQ(unknown_field_of(request), "set_parameters.parameters.99");
    request.GetReflection()->MutableUnknownFields(&request)->AddVarint(200, 1);
    EXPECT_EQ(unknown_field_of(request), "200");
}

// ---- words -----------------------------------------------------------------------------------------------------

TEST(Refusals, HaveTheReasonsOfTheProtocol) {
    EXPECT_EQ(static_cast<int>(base::Reason::SessionsMax), v1::Reason_MAX);
    EXPECT_EQ(static_cast<int>(base::Reason::WorldNotFound), v1::REASON_WORLD_NOT_FOUND);
    EXPECT_EQ(static_cast<int>(base::Reason::RunFileDamaged), v1::REASON_RUN_FILE_DAMAGED);
    EXPECT_EQ(static_cast<int>(base::Reason::NoView), v1::REASON_NO_VIEW);
    EXPECT_EQ(static_cast<int>(base::Reason::AnswerTooLarge), v1::REASON_ANSWER_TOO_LARGE);
    EXPECT_EQ(to_proto(refusal(base::RefusalCode::InvalidArgument, "")).reason(), v1::REASON_FIELD_INVALID);
    EXPECT_EQ(to_proto(refusal(base::RefusalCode::NotFound, "", base::Reason::PastsMax)).reason(),
              v1::REASON_PASTS_MAX);
}

TEST(Refusals, QuoteNothingThatHarms) {
    EXPECT_EQ(quotable("a\nb\x1b[31m"), "a?b?[31m");
    EXPECT_EQ(quotable("a\xc2\x9b[31m é\xc2\xa0\xc2"), "a?[31m é\xc2\xa0\xc2") << "U+009B begins an escape, too";
    EXPECT_EQ(quotable("a\xe2\x80\xa8"
                       "b\xe2\x80\xae"
                       "c\xe2\x81\xa6"
                       "d\xd8\x9c"),
              "a?b?c?d?")
        << "U+2028 ends a line, and others turn the order of what follows";
    EXPECT_EQ(quotable("a – b … c\xe2\x80"), "a – b … c\xe2\x80");
    EXPECT_EQ(quotable("abcdef", 3), "abc…");
    EXPECT_EQ(quotable("ää", 3), "ä…") << "not in the middle of a character";
    EXPECT_EQ(quotable("äää", 0), "…");
}

TEST(Refusals, AreNotLongerThanAnybodyReads) {
    base::Refusal refusal;
    refusal.violations.assign(100'000, {std::string(10'000, 'f'), "a", ""});
    const auto status = to_proto(refusal);
    EXPECT_EQ(status.violations_size(), 200);
    EXPECT_LT(status.ByteSizeLong(), 100'000);
    EXPECT_THAT(status.message(), testing::HasSubstr("100000"));
    EXPECT_EQ(status.violations(0).got(), "nothing");
}

} // namespace
} // namespace evod::protocol
