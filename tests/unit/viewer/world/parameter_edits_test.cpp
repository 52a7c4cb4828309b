#include "client/viewer/world/parameter_edits.h"

#include <gmock/gmock.h>

namespace evod::viewer {
namespace {

using evod::v1::ParameterDescription;
using evod::v1::ParameterValue;
using testing::ElementsAre;

ParameterValue real(double number) {
    ParameterValue value;
    value.set_real(number);
    return value;
}
ParameterValue count(std::uint32_t number) {
    ParameterValue value;
    value.set_count(number);
    return value;
}
ParameterValue flag(bool on) {
    ParameterValue value;
    value.set_flag(on);
    return value;
}

ParameterDescription describe(const std::string& name, evod::v1::ParameterKind kind, double min, double max,
                              const ParameterValue& default_value) {
    ParameterDescription about;
    about.set_name(name);
    about.set_kind(kind);
    about.set_min(min);
    about.set_max(max);
    *about.mutable_default_value() = default_value;
    return about;
}
ParameterDescription chance() {
    auto about = describe("mutation_chance", evod::v1::PARAMETER_KIND_REAL, 0, 1, real(0.15));
    about.set_unit("chance");
    about.set_help("Chance per gene of a creep mutation.");
    return about;
}

constexpr std::size_t mutation_chance = 0, food_count = 1, respawn = 2; // indices

evod::v1::ParameterState state(const std::string& name, const ParameterValue& value) {
    evod::v1::ParameterState reported;
    reported.set_name(name);
    *reported.mutable_value() = value;
    return reported;
}

evod::v1::ParameterSet set_of(std::uint64_t revision, double chance_value = 0.15, std::uint32_t food = 25) {
    evod::v1::ParameterSet set;
    *set.add_parameters() = state("mutation_chance", real(chance_value));
    *set.add_parameters() = state("food_count", count(food));
    *set.add_parameters() = state("respawn", flag(true));
    set.set_revision(revision);
    return set;
}

evod::v1::Response accepted(const evod::v1::ParameterSet& set) {
    evod::v1::Response response;
    *response.mutable_parameters() = set;
    return response;
}

struct ParameterEditsTest : testing::Test {
    ParameterEditsTest() {
        edits.describe({chance(), describe("food_count", evod::v1::PARAMETER_KIND_COUNT, 0, 20'000'000, count(25)),
                        describe("respawn", evod::v1::PARAMETER_KIND_FLAG, 0, 0, flag(true))});
        edits.update(set_of(7));
    }
    /// Edits the chance, and accepts the change as the next revision.
    void change_chance(double number) {
        edits.edit(mutation_chance, real(number));
        ASSERT_TRUE(edits.apply("w"));
        const auto response = accepted(set_of(edits.revision() + 1, number));
        ASSERT_FALSE(edits.answered(&response));
    }
    ParameterEdits edits;
};

TEST_F(ParameterEditsTest, SendsAllEditsAndTheRevisionInOneTransaction) {
    edits.edit(mutation_chance, real(0.2));
    edits.edit(respawn, flag(false));
    EXPECT_EQ(edits.edit_count(), 2u);
    const auto request = edits.apply("mars");
    ASSERT_TRUE(request && request->has_set_parameters());
    const auto& set = request->set_parameters();
    EXPECT_EQ(set.world(), "mars");
    EXPECT_EQ(set.expected_revision(), 7u);
    ASSERT_EQ(set.parameters_size(), 2);
    EXPECT_EQ(set.parameters(0).name(), "mutation_chance");
    EXPECT_EQ(set.parameters(0).value().real(), 0.2);
    EXPECT_EQ(set.parameters(1).name(), "respawn");
    EXPECT_TRUE(set.parameters(1).value().has_flag());
    EXPECT_FALSE(set.parameters(1).value().flag());
    EXPECT_FALSE(edits.apply("mars")) << "one at a time";
}

TEST_F(ParameterEditsTest, TheCurrentValueIsNotAnEdit) {
    edits.edit(mutation_chance, real(0.2));
    edits.edit(mutation_chance, real(0.15));
    EXPECT_EQ(edits.edit_count(), 0u);
    EXPECT_FALSE(edits.apply("w"));
}

TEST_F(ParameterEditsTest, KeepsEditsMadeWhileWaitingForTheAnswer) {
    edits.edit(mutation_chance, real(0.2));
    edits.edit(food_count, count(30));
    ASSERT_TRUE(edits.apply("w"));
    edits.edit(food_count, count(31));
    const auto response = accepted(set_of(8, 0.2, 30));
    EXPECT_FALSE(edits.answered(&response));
    EXPECT_FALSE(edits.is_edited(mutation_chance));
    EXPECT_EQ(edits.shown(mutation_chance).real(), 0.2);
    ASSERT_TRUE(edits.is_edited(food_count));
    EXPECT_EQ(edits.shown(food_count).count(), 31u);
    EXPECT_EQ(edits.apply("w")->set_parameters().expected_revision(), 8u);
}

TEST_F(ParameterEditsTest, ARefusalMarksTheFieldAndKeepsTheEdits) {
    edits.edit(mutation_chance, real(1.5));
    edits.edit(food_count, count(30));
    ASSERT_TRUE(edits.apply("w"));
    evod::v1::Response refused;
    refused.mutable_status()->set_code(evod::v1::CODE_INVALID_ARGUMENT);
    auto& violation = *refused.mutable_status()->add_violations();
    violation.set_field("set_parameters.mutation_chance");
    violation.set_allowed("0 to 1");
    violation.set_got("1.5");
    EXPECT_TRUE(edits.answered(&refused));
    ASSERT_NE(edits.violation(mutation_chance), nullptr);
    EXPECT_EQ(edits.violation(mutation_chance)->allowed(), "0 to 1");
    EXPECT_EQ(edits.violation(food_count), nullptr);
    EXPECT_NE(edits.problem(), "");
    EXPECT_EQ(edits.edit_count(), 2u);
    edits.edit(mutation_chance, real(0.5));
    EXPECT_EQ(edits.violation(mutation_chance), nullptr) << "it was about the former value";
    ASSERT_TRUE(edits.apply("w"));
    const auto response = accepted(set_of(8, 0.5, 30));
    edits.answered(&response);
    EXPECT_EQ(edits.problem(), "");
}

TEST_F(ParameterEditsTest, TheNextEditOrAnswerClearsARefusal) {
    const auto refuse = [&] { // the violation may be of a parameter that was not edited
        edits.edit(mutation_chance, real(0.9));
        ASSERT_TRUE(edits.apply("w"));
        evod::v1::Response refused;
        refused.mutable_status()->set_code(evod::v1::CODE_INVALID_ARGUMENT);
        refused.mutable_status()->add_violations()->set_field("set_parameters.food_count");
        edits.answered(&refused);
        ASSERT_NE(edits.violation(food_count), nullptr);
        ASSERT_NE(edits.problem(), "");
    };
    const auto expect_no_refusal = [&] {
        EXPECT_EQ(edits.violation(food_count), nullptr);
        EXPECT_EQ(edits.problem(), "");
    };
    refuse();
    edits.edit(mutation_chance, real(0.5));
    expect_no_refusal();
    refuse();
    edits.edit(mutation_chance, edits.requested_value(mutation_chance));
    expect_no_refusal();
    refuse();
    ASSERT_TRUE(edits.apply("w")); // another client has made it valid
    const auto response = accepted(set_of(8, 0.9));
    edits.answered(&response);
    expect_no_refusal();
}

TEST_F(ParameterEditsTest, ReportsAStaleRevisionAndRequestsTheSet) {
    edits.edit(mutation_chance, real(0.2));
    ASSERT_TRUE(edits.apply("w"));
    evod::v1::Response refused;
    refused.mutable_status()->set_code(evod::v1::CODE_FAILED_PRECONDITION);
    refused.mutable_status()->add_violations()->set_field("set_parameters.expected_revision");
    EXPECT_TRUE(edits.answered(&refused));
    EXPECT_THAT(edits.problem(), testing::HasSubstr("Another client changed"));
    edits.update(set_of(9));
    EXPECT_EQ(edits.apply("w")->set_parameters().expected_revision(), 9u);
}

TEST_F(ParameterEditsTest, KeepsTheEditAndRequestsTheSetWithoutAnAnswer) {
    edits.edit(mutation_chance, real(0.2));
    ASSERT_TRUE(edits.apply("w"));
    EXPECT_TRUE(edits.answered(nullptr));
    EXPECT_FALSE(edits.busy());
    EXPECT_TRUE(edits.is_edited(mutation_chance));
    edits.update(set_of(8, 0.2)); // the change was made after all
    EXPECT_FALSE(edits.is_edited(mutation_chance));
}

TEST_F(ParameterEditsTest, ShowsChangesOfOthersAndKeepsEdits) {
    edits.edit(food_count, count(30));
    evod::v1::ParametersChanged changed;
    changed.mutable_by()->set_client("evoctl");
    changed.mutable_by()->set_address("127.0.0.1:9");
    changed.set_revision(8);
    *changed.add_changed() = state("mutation_chance", real(0.3));
    *changed.add_changed() = state("food_count", count(28));
    EXPECT_TRUE(edits.update(changed));
    EXPECT_EQ(edits.shown(mutation_chance).real(), 0.3);
    EXPECT_EQ(edits.client_of_last_change(mutation_chance), "evoctl 127.0.0.1:9");
    EXPECT_EQ(edits.shown(food_count).count(), 30u);
    EXPECT_EQ(edits.requested_value(food_count).count(), 28u);
    EXPECT_EQ(edits.apply("w")->set_parameters().expected_revision(), 8u) << "the revision was received";
}

TEST_F(ParameterEditsTest, RequestsTheSetAfterAMissedChange) {
    evod::v1::ParametersChanged changed;
    changed.set_revision(9);
    *changed.add_changed() = state("mutation_chance", real(0.3));
    EXPECT_FALSE(edits.update(changed));
    changed.set_revision(8); // arrives late
    *changed.mutable_changed(0) = state("mutation_chance", real(0.1));
    EXPECT_TRUE(edits.update(changed));
    EXPECT_EQ(edits.shown(mutation_chance).real(), 0.3);
}

TEST_F(ParameterEditsTest, AnOwnChangeHasNoOtherAuthor) {
    change_chance(0.2);
    evod::v1::ParametersChanged changed;
    changed.mutable_by()->set_client("evoview");
    changed.mutable_by()->set_address("127.0.0.1:9");
    changed.set_revision(8);
    *changed.add_changed() = state("mutation_chance", real(0.2));
    EXPECT_TRUE(edits.update(changed));
    EXPECT_EQ(edits.client_of_last_change(mutation_chance), "");
}

TEST_F(ParameterEditsTest, APendingValueIsTheRequestedOne) {
    auto set = set_of(8);
    *set.mutable_parameters(food_count)->mutable_pending() = count(60);
    edits.update(set);
    EXPECT_TRUE(has_pending(edits));
    EXPECT_EQ(edits.current_value(food_count).count(), 25u);
    EXPECT_EQ(edits.shown(food_count).count(), 60u);
    edits.edit(food_count, count(60));
    EXPECT_EQ(edits.edit_count(), 0u);
    edits.edit(food_count, count(25)); // cancels the edit
    EXPECT_EQ(edits.edit_count(), 1u);
}

TEST_F(ParameterEditsTest, AnotherRunClearsEdits) {
    change_chance(0.2);
    edits.edit(food_count, count(30));
    edits.forget();
    EXPECT_FALSE(edits.known());
    EXPECT_EQ(edits.edit_count(), 0u);
    edits.update(set_of(1)); // revisions start again
    EXPECT_EQ(edits.revision(), 1u);
}

TEST(ParameterGroups, AreTheTopicsOfTheServer) {
    std::vector<ParameterDescription> registry;
    for (const char* topic : {"Experiment", "Crossover", "Crossover", "Migration"}) {
        registry.push_back(describe("one", evod::v1::PARAMETER_KIND_REAL, 0, 1, real(0)));
        registry.back().set_topic(topic);
    }
    std::vector<std::string> groups;
    for (const ParameterGroup& part : group(registry)) {
        groups.push_back(part.title + " " + std::to_string(part.members.size()));
    }
    EXPECT_THAT(groups, ElementsAre("Experiment 1", "Crossover 2", "Migration 1"));
}

TEST(ParameterGroups, TheServerNamesTheMostUsed) {
    std::vector<ParameterDescription> registry;
    for (const bool is_most_used : {true, false, true}) {
        registry.push_back(describe("one", evod::v1::PARAMETER_KIND_REAL, 0, 1, real(0)));
        registry.back().set_is_most_used(is_most_used);
    }
    EXPECT_THAT(most_used(registry).members, ElementsAre(0, 2));
}

TEST(ParameterSearch, MatchesEveryWordOfParameterAndGroup) {
    EXPECT_TRUE(matches(chance(), "Mutation", ""));
    EXPECT_TRUE(matches(chance(), "", "mutation"));
    EXPECT_TRUE(matches(chance(), "", "mutation_chance"));
    EXPECT_TRUE(matches(chance(), "", "CREEP gene"));
    EXPECT_FALSE(matches(chance(), "", "creep crate"));
    EXPECT_TRUE(matches(chance(), "Selection", "selection chance"));
    auto about = describe("selection", evod::v1::PARAMETER_KIND_CHOICE, 0, 0, real(0));
    about.add_choices("stochastic_universal");
    about.add_choice_help("One spin chooses all parents.");
    EXPECT_TRUE(matches(about, "", "stochastic universal"));
    EXPECT_TRUE(matches(about, "", "spin"));
}

TEST(ParameterLabels, AreWordsWithoutTheUnit) {
    const auto label = [](const char* name, const char* unit) {
        auto about = describe(name, evod::v1::PARAMETER_KIND_REAL, 0, 1, real(0));
        about.set_unit(unit);
        return label_of(about);
    };
    EXPECT_EQ(label("mutation_chance", "chance"), "Mutation chance");
    EXPECT_EQ(label("tick_s", "s"), "Tick");
    EXPECT_EQ(label("max_speed_px_s", "px/s"), "Max speed");
    EXPECT_EQ(label("health_loss_per_s", "health/s"), "Health loss per s");
    EXPECT_EQ(label_of_choice("stochastic_universal"), "stochastic universal");
}

TEST(ParameterLabels, AUnitFitsItsNumberAndTheField) {
    auto islands = describe("island_count", evod::v1::PARAMETER_KIND_COUNT, 1, 4096, count(1));
    islands.set_unit("islands");
    EXPECT_EQ(unit_text(islands, 1), " island");
    EXPECT_EQ(unit_text(islands, 2), " islands");
    EXPECT_EQ(unit_text(chance(), 1), " chance");
    islands.set_unit("share per 1/60 s");
    EXPECT_EQ(unit_text(islands, 2), "");
}

TEST(ParameterSliders, AreLogarithmicOverDecades) {
    EXPECT_FALSE(spans_decades(chance()));
    EXPECT_FALSE(spans_decades(describe("a", evod::v1::PARAMETER_KIND_REAL, 1, 2, real(1))));
    EXPECT_TRUE(spans_decades(describe("a", evod::v1::PARAMETER_KIND_REAL, 0.001, 1, real(1))));
    EXPECT_TRUE(spans_decades(describe("a", evod::v1::PARAMETER_KIND_COUNT, 0, 1000, count(1))));
    EXPECT_FALSE(spans_decades(describe("a", evod::v1::PARAMETER_KIND_COUNT, 1, 5, count(1))));
}

TEST(ParameterValues, ACountIsRoundedAndClamped) {
    const auto about = describe("a", evod::v1::PARAMETER_KIND_COUNT, 0, 10, count(0));
    EXPECT_EQ(value_of(about, 2.6).count(), 3u);
    EXPECT_EQ(value_of(about, -4).count(), 0u);
    EXPECT_EQ(value_of(about, 1e12).count(), 4'294'967'295u);
    EXPECT_EQ(value_of(about, 11).count(), 11u) << "the server reports the value out of range";
    EXPECT_EQ(value_of(chance(), 1.5).real(), 1.5);
}

} // namespace
} // namespace evod::viewer
