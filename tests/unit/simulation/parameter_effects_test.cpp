// The effects of parameters on worlds: accepted sets have room for all bodies, and each change takes effect when the
// registry says.

#include "server/base/inline_executor.h"
#include "server/simulation/world.h"
#include "tests/unit/parameters/assignments.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <vector>

namespace evod::simulation {
namespace {

RC_GTEST_PROP(EverySetThatIsAccepted, HasRoomForAllBodies, ()) {
    const auto count = [](std::uint32_t max) { return *rc::gen::resize(100, rc::gen::inRange(0u, max)); };
    const auto real = [&](double min, double max) { return min + (max - min) * count(1001) / 1000.0; };
    const double size = real(1, 200);
    const auto parameters =
        parameters::assign({}, std::vector<parameters::Assignment>{{"population_size", 1 + count(80)},
                                                                   {"island_width_px", real(150, 1200)},
                                                                   {"island_height_px", real(150, 1200)},
                                                                   {"body_size_min", 1.0},
                                                                   {"body_size_max", size},
                                                                   {"initial_gene_min", size * 0.9},
                                                                   {"initial_gene_max", size},
                                                                   {"item_radius_px", real(0.5, 20)},
                                                                   {"obstacle_count", count(40)},
                                                                   {"obstacle_size_px", real(5, 60)},
                                                                   {"crate_count", count(40)},
                                                                   {"crate_size_px", real(5, 60)}});
    RC_CLASSIFY(parameters.has_value());
    if (parameters) {
        World{*parameters, base::Seed{count(1000)}}; // aborts if it runs out of room
    }
}

// The moment at which a parameter takes effect.

World small_world() {
    parameters::Parameters p;
    p.generation_s = p.birth_every_s = 0.1;
    return {p, base::Seed{1}};
}

TEST(EveryParameter, TakesEffectWhenTheRegistrySays) {
    base::InlineExecutor executor;
    for (const parameters::ParameterDescription& description : parameters::parameter_registry()) {
        World world = small_world();
        world.advance_tick(executor);
        const parameters::Assignment assignment =
            parameters::other_value(description, world.parameters().requested.values);
        const auto holds = [&] { return description.get(world.parameters().active) == assignment.value; };
        world.request_parameters(*parameters::assign(world.parameters().requested, std::vector{assignment}));
        EXPECT_EQ(description.get(world.parameters().requested.values), assignment.value);
        EXPECT_EQ(holds(), description.effect == base::Effect::NextTick) << description.name;
        if (world.outcome() != evolution::Outcome::Running) {
            continue;
        }
        while (!world.generation_over()) {
            world.advance_tick(executor);
        }
        EXPECT_EQ(holds(), description.effect == base::Effect::NextTick) << description.name;
        if (world.outcome() == evolution::Outcome::Running) {
            world.advance_tick(executor); // the first tick of the next generation
            EXPECT_EQ(holds(), description.effect != base::Effect::Reset) << description.name;
        }
        world = world.restarted(base::Seed{1});
        EXPECT_TRUE(holds()) << description.name;
        EXPECT_TRUE(world.parameters().active == world.parameters().requested.values);
    }
}

TEST(ParameterSet, CountsItsRevisions) {
    World world = small_world();
    EXPECT_EQ(world.parameters().revision, 1u);
    world.request_parameters(*parameters::assign(world.parameters().requested, parameters::one("food_health", 30.0)));
    world.request_parameters(*parameters::assign(world.parameters().requested, parameters::one("food_health", 31.0)));
    EXPECT_EQ(world.parameters().revision, 3u);
}

} // namespace
} // namespace evod::simulation
