// Worlds whose organisms are steered by networks: the state does not depend on threads or instructions, and organisms
// do what is predicted.
#include "server/base/elementary.h"
#include "server/base/inline_executor.h"
#include "server/base/instructions.h"
#include "server/jobs/thread_pool.h"
#include "server/simulation/world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace evod::simulation {
namespace {

parameters::Parameters network(std::string locomotion, std::uint32_t population) {
    return parameters::assign({}, std::vector<parameters::Assignment>{{"controller", std::string{"network"}},
                                                                      {"locomotion", std::move(locomotion)},
                                                                      {"sense_speed", true},
                                                                      {"sense_health", true},
                                                                      {"sense_wall", true},
                                                                      {"brain_hidden", 8u},
                                                                      {"scale_with_population", true},
                                                                      {"population_size", population},
                                                                      {"generation_s", 1.0}})
        .value();
}

class NetworkWorlds : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Locomotion, NetworkWorlds, testing::Values("newtonian", "kinematic"));

TEST_P(NetworkWorlds, AreTheSameOnAnyThreadsAndInstructions) {
    const auto hashes = [&](base::Executor& executor) {
        World world{network(GetParam(), 6000), base::Seed{5}};
        std::vector<base::StateHash> hashes;
        for (int tick = 0; tick < 130; ++tick) { // more than two generations
            world.advance_tick(executor);
            hashes.push_back(world.hash());
        }
        return hashes;
    };
    base::InlineExecutor one;
    const std::vector<base::StateHash> expected = hashes(one);
    for (const std::size_t threads : {2u, 3u, 16u}) {
        jobs::ThreadPool several{threads};
        EXPECT_EQ(hashes(several), expected) << threads;
    }
    for (const std::string_view instructions : base::available_instructions()) {
        base::use_instructions(instructions);
        EXPECT_EQ(hashes(one), expected) << instructions;
    }
    base::use_instructions(base::default_instructions());
}

TEST_P(NetworkWorlds, DoWhatIsPredicted) {
    base::InlineExecutor executor;
    parameters::Parameters parameters = network(GetParam(), 1);
    parameters.food_count = parameters.poison_count = 0; // no item reappears
    parameters.damping = 1;
    World world{parameters, base::Seed{2}};
    const auto organism = [&] {
        const physics::Circles& bodies = world.islands()[0].bodies();
        return std::pair{bodies.velocity_x[0], bodies.velocity_y[0]};
    };
    for (int tick = 0; tick < 20; ++tick) {
        const auto before = organism();
        const Intention intention = world.intentions(world.islands()[0], {0, 1})[0];
        ASSERT_EQ(intention.choice, Choice::Steer);
        const float mass = 1 / world.islands()[0].bodies().inverse_mass[0];
        world.advance_tick(executor);
        const auto after = organism();
        const auto scale = static_cast<float>(parameters.tick_s) / mass;
        EXPECT_NEAR(after.first, before.first + intention.force_x * scale, 1e-3f) << tick;
        EXPECT_NEAR(after.second, before.second + intention.force_y * scale, 1e-3f) << tick;
    }
}

TEST(NetworkWorld, BreedingNeedsNoMemoryForWeights) {
    LivingOrganisms living;
    for (int generation = 0; generation < 2; ++generation) {
        living.clear(3);
        living.resize(5);
        EXPECT_EQ(living.weights.size(), 3 * physics::padded(5));
        living.free_weights();
        EXPECT_EQ(living.weights.capacity(), 0u);
    }
}

TEST_P(NetworkWorlds, TurnAsTheirActivationsSay) {
    base::InlineExecutor executor;
    parameters::Parameters parameters = network(GetParam(), 5);
    parameters.food_count = parameters.poison_count = 0; // no item reappears
    World world{parameters, base::Seed{2}};
    const auto heading = [&] { return world.islands()[0].living().heading[*world.islands()[0].body_of(3)]; };
    const double turn_max = parameters.turn_rate_max_deg_s / 180 * base::pi * parameters.tick_s;
    for (int tick = 0; tick < 20; ++tick) {
        const double before = double{heading()};
        const auto activations = world.activations(world.islands()[0], 3);
        ASSERT_TRUE(activations);
        ASSERT_EQ(activations->inputs.size(), 7u);
        ASSERT_EQ(activations->hidden.size(), 8u);
        ASSERT_EQ(activations->outputs.size(), 2u);
        world.advance_tick(executor);
        const double turned = std::remainder(double{heading()} - before, 2 * base::pi);
        EXPECT_NEAR(turned, double{activations->outputs[1]} * turn_max, 1e-5) << tick;
    }
}

TEST(NetworkWorld, OnlyOrganismsWithANetworkHaveActivations) {
    base::InlineExecutor executor;
    World of_rules{parameters::Parameters{}, base::Seed{2}};
    EXPECT_FALSE(of_rules.activations(of_rules.islands()[0], 0));
    World world{network("newtonian", 5), base::Seed{2}};
    EXPECT_TRUE(world.activations(world.islands()[0], 4));
    EXPECT_FALSE(world.activations(world.islands()[0], 5)) << "there is no such organism";
}

TEST(NetworkWorld, HeadingsArePartOfTheHash) {
    base::InlineExecutor executor;
    parameters::Parameters parameters = network("newtonian", 50);
    World still{parameters, base::Seed{2}};
    parameters.turn_rate_max_deg_s = 0;
    World straight{parameters, base::Seed{2}};
    still.advance_tick(executor);
    straight.advance_tick(executor);
    EXPECT_NE(still.hash(), straight.hash());
    const LivingOrganisms& living = straight.islands()[0].living();
    EXPECT_EQ(living.heading.size(), living.health.size());
    EXPECT_EQ(living.weight_count(), 8u * (7 + 1) + 2 * (8 + 1));
}

TEST(NetworkWorld, KinematicBodiesStartWithRandomSpeeds) {
    const World world{network("kinematic", 6000), base::Seed{3}}, at_rest{network("newtonian", 6000), base::Seed{3}};
    const auto speed_max = static_cast<float>(world.parameters().active.max_speed_px_s);
    const physics::Circles& bodies = world.islands()[0].bodies();
    const LivingOrganisms& living = world.islands()[0].living();
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const float speed = std::hypot(bodies.velocity_x[i], bodies.velocity_y[i]);
        ASSERT_LE(speed, speed_max * 1.00001f);
        ASSERT_NEAR(bodies.velocity_x[i], speed * std::cos(living.heading[i]), speed_max * 1e-5f);
        ASSERT_NEAR(bodies.velocity_y[i], speed * std::sin(living.heading[i]), speed_max * 1e-5f);
        ASSERT_EQ(at_rest.islands()[0].bodies().velocity_x[i], 0) << "forces accelerate newtonian bodies";
        sum += speed / speed_max;
        squares += speed / speed_max * speed / speed_max;
    }
    // Uniform in 0 … 1: mean 1/2, variance 1/12; 5 standard errors (alpha 6e-7, two-sided).
    EXPECT_NEAR(sum / 6000, 1.0 / 2, 5 * std::sqrt(1.0 / 12 / 6000));
    EXPECT_NEAR(squares / 6000, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / 6000));
}

TEST(NetworkWorld, KinematicBodiesPassThroughEachOther) {
    base::InlineExecutor executor;
    World world{network("kinematic", 300), base::Seed{3}};
    for (int tick = 0; tick < 55; ++tick) {
        world.advance_tick(executor);
    }
    EXPECT_EQ(world.islands()[0].motion_report(world.parameters().active).touching_count, 0u);
}

} // namespace
} // namespace evod::simulation
