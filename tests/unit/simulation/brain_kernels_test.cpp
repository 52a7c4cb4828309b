#include "server/simulation/brain_kernels.h"

#include "server/base/elementary.h"
#include "server/base/instructions.h"
#include "server/base/random.h"
#include "server/physics/bodies.h"
#include "server/simulation/living_organisms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

namespace evod::simulation {
namespace {

using base::half_turns;
using evolution::BrainInput;
using physics::distance_px;
using physics::lanes_max;

const std::vector<BrainInput> all_inputs{
    BrainInput::FoodBearing, BrainInput::FoodProximity, BrainInput::PoisonBearing, BrainInput::PoisonProximity,
    BrainInput::Speed,       BrainInput::Health,        BrainInput::WallProximity};

/// Organisms with networks, and the nearest items, as plain columns.
struct Organisms {
    std::size_t count;
    std::vector<std::int32_t> x, y, food_x, food_y, poison_x, poison_y;
    std::vector<float> velocity_x, velocity_y, health, loss, normal_speed, food_radius, poison_radius, heading,
        base_health;
    std::vector<std::uint32_t> id;
    std::vector<float> weights;
    std::vector<float> out_x, out_y;
    std::vector<BrainInput> inputs;
    SteeringRules rules{};

    Organisms(std::size_t organisms, std::vector<BrainInput> wanted, std::uint32_t hidden, bool bias)
        : count{physics::padded(organisms)}, inputs{std::move(wanted)} {
        for (auto* column : {&x, &y, &food_x, &food_y, &poison_x, &poison_y}) {
            column->resize(count);
        }
        for (auto* column : {&velocity_x, &velocity_y, &health, &loss, &normal_speed, &food_radius, &poison_radius,
                             &heading, &base_health, &out_x, &out_y}) {
            column->resize(count);
        }
        id.resize(count);
        const auto input_count = static_cast<std::uint32_t>(inputs.size());
        rules = {.inputs = inputs.data(),
                 .input_count = input_count,
                 .hidden_count = hidden,
                 .weight_count = hidden * (input_count + bias) + 2 * (hidden + bias),
                 .has_bias = bias,
                 .is_kinematic = false,
                 .force_per_unit = 1.5f,
                 .speed_change = 7,
                 .turn = 0.4f,
                 .max_speed = 600,
                 .width = physics::to_units(1000.0),
                 .height = physics::to_units(700.0)};
        weights.resize(count * rules.weight_count);
    }

    float& weight(std::size_t organism, std::size_t w) {
        return weights[(organism / lanes_max * rules.weight_count + w) * lanes_max + organism % lanes_max];
    }
    OrganismColumns columns() {
        return {.x = x.data(),
                .y = y.data(),
                .velocity_x = velocity_x.data(),
                .velocity_y = velocity_y.data(),
                .id = id.data(),
                .health = health.data(),
                .loss_per_tick = loss.data(),
                .normal_speed = normal_speed.data(),
                .food = {nullptr, food_x.data(), food_y.data(), food_radius.data(), 4},
                .poison = {nullptr, poison_x.data(), poison_y.data(), poison_radius.data(), 4}};
    }
    BrainColumns brains() { return {weights.data(), heading.data(), base_health.data()}; }
    void steer() { brain_kernels().steer(columns(), brains(), 0, count, rules, out_x.data(), out_y.data()); }
    void predict() {
        brain_kernels().predict(columns(), brains(), 0, count, rules, out_x.data(), out_y.data(), nullptr);
    }
};

/// A crowd with random values. The last organisms are void, and some genes are 0.
Organisms some_organisms(std::vector<BrainInput> inputs, std::uint32_t hidden, bool bias) {
    Organisms crowd{70, std::move(inputs), hidden, bias};
    base::RandomStream random{base::RandomKey{base::Seed{8}, base::Purpose::ScenarioTest, hidden, bias}, 0};
    const auto number = [&](double least, double most) { return static_cast<float>(random.uniform(least, most)); };
    for (std::size_t i = 0; i < crowd.count; ++i) {
        const bool is_void = i >= 66;
        crowd.id[i] = static_cast<std::uint32_t>(i);
        crowd.x[i] = is_void ? physics::void_position : physics::to_units(random.uniform(5, 995));
        crowd.y[i] = is_void ? physics::void_position : physics::to_units(random.uniform(5, 695));
        const auto put_near = [&](std::int32_t& item, std::int32_t own) {
            item = is_void ? 0 : own + physics::to_units(random.uniform(-90, 90));
        };
        put_near(crowd.food_x[i], crowd.x[i]);
        put_near(crowd.food_y[i], crowd.y[i]);
        put_near(crowd.poison_x[i], crowd.x[i]);
        put_near(crowd.poison_y[i], crowd.y[i]);
        crowd.velocity_x[i] = is_void ? 0 : number(-300, 300);
        crowd.velocity_y[i] = is_void ? 0 : number(-300, 300);
        crowd.health[i] = is_void ? -std::numeric_limits<float>::infinity() : number(-1, 130);
        crowd.loss[i] = 0.1f;
        crowd.normal_speed[i] = number(0, 200);
        crowd.food_radius[i] = i % 11 == 0 ? 0 : number(20, 200);
        crowd.poison_radius[i] = number(20, 200);
        crowd.heading[i] = number(-3.14, 3.14);
        crowd.base_health[i] = i % 13 == 0 ? 0 : number(20, 200);
    }
    crowd.food_x[11] = crowd.x[11]; // food at an organism that perceives 0 px far
    crowd.food_y[11] = crowd.y[11];
    for (float& weight : crowd.weights) {
        weight = number(-4, 4);
    }
    return crowd;
}

/// What one organism does, computed with single numbers.
struct Reference {
    Organisms& of;
    std::size_t i;

    float bearing(std::int32_t x, std::int32_t y, float radius) const {
        const float dx = distance_px(of.x[i], x), dy = distance_px(of.y[i], y);
        const base::Direction way = base::direction_of(of.heading[i]);
        return dx * dx + dy * dy <= radius * radius ? half_turns(dx * way.x + dy * way.y, dy * way.x - dx * way.y) : 0;
    }
    float proximity(std::int32_t x, std::int32_t y, float radius) const {
        const float dx = distance_px(of.x[i], x), dy = distance_px(of.y[i], y), square = dx * dx + dy * dy;
        return square <= radius * radius ? 1 - std::sqrt(square) / std::max(radius, 1e-30f) : 0;
    }
    float wall() const {
        const base::Direction way = base::direction_of(of.heading[i]);
        const auto distance = [](std::int32_t position, float along, std::int32_t size) {
            return distance_px(along < 0 ? 0 : position, along < 0 ? position : size) /
                   std::max(std::abs(along), 1e-6f);
        };
        const float ahead =
            std::min(distance(of.x[i], way.x, of.rules.width), distance(of.y[i], way.y, of.rules.height));
        return std::max(1 - ahead / std::max(of.food_radius[i], 1e-30f), 0.0f);
    }
    float speed() const { return std::sqrt(of.velocity_x[i] * of.velocity_x[i] + of.velocity_y[i] * of.velocity_y[i]); }
    float input(BrainInput which) const {
        switch (which) {
        case BrainInput::FoodBearing:
            return bearing(of.food_x[i], of.food_y[i], of.food_radius[i]);
        case BrainInput::FoodProximity:
            return proximity(of.food_x[i], of.food_y[i], of.food_radius[i]);
        case BrainInput::PoisonBearing:
            return bearing(of.poison_x[i], of.poison_y[i], of.poison_radius[i]);
        case BrainInput::PoisonProximity:
            return proximity(of.poison_x[i], of.poison_y[i], of.poison_radius[i]);
        case BrainInput::Speed:
            return speed() / of.rules.max_speed;
        case BrainInput::Health:
            return std::clamp((of.health[i] - of.loss[i]) / std::max(of.base_health[i], 1e-30f), 0.0f, 1.0f);
        case BrainInput::WallProximity:
            return wall();
        }
        return 0;
    }
    std::vector<float> layer(const std::vector<float>& inputs, std::uint32_t neurons, std::size_t& w) const {
        std::vector<float> activations;
        for (std::uint32_t neuron = 0; neuron < neurons; ++neuron) {
            float sum = 0;
            for (std::size_t k = 0; k < inputs.size(); ++k) {
                const float product = of.weight(i, w++) * inputs[k];
                sum = k == 0 ? product : sum + product;
            }
            activations.push_back(base::tanh(of.rules.has_bias ? sum + of.weight(i, w++) : sum));
        }
        return activations;
    }
    struct Outcome {
        float x, y, heading, health;
    };
    Outcome outcome() const {
        std::vector<float> inputs;
        for (const BrainInput which : of.inputs) {
            inputs.push_back(input(which));
        }
        std::size_t w = 0;
        const std::vector<float> hidden = layer(inputs, of.rules.hidden_count, w), out = layer(hidden, 2, w);
        EXPECT_EQ(w, of.rules.weight_count);
        constexpr float tau = 6.28318530717958647693f;
        const float turned = of.heading[i] + out[1] * of.rules.turn;
        const float heading = turned - static_cast<float>(std::lrint(turned * (1 / tau))) * tau;
        const base::Direction ahead = base::direction_of(heading);
        const float size = of.rules.is_kinematic ? std::clamp(speed() + out[0] * of.rules.speed_change, 0.0f,
                                                              of.rules.max_speed * 0.999999f)
                                                 : out[0] * (of.normal_speed[i] * of.rules.force_per_unit);
        const bool is_void = of.x[i] == physics::void_position;
        return {is_void ? 0 : ahead.x * size, is_void ? 0 : ahead.y * size, heading, of.health[i] - of.loss[i]};
    }
};

class NetworkKernels : public testing::TestWithParam<base::Instructions> {
  protected:
    void SetUp() override {
        if (GetParam() > base::widest_instructions()) {
            GTEST_SKIP();
        }
        base::use_instructions(GetParam());
    }
    void TearDown() override { base::use_instructions(base::default_instructions()); }
};

INSTANTIATE_TEST_SUITE_P(AllInstructions, NetworkKernels,
                         testing::Values(base::Instructions::Baseline, base::Instructions::Avx2,
                                         base::Instructions::Avx512));

TEST_P(NetworkKernels, ComputeWhatSingleNumbersGive) {
    struct Shape {
        std::vector<BrainInput> inputs;
        std::uint32_t hidden;
        bool bias, is_kinematic;
    };
    for (const Shape& shape :
         {Shape{all_inputs, 5, true, false}, Shape{all_inputs, 32, true, true},
          Shape{{BrainInput::FoodBearing}, 5, false, true}, Shape{{BrainInput::WallProximity}, 1, false, false},
          Shape{{all_inputs.begin(), all_inputs.begin() + 4}, 8, true, false}}) {
        Organisms crowd = some_organisms(shape.inputs, shape.hidden, shape.bias);
        crowd.rules.is_kinematic = shape.is_kinematic;
        for (int tick = 0; tick < 3; ++tick) {
            std::vector<Reference::Outcome> expected;
            for (std::size_t i = 0; i < crowd.count; ++i) {
                expected.push_back(Reference{crowd, i}.outcome());
            }
            crowd.steer();
            for (std::size_t i = 0; i < crowd.count; ++i) {
                ASSERT_EQ(crowd.out_x[i], expected[i].x) << i;
                ASSERT_EQ(crowd.out_y[i], expected[i].y) << i;
                ASSERT_EQ(crowd.heading[i], expected[i].heading) << i;
                ASSERT_EQ(crowd.health[i], expected[i].health) << i;
                ASSERT_LE(std::abs(crowd.heading[i]), heading_max) << i;
            }
        }
    }
}

TEST_P(NetworkKernels, HeadingsStayWithinTheirBoundForTheFastestTurn) {
    Organisms crowd = some_organisms(all_inputs, 5, true);
    float greatest = 0;
    for (int step = 1; step <= 2000; ++step) {
        crowd.rules.turn = static_cast<float>(step) * 0.31416f; // up to 36,000 °/s in ticks of 1 s
        crowd.steer();
        for (std::size_t i = 0; i < crowd.count; ++i) {
            greatest = std::max(greatest, std::abs(crowd.heading[i]));
        }
    }
    EXPECT_LE(greatest, heading_max);
}

TEST_P(NetworkKernels, PredictWhatOrganismsDoAndChangeNothing) {
    Organisms crowd = some_organisms({BrainInput::FoodBearing, BrainInput::Speed}, 4, true);
    const std::vector<float> heading = crowd.heading, health = crowd.health;
    crowd.predict();
    EXPECT_EQ(crowd.heading, heading);
    EXPECT_EQ(crowd.health, health);
    const std::vector<float> x = crowd.out_x, y = crowd.out_y;
    crowd.steer();
    EXPECT_EQ(crowd.out_x, x);
    EXPECT_EQ(crowd.out_y, y);
    EXPECT_NE(crowd.heading, heading);
}

TEST_P(NetworkKernels, HashTheHeadingsOfOrganismsThatAreThere) {
    Organisms crowd = some_organisms({BrainInput::Speed}, 1, false);
    base::StateHash expected;
    for (std::size_t i = 0; i < crowd.count; ++i) {
        if (crowd.x[i] != physics::void_position) {
            expected += base::hash_of(
                {heading_hash_kind, crowd.id[i], std::bit_cast<std::uint32_t>(crowd.heading[i]), 0, 0, 0, 0});
        }
    }
    const HashWords sum =
        brain_kernels().hash(crowd.columns(), crowd.heading.data(), heading_hash_kind, 0, crowd.count);
    EXPECT_EQ(sum.low, expected.low);
    EXPECT_EQ(sum.high, expected.high);
}

/// An organism at (500, 300) px that heads along +x, whose only input goes straight to the thrust.
Organisms one_with_input(BrainInput input) {
    Organisms one{1, {input}, 1, false};
    one.x[0] = physics::to_units(500.0);
    one.y[0] = physics::to_units(300.0);
    one.food_radius[0] = one.poison_radius[0] = 100;
    one.food_x[0] = one.poison_x[0] = physics::to_units(900.0);
    one.food_y[0] = one.poison_y[0] = physics::to_units(300.0);
    one.health[0] = 50;
    one.base_health[0] = 100;
    one.normal_speed[0] = 1;
    one.rules.force_per_unit = 1;
    one.weight(0, 0) = one.weight(0, 1) = 1;
    return one;
}

void expect_input(Organisms& one, double value, const char* what) {
    one.predict();
    const base::Direction ahead = base::direction_of(one.heading[0]);
    EXPECT_NEAR(one.out_x[0] * ahead.x + one.out_y[0] * ahead.y, std::tanh(std::tanh(value)), 2e-6) << what;
}

TEST(Senses, BearingsAreRelativeToTheHeading) {
    Organisms one = one_with_input(BrainInput::FoodBearing);
    expect_input(one, 0, "none is seen");
    const auto put_food = [&](double dx, double dy) {
        one.food_x[0] = one.x[0] + physics::to_units(dx);
        one.food_y[0] = one.y[0] + physics::to_units(dy);
    };
    put_food(0, 50);
    expect_input(one, 0.5, "a quarter turn from +x toward +y");
    put_food(-30, -30);
    expect_input(one, -0.75, "behind, on the other side");
    one.heading[0] = static_cast<float>(base::pi / 2);
    expect_input(one, 0.75, "the same food after a quarter turn");
    one.food_radius[0] = 42;
    expect_input(one, 0, "just outside food_radius");
}

TEST(Senses, ProximityFallsFromOneToZeroAtTheRadius) {
    Organisms one = one_with_input(BrainInput::PoisonProximity);
    expect_input(one, 0, "none is seen");
    for (const double distance : {0.0, 25.0, 99.5}) {
        one.poison_x[0] = one.x[0] + physics::to_units(distance);
        expect_input(one, 1 - distance / 100, "at a distance");
    }
}

TEST(Senses, SpeedAndHealthAreShares) {
    Organisms fast = one_with_input(BrainInput::Speed);
    fast.velocity_x[0] = 90;
    fast.velocity_y[0] = -120;
    expect_input(fast, 0.25, "150 of 600 px/s");
    Organisms healthy = one_with_input(BrainInput::Health);
    expect_input(healthy, 0.5, "half the base health");
    healthy.health[0] = 230;
    expect_input(healthy, 1, "more than the base health");
}

TEST(Senses, TheWallAheadIsTheOneInTheDirectionOfTheHeading) {
    Organisms one = one_with_input(BrainInput::WallProximity);
    one.food_radius[0] = 400;
    one.x[0] = physics::to_units(900.0);
    expect_input(one, 1 - 100.0 / 400, "the right wall, 100 px away");
    one.heading[0] = static_cast<float>(base::pi);
    expect_input(one, 0, "the left wall, out of reach");
    one.heading[0] = static_cast<float>(-base::pi / 2);
    expect_input(one, 1 - 300.0 / 400, "the upper wall, 300 px away");
    one.heading[0] = static_cast<float>(base::pi / 4);
    expect_input(one, 1 - 100 * std::sqrt(2) / 400, "the right wall, at an angle");
}

TEST(Steering, KinematicSpeedStaysWithinItsLimits) {
    Organisms one = one_with_input(BrainInput::Health);
    one.rules.is_kinematic = true;
    one.rules.speed_change = 1000;
    one.predict();
    EXPECT_NEAR(one.out_x[0], std::tanh(std::tanh(0.5)) * 1000, 1e-3);
    one.weight(0, 1) = 4;
    one.predict();
    EXPECT_NEAR(one.out_x[0], 600, 1e-3);
    EXPECT_LE(one.out_x[0], 600);
    one.weight(0, 1) = -4;
    one.velocity_x[0] = 100;
    one.predict();
    EXPECT_EQ(one.out_x[0], 0);
}

} // namespace
} // namespace evod::simulation
