#include "client/ctl/refusal.h"

#include "proto/command_line/command.h"

#include <gtest/gtest.h>

namespace evod::ctl {
namespace {

v1::Status refused(const std::string& field, v1::Code code = v1::CODE_INVALID_ARGUMENT) {
    v1::Status status;
    status.set_code(code);
    status.set_message("no such thing");
    auto& violation = *status.add_violations();
    violation.set_field(field);
    violation.set_got("2");
    violation.set_allowed("0 to 1");
    return status;
}

TEST(Refusal, NamesTheOptionThatWasTyped) {
    command_line::Command app{"evoctl", "evoctl", "1"};
    std::string text;
    auto& fork = app.add_command("fork", "Forks.");
    fork.add_option("WORLD", &text, "World");
    fork.add_option("--at-generation", &text, "Generation");
    EXPECT_EQ(refusal_text(refused("fork_world.world"), &fork), "WORLD: got 2, allowed 0 to 1");
    EXPECT_EQ(refusal_text(refused("fork_world.at_generation"), &fork), "--at-generation: got 2, allowed 0 to 1");
    EXPECT_EQ(refusal_text(refused("pause.world"), nullptr), "--world: got 2, allowed 0 to 1");
    EXPECT_EQ(refusal_text(refused("set_speed.speed.real_time_factor"), nullptr), "SPEED: got 2, allowed 0 to 1");
    EXPECT_EQ(refusal_text(refused("set_parameters.mutation_chance"), nullptr),
              "mutation_chance: got 2, allowed 0 to 1");
    EXPECT_EQ(refusal_text(refused("create_world.experiment_json.survivors (line 3)"), nullptr),
              "--experiment: survivors (line 3): got 2, allowed 0 to 1");
}

TEST(Refusal, HasALineForEachViolation) {
    v1::Status status = refused("set_parameters.restitution");
    *status.add_violations() = refused("set_parameters.mutation_chance").violations(0);
    EXPECT_EQ(refusal_text(status, nullptr),
              "restitution: got 2, allowed 0 to 1\nmutation_chance: got 2, allowed 0 to 1");
}

TEST(Refusal, SaysWhatWasLookedForInVain) {
    EXPECT_EQ(refusal_text(refused("pause.world", v1::CODE_NOT_FOUND), nullptr),
              "--world: got 2, allowed 0 to 1 (no such thing)");
}

TEST(Refusal, SuggestsNamesForAnUnknownOne) {
    v1::Status status = refused("set_parameters.mutation_chanse");
    status.mutable_violations(0)->set_got("an unknown name");
    EXPECT_EQ(refusal_text(status, nullptr), "mutation_chanse: unknown name, allowed 0 to 1");
    status.mutable_violations(0)->set_allowed("a parameter of the registry; did you mean mutation_chance");
    EXPECT_EQ(refusal_text(status, nullptr), "mutation_chanse: unknown name; did you mean mutation_chance?");
}

} // namespace
} // namespace evod::ctl
