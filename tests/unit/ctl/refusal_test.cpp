#include "client/ctl/refusal.h"

#include "proto/command_line/command.h"

#include <gtest/gtest.h>

namespace evod::ctl {
namespace {

v1::Status refused(const std::string& field) {
    v1::Status status;
    status.set_code(v1::CODE_INVALID_ARGUMENT);
    status.set_message(field + ": got 2, allowed 0 to 1");
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

TEST(Refusal, NamesTheOptionInTheLineOfEachViolation) {
    v1::Status status = refused("set_parameters.restitution");
    *status.add_violations() = refused("set_parameters.mutation_chance").violations(0);
    status.set_message("invalid parameter values\n  set_parameters.restitution: got 2, allowed 0 to 1\n"
                       "  set_parameters.mutation_chance: got 2, allowed 0 to 1");
    EXPECT_EQ(refusal_text(status, nullptr), "invalid parameter values\n  restitution: got 2, allowed 0 to 1\n"
                                             "  mutation_chance: got 2, allowed 0 to 1");
}

TEST(Refusal, IsOtherwiseTheMessageOfTheServer) {
    v1::Status status = refused("pause.world");
    status.set_message("no world has that name; did you mean lesson?\n  pause.world: got lessn, allowed lesson");
    EXPECT_EQ(refusal_text(status, nullptr),
              "no world has that name; did you mean lesson?\n  --world: got lessn, allowed lesson");
}

} // namespace
} // namespace evod::ctl
