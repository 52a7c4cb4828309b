#include "server/parameters/model_parameters.h"

#include "server/parameters/schedule.h"
#include "tests/unit/parameters/assignments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

namespace evod::parameters {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

bool accepted(std::string_view name, ParameterValue value) {
    return assign({}, one(name, std::move(value))).has_value();
}

/// The violations of a refused set as "field: got X, allowed Y".
std::vector<std::string> violations(const auto& result) {
    std::vector<std::string> texts;
    if (!result) {
        for (const base::Violation& violation : result.error().violations) {
            texts.push_back(to_text(violation));
        }
    }
    return texts;
}

TEST(ParameterRegistry, HasEachNameOnce) {
    std::set<std::string_view> names;
    for (const ParameterDescription& description : parameter_registry()) {
        EXPECT_TRUE(names.insert(description.name).second) << description.name;
        EXPECT_EQ(find_parameter(description.name), &description);
        EXPECT_FALSE(description.help.empty());
        EXPECT_EQ(description.help.back(), '.') << description.name;
    }
    EXPECT_GT(names.size(), 70u);
    EXPECT_EQ(find_parameter("no_such"), nullptr);
    EXPECT_EQ(find_parameter(""), nullptr);
}

TEST(ParameterRegistry, HasEachTopicOnce) {
    std::set<std::string_view> topics;
    std::string_view last;
    std::size_t most_used_count = 0;
    for (const ParameterDescription& parameter : parameter_registry()) {
        ASSERT_FALSE(parameter.topic.empty()) << parameter.name;
        EXPECT_TRUE(parameter.topic == last || topics.insert(parameter.topic).second)
            << parameter.name << ": parameters of a topic are neighbours";
        last = parameter.topic;
        most_used_count += parameter.is_most_used ? 1 : 0;
    }
    EXPECT_EQ(topics.size(), 18u);
    EXPECT_EQ(most_used_count, 7u) << "a name in the list of most used parameters does not exist";
}

TEST(ParameterRegistry, AcceptsEveryDefaultAndTheDefaultsTogether) {
    std::vector<Assignment> all;
    for (const ParameterDescription& description : parameter_registry()) {
        EXPECT_TRUE(accepted(description.name, description.default_value())) << description.name;
        all.push_back({std::string{description.name}, description.default_value()});
    }
    const auto result = assign({}, all);
    ASSERT_TRUE(result.has_value());
    EXPECT_TRUE(*result == Parameters{});
    EXPECT_THAT(validate(Parameters{}), IsEmpty());
}

TEST(ParameterRegistry, SetsOneParameterAndNoOther) {
    for (const ParameterDescription& description : parameter_registry()) {
        const Assignment assignment = other_value(description, {});
        const auto changed = assign({}, std::vector{assignment});
        ASSERT_TRUE(changed.has_value()) << description.name;
        for (const ParameterDescription& each : parameter_registry()) {
            EXPECT_EQ(each.get(*changed), &each == &description ? assignment.value : each.default_value())
                << each.name << " after setting " << description.name;
        }
        EXPECT_FALSE(*changed == Parameters{});
        EXPECT_THAT(parameters_that_differ({}, *changed), testing::ElementsAre(&description));
        Parameters copy;
        description.copy(*changed, copy);
        EXPECT_TRUE(copy == *changed);
    }
}

TEST(ParameterRegistry, ReadsEachValueBackFromItsText) {
    for (const ParameterDescription& description : parameter_registry()) {
        for (const ParameterValue& value : other_values(description)) {
            const auto read = parse_value(description, to_text(value));
            ASSERT_TRUE(read.has_value()) << description.name << " " << to_text(value);
            EXPECT_EQ(*read, value) << description.name;
        }
    }
}

TEST(ParameterRegistry, RefusesTextThatIsNotAValue) {
    for (const char* text : {"", " 1", "1 ", "0.5x", "--1", "one"}) {
        EXPECT_FALSE(parse_value(*find_parameter("tick_s"), text).has_value()) << text;
        EXPECT_FALSE(parse_value(*find_parameter("food_count"), text).has_value()) << text;
        EXPECT_FALSE(parse_value(*find_parameter("respawn"), text).has_value()) << text;
        EXPECT_FALSE(parse_value(*find_parameter("selection"), text).has_value()) << text;
    }
    EXPECT_FALSE(parse_value(*find_parameter("food_count"), "-1").has_value());
    EXPECT_FALSE(parse_value(*find_parameter("food_count"), "1.5").has_value());
    EXPECT_FALSE(parse_value(*find_parameter("food_count"), "4294967296").has_value());
    EXPECT_FALSE(parse_value(*find_parameter("respawn"), "True").has_value());
}

TEST(Assign, AcceptsBothEndsOfEveryRangeAndNothingBeyond) {
    for (const ParameterDescription& description : parameter_registry()) {
        const std::string name{description.name};
        const auto refused_by_itself = [&](ParameterValue value) {
            const auto result = assign({}, one(name, value));
            return !result && result.error().violations.size() == 1 && result.error().violations[0].field == name &&
                   result.error().violations[0].allowed.starts_with(description.allowed()) && // a hint may follow
                   (result.error().violations[0].got == to_text(value) ||
                    result.error().violations[0].got == '"' + to_text(value) + '"');
        };
        // Other rules may refuse an end of the range, but the range itself must not.
        if (const auto* real = std::get_if<RealParameter>(&description.kind)) {
            constexpr double infinity = std::numeric_limits<double>::infinity();
            EXPECT_FALSE(refused_by_itself(real->range.min)) << name;
            EXPECT_FALSE(refused_by_itself(real->range.max)) << name;
            EXPECT_TRUE(refused_by_itself(std::nextafter(real->range.min, -infinity))) << name;
            EXPECT_TRUE(refused_by_itself(std::nextafter(real->range.max, infinity))) << name;
            EXPECT_TRUE(refused_by_itself(std::numeric_limits<double>::quiet_NaN())) << name;
            EXPECT_TRUE(refused_by_itself(infinity)) << name;
            EXPECT_TRUE(refused_by_itself(-infinity)) << name;
            EXPECT_TRUE(refused_by_itself(true)) << name;
            EXPECT_TRUE(refused_by_itself(std::string{"1"})) << name;
        } else if (const auto* count = std::get_if<CountParameter>(&description.kind)) {
            EXPECT_FALSE(refused_by_itself(count->range.min)) << name;
            EXPECT_FALSE(refused_by_itself(count->range.max)) << name;
            EXPECT_TRUE(count->range.min == 0 || refused_by_itself(count->range.min - 1)) << name;
            EXPECT_TRUE(count->range.max == base::count_max || refused_by_itself(count->range.max + 1)) << name;
            EXPECT_TRUE(refused_by_itself(1.0)) << name;
            EXPECT_TRUE(refused_by_itself(false)) << name;
        } else if (std::holds_alternative<FlagParameter>(description.kind)) {
            EXPECT_TRUE(refused_by_itself(std::uint32_t{1})) << name;
            EXPECT_TRUE(refused_by_itself(std::string{"true"})) << name;
        } else {
            EXPECT_TRUE(refused_by_itself(std::string{"no such choice"})) << name;
            EXPECT_TRUE(refused_by_itself(std::string{})) << name;
            EXPECT_TRUE(refused_by_itself(std::uint32_t{0})) << name;
        }
    }
}

TEST(Assign, AcceptsACountForAReal) {
    const auto result = assign({}, one("respawn_s", std::uint32_t{3}));
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(result->respawn_s, 3);
}

TEST(Assign, NamesEveryViolationWithItsPrefix) {
    const auto result = assign({},
                               std::vector<Assignment>{{"mutation_chance", 1.5},
                                                       {"food_count", std::uint32_t{30}},
                                                       {"mutation_chence", 0.5},
                                                       {"food_count", std::uint32_t{31}},
                                                       {"selection", std::string{"lottery"}}},
                               "set_parameters.");
    EXPECT_THAT(
        violations(result),
        ElementsAre(
            "set_parameters.mutation_chance: got 1.5, allowed 0 to 1",
            AllOf(HasSubstr("set_parameters.mutation_chence: unknown name"), HasSubstr("did you mean mutation_chance")),
            "set_parameters.food_count: got given twice, allowed given once",
            "set_parameters.selection: got lottery, allowed roulette, stochastic_universal, tournament, "
            "random, truncation"));
}

TEST(Assign, RefusesMoreAssignmentsThanParameters) {
    const std::vector<Assignment> many(200'000, {"foood", 1.0});
    EXPECT_THAT(
        violations(assign({}, many, "set_parameters.parameters.")),
        ElementsAre(AllOf(HasSubstr("set_parameters.parameters: got 200000"), HasSubstr("each parameter once"))));
}

TEST(SimilarNames, AreOrderedBySimilarity) {
    EXPECT_EQ(similar_parameter_names("mutation_chence").front(), "mutation_chance");
    EXPECT_THAT(similar_parameter_names("poison_cout"), Contains("poison_count"));
    EXPECT_THAT(similar_parameter_names("tournament"), SizeIs(3)); // at most three, all with that part
    EXPECT_THAT(similar_parameter_names("xxxxxxxxxxxxxxxxxxxxxxxx"), IsEmpty());
    EXPECT_THAT(similar_parameter_names(std::string(100'000, 'x')), IsEmpty());
    EXPECT_THAT(similar_parameter_names(""), IsEmpty());
}

TEST(CrossFieldRules, RequireMinimaBelowMaxima) {
    for (const std::string stem :
         {"initial_gene", "normal_speed", "impulse", "body_size", "base_health", "food_radius", "poison_radius"}) {
        const auto both = [&](double min, double max) {
            return assign({}, std::vector<Assignment>{{stem + "_min", min}, {stem + "_max", max}});
        };
        EXPECT_TRUE(both(100, 100).has_value()) << stem;
        EXPECT_THAT(violations(both(100, 99)),
                    ElementsAre(stem + "_max: got 99, allowed at least " + stem + "_min (100)"));
    }
}

TEST(CrossFieldRules, KeepTournamentsPossible) {
    const auto set = [](std::uint32_t size, std::uint32_t winners, bool replacement, std::uint32_t population) {
        return assign({}, std::vector<Assignment>{{"selection", std::string{"tournament"}},
                                                  {"tournament_size", size},
                                                  {"tournament_winners", winners},
                                                  {"tournament_replacement", replacement},
                                                  {"population_size", population}})
            .has_value();
    };
    EXPECT_TRUE(set(5, 5, false, 5));
    EXPECT_FALSE(set(5, 6, false, 20));
    EXPECT_FALSE(set(21, 1, false, 20));
    EXPECT_TRUE(set(21, 1, true, 20));
}

TEST(CrossFieldRules, LimitTicksAndDistancesPerTick) {
    const auto set = [](std::vector<Assignment> assignments) { return assign({}, assignments).has_value(); };
    EXPECT_FALSE(set({{"generation_s", 0.5}, {"tick_s", 0.6}}));
    EXPECT_TRUE(set({{"generation_s", 0.5}, {"tick_s", 0.5}}));
    EXPECT_FALSE(set({{"max_speed_px_s", 50'001.0}, {"tick_s", 0.1}}));
    EXPECT_TRUE(set({{"max_speed_px_s", 50'000.0}, {"tick_s", 0.1}}));
}

TEST(CrossFieldRules, LimitTheTotalOverAllIslands) {
    const auto set = [](std::vector<Assignment> assignments) { return assign({}, assignments).has_value(); };
    const Assignment scaled{"scale_with_population", true};
    EXPECT_TRUE(set({scaled, {"population_size", std::uint32_t{500'000}}, {"island_count", std::uint32_t{8}}}));
    EXPECT_FALSE(set({scaled, {"population_size", std::uint32_t{500'000}}, {"island_count", std::uint32_t{9}}}));
    EXPECT_FALSE(set({{"fitness", std::string{"gene_sum"}},
                      {"population_size", std::uint32_t{1'000'000}},
                      {"island_count", std::uint32_t{5}}}));
    EXPECT_TRUE(set({{"food_count", std::uint32_t{10'000'000}}, {"island_count", std::uint32_t{3}}}));
    EXPECT_FALSE(set({{"food_count", std::uint32_t{10'000'000}}, {"island_count", std::uint32_t{4}}}));
}

TEST(CrossFieldRules, KeepRoomForOrganisms) {
    EXPECT_FALSE(accepted("population_size", std::uint32_t{400}));
    EXPECT_TRUE(accepted("population_size", std::uint32_t{200}));
    EXPECT_FALSE(accepted("island_width_px", 100.0)) << "50 organisms of 20 px radius have no room on 100 × 720 px";
}

TEST(CrossFieldRules, KeepRoomForACrateAmongManySmallObstacles) {
    // The obstacles cover few square pixels, but a crate of 100 px hardly finds a place without one.
    const auto result = assign({}, std::vector<Assignment>{{"population_size", std::uint32_t{1}},
                                                           {"island_width_px", 400.0},
                                                           {"island_height_px", 400.0},
                                                           {"body_size_min", 1.0},
                                                           {"body_size_max", 1.0},
                                                           {"item_radius_px", 0.5},
                                                           {"obstacle_count", std::uint32_t{500}},
                                                           {"obstacle_size_px", 5.0},
                                                           {"crate_count", std::uint32_t{1}},
                                                           {"crate_size_px", 100.0}});
    EXPECT_FALSE(result.has_value());
}

TEST(CrossFieldRules, KeepRoomForAnOrganismAmongManySmallCrates) {
    const auto result = assign({}, std::vector<Assignment>{{"population_size", std::uint32_t{2}},
                                                           {"island_width_px", 500.0},
                                                           {"island_height_px", 500.0},
                                                           {"body_size_min", 500.0},
                                                           {"body_size_max", 500.0},
                                                           {"crate_count", std::uint32_t{1000}},
                                                           {"crate_size_px", 5.0}});
    EXPECT_FALSE(result.has_value());
}

/// The violations of a world whose controller is a network, with these changes.
std::vector<std::string> network_violations(std::vector<Assignment> assignments) {
    assignments.push_back({"controller", std::string{"network"}});
    return violations(assign({}, assignments));
}

TEST(CrossFieldRules, RefuseANetworkWithoutInputs) {
    constexpr auto fault =
        "sense_food: got a network without inputs, allowed at least one sense: sense_food, sense_poison, sense_speed, "
        "sense_health or sense_wall";
    const std::vector<Assignment> blind{{"sense_food", false}, {"sense_poison", false}};
    EXPECT_THAT(network_violations(blind), Contains(fault));
    EXPECT_TRUE(assign({}, blind).has_value()) << "rules need no inputs";
    for (const char* sense : {"sense_speed", "sense_health", "sense_wall"}) {
        EXPECT_THAT(network_violations({blind[0], blind[1], {sense, true}}), Not(Contains(fault))) << sense;
    }
}

TEST(CrossFieldRules, KeepFirstWeightsWithinTheLimit) {
    const auto set = [](double limit, double initial) {
        return violations(
            assign({}, std::vector<Assignment>{{"brain_weight_limit", limit}, {"brain_weight_initial", initial}}));
    };
    EXPECT_THAT(set(2, 2), IsEmpty());
    EXPECT_THAT(set(2, 3), ElementsAre("brain_weight_limit: got 2, allowed at least brain_weight_initial (3)"));
}

TEST(CrossFieldRules, LimitTheGenesOfAllOrganisms) {
    constexpr auto fault = "brain_hidden: got 1000000 organisms with a total of 232000000 genes, allowed at most "
                           "124000000 genes in all organisms together";
    const Assignment scaled{"scale_with_population", true}, million{"population_size", std::uint32_t{1'000'000}};
    EXPECT_THAT(network_violations({scaled, million, {"brain_hidden", std::uint32_t{32}}}), Contains(fault));
    EXPECT_THAT(network_violations({scaled, million, {"brain_hidden", std::uint32_t{8}}}),
                Not(Contains(HasSubstr("genes in all organisms"))));
}

TEST(CrossFieldRules, LimitFreeGenes) {
    const auto set = [](std::vector<Assignment> assignments) { return violations(assign({}, assignments)); };
    EXPECT_THAT(set({{"free_genes", std::uint32_t{1000}}}), IsEmpty());
    EXPECT_THAT(set({{"free_genes", std::uint32_t{1001}}}),
                ElementsAre("free_genes: got 1001, allowed a whole number, 0 to 1000"));
    EXPECT_THAT(set({{"free_gene_min", 2.0}, {"free_gene_max", 2.0}}), IsEmpty());
    EXPECT_THAT(set({{"free_gene_min", 2.0}, {"free_gene_max", 1.5}}),
                ElementsAre("free_gene_max: got 1.5, allowed at least free_gene_min (2)"));
    EXPECT_THAT(set({{"free_gene_min", -2e6}}), ElementsAre("free_gene_min: got -2e+06, allowed -1e+06 to 1e+06"));
    const Assignment no_bodies{"fitness", std::string{"gene_sum"}}, many{"population_size", std::uint32_t{200'000}};
    EXPECT_THAT(set({no_bodies, many, {"free_genes", std::uint32_t{614}}}), IsEmpty());
    EXPECT_THAT(
        set({no_bodies, many, {"free_genes", std::uint32_t{615}}}),
        ElementsAre("free_genes: got 200000 organisms with a total of 124200000 genes, allowed at most 124000000 "
                    "genes in all organisms together"));
    EXPECT_THAT(
        network_violations({no_bodies, many, {"free_genes", std::uint32_t{1000}}}),
        ElementsAre("free_genes: got 200000 organisms with a total of 208600000 genes, allowed at most 124000000 "
                    "genes in all organisms together"))
        << "most genes are free, although there is a network";
}

TEST(CrossFieldRules, MutateGroupHasGenes) {
    const auto set = [](std::string group, bool network, std::uint32_t free_genes) {
        return violations(assign({}, std::vector<Assignment>{{"mutate_group", std::move(group)},
                                                             {"controller", std::string{network ? "network" : "rules"}},
                                                             {"free_genes", free_genes}}));
    };
    const auto fault = [](const std::string& got, const std::string& groups) {
        return "mutate_group: got " + got + ", allowed a group with genes: " + groups +
               "; their number changes at a reset";
    };
    for (const bool network : {false, true}) {
        for (const std::uint32_t free_genes : {0u, 10u}) {
            const std::string groups =
                std::string{"all, body"} + (network ? ", brain" : "") + (free_genes > 0 ? ", free" : "");
            EXPECT_THAT(set("all", network, free_genes), IsEmpty());
            EXPECT_THAT(set("body", network, free_genes), IsEmpty());
            const std::vector<std::string> accepted;
            EXPECT_EQ(set("brain", network, free_genes), network ? accepted : std::vector{fault("brain", groups)});
            EXPECT_EQ(set("free", network, free_genes), free_genes > 0 ? accepted : std::vector{fault("free", groups)});
        }
    }
    EXPECT_THAT(set("weights", false, 0), ElementsAre("mutate_group: got weights, allowed all, body, brain, free"));
}

TEST(CrossFieldRules, MutateGroupMustHaveGenesBeforeAReset) {
    const ParameterSet running;
    const std::vector<Assignment> both{{"free_genes", std::uint32_t{10}}, {"mutate_group", std::string{"free"}}};
    EXPECT_TRUE(assign({}, both).has_value()) << "of a new world";
    EXPECT_THAT(
        violations(request_of(running, both, "set_parameters.")),
        ElementsAre("set_parameters.mutate_group: got free, allowed a group with genes: all, body; their number "
                    "changes at a reset"));
    EXPECT_TRUE(request_of(running, std::vector{both[0]}, "").has_value());
}

TEST(CrossFieldRules, KinematicOrganismsHaveNoObstacles) {
    const Assignment kinematic{"locomotion", std::string{"kinematic"}};
    EXPECT_THAT(network_violations({kinematic, {"obstacle_count", std::uint32_t{2}}}),
                Contains("obstacle_count: got 2, allowed 0 if locomotion is kinematic, because bodies then have no "
                         "contacts"));
    EXPECT_THAT(network_violations({kinematic, {"crate_count", std::uint32_t{1}}}),
                Contains("crate_count: got 1, allowed 0 if locomotion is kinematic, because bodies then have no "
                         "contacts"));
}

TEST(CrossFieldRules, LeaveRoomInsideTheSpawnMargin) {
    const auto set = [](double margin) { return violations(assign({}, one("spawn_margin_px", margin))); };
    EXPECT_THAT(set(100), IsEmpty());
    EXPECT_THAT(set(360), ElementsAre("spawn_margin_px: got 360, allowed less than half of the island's shorter side "
                                      "(360)"));
    EXPECT_THAT(set(300), ElementsAre(HasSubstr("population_size: got 50 organisms, covered share")));
}

TEST(CrossFieldRules, BirthsLeaveNothingToSelect) {
    const auto with_births = [](std::string_view name, const ParameterValue& value) {
        return violations(
            assign({}, std::vector<Assignment>{{"reproduction", std::string{"births"}}, {std::string{name}, value}}));
    };
    EXPECT_THAT(with_births("mutation_chance", 0.3), IsEmpty());
    EXPECT_THAT(with_births("target_fitness", 7.0), IsEmpty());
    EXPECT_THAT(with_births("fitness", std::string{"external"}), ElementsAre(HasSubstr("the number of children")));
    EXPECT_THAT(with_births("elite_count", 1U),
                ElementsAre("elite_count: got 1, allowed 0 if reproduction is births: life and death then select, not "
                            "this parameter"));
    for (const char* name : {"selection", "population_model", "fitness_scaling", "predator_selection"}) {
        const auto value = other_values(*find_parameter(name)).front();
        EXPECT_THAT(with_births(name, value), ElementsAre(HasSubstr("reproduction is births"))) << name;
    }
    EXPECT_THAT(with_births("shuffle_fitness", true), ElementsAre(HasSubstr("shuffle_fitness: got true")));
    EXPECT_THAT(with_births("birth_every_s", 41.0), ElementsAre(HasSubstr("at most generation_s (40)")));
    EXPECT_THAT(with_births("shuffle_births", true), IsEmpty());
    EXPECT_TRUE(accepted("birth_every_s", 41.0));
}

TEST(CrossFieldRules, LimitTheOrganismsOfColonies) {
    const auto set = [](std::vector<Assignment> assignments) { return assign({}, assignments).has_value(); };
    const Assignment births{"reproduction", std::string{"births"}};
    EXPECT_TRUE(set({births, {"population_max", std::uint32_t{4'000'000}}}));
    EXPECT_FALSE(set({births, {"population_max", std::uint32_t{4'000'000}}, {"predator_count", std::uint32_t{1}}}));
    EXPECT_FALSE(set({births, {"population_max", std::uint32_t{400'000}}, {"island_count", std::uint32_t{11}}}));
    EXPECT_TRUE(set({births, {"free_genes", std::uint32_t{1000}}, {"population_max", std::uint32_t{30'000}}}));
    EXPECT_FALSE(set({births, {"free_genes", std::uint32_t{1000}}, {"population_max", std::uint32_t{31'000}}}));
}

TEST(CrossFieldRules, PredatorsNeedBodiesAndRoom) {
    const auto with_predators = [](std::uint32_t count, std::vector<Assignment> assignments) {
        assignments.push_back({"predator_count", count});
        return violations(assign({}, assignments));
    };
    EXPECT_THAT(with_predators(20, {}), IsEmpty());
    EXPECT_THAT(with_predators(20, {{"fitness", std::string{"gene_sum"}}}), ElementsAre(HasSubstr("predator_count")));
    EXPECT_THAT(with_predators(400, {}), ElementsAre(HasSubstr("0.4 of an island")));
    EXPECT_THAT(with_predators(20, {{"predator_initial_gene_min", 130.0}}),
                ElementsAre(HasSubstr("predator_initial_gene_max: got 120")));
    const std::vector<Assignment> tournaments{{"predator_selection", std::string{"tournament"}},
                                              {"tournament_replacement", false},
                                              {"tournament_size", std::uint32_t{21}}};
    EXPECT_THAT(with_predators(20, tournaments), ElementsAre(HasSubstr("predator_count: got 20")));
    EXPECT_THAT(with_predators(21, tournaments), IsEmpty());
}

TEST(TakingEffect, BirthsKeepBodiesAndIslandsUntilAReset) {
    Parameters active;
    active.reproduction = Reproduction::Births;
    RequestedParameters requested{active};
    requested.values.island_width_px = 2000;
    requested.values.population_size = 60;
    requested.values.birth_every_s = 1;
    const Parameters next = taking_effect(active, requested, base::Effect::NextGeneration);
    EXPECT_EQ(next.island_width_px, 1280);
    EXPECT_EQ(next.population_size, 50u);
    EXPECT_EQ(next.birth_every_s, 1);
    EXPECT_TRUE(taking_effect(active, requested, base::Effect::Reset) == requested.values);
    active.reproduction = Reproduction::Generations;
    EXPECT_EQ(taking_effect(active, requested, base::Effect::NextGeneration).island_width_px, 2000);
    for (const std::string_view name : kept_with_births()) {
        ASSERT_NE(find_parameter(name), nullptr) << name;
        EXPECT_EQ(find_parameter(name)->effect, base::Effect::NextGeneration) << name;
    }
}

TEST(Followers, HaveTheDefaultAndTheRangeOfWhatTheyFollow) {
    for (const auto& [name, followed] : followers()) {
        ASSERT_NE(find_parameter(name), nullptr) << name;
        ASSERT_NE(find_parameter(followed), nullptr) << followed;
        EXPECT_EQ(find_parameter(name)->default_value(), find_parameter(followed)->default_value()) << name;
        EXPECT_TRUE(find_parameter(name)->allowed() == find_parameter(followed)->allowed()) << name;
        EXPECT_THAT(std::string{find_parameter(name)->help},
                    HasSubstr("in an experiment file, the default is the file's " + std::string{followed}));
    }
}

TEST(OfPredators, TakesEveryValueOfThePredators) {
    for (const auto& [name, followed] : followers()) {
        if (!name.starts_with("predator_")) {
            continue;
        }
        Parameters p;
        const auto changed = assign(p, one(name, other_values(*find_parameter(name)).front()));
        ASSERT_TRUE(changed.has_value()) << name;
        EXPECT_EQ(find_parameter(followed)->get(of_predators(*changed)), find_parameter(name)->get(*changed)) << name;
    }
    Parameters p;
    p.predator_count = 7;
    EXPECT_EQ(of_predators(p).population_size, 7u);
}

TEST(IslandPlan, ScalesWithThePopulationIfRequested) {
    Parameters p;
    p.population_size = 200;
    EXPECT_EQ(island_plan(p).width_px, 1280);
    p.scale_with_population = true;
    const IslandPlan plan = island_plan(p); // four times the reference
    EXPECT_EQ(plan.width_px, 2560);
    EXPECT_EQ(plan.height_px, 1440);
    EXPECT_EQ(plan.food_count, 100u);
    EXPECT_EQ(plan.poison_count, 160u);
    p.population_size = 12; // 0.24
    EXPECT_EQ(island_plan(p).food_count, 6u);
    EXPECT_EQ(island_plan(p).poison_count, 10u); // 9.6
    p.population_size = 4'000'000;               // 283 times as wide
    p.island_width_px = 2000;
    EXPECT_THAT(validate(p), testing::Not(IsEmpty())) << "wider than an island can be";
}

} // namespace
} // namespace evod::parameters
