#include "client/viewer/panels/brain_diagram.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numeric>

namespace evod::viewer {
namespace {

/// Two inputs, two hidden neurons, one output.
evod::v1::Brain brain(bool has_bias) {
    evod::v1::Brain brain;
    brain.add_input_names("food_bearing");
    brain.add_input_names("speed");
    brain.add_inputs(0.5f);
    brain.add_inputs(-1);
    brain.add_hidden(0.25f);
    brain.add_hidden(-0.75f);
    brain.add_output_names("turn");
    brain.add_outputs(1);
    brain.set_has_bias(has_bias);
    return brain;
}

TEST(BrainDiagram, ConnectsTheLayersInTheOrderOfTheWeights) {
    const auto diagram = brain_diagram(brain(true), std::vector<float>{1, 2, 3, 4, 5, -6, 7, 8, 9}, 300, {80, 60}, 1);
    ASSERT_TRUE(diagram);
    std::vector<std::string> names;
    for (const auto& neuron : diagram->neurons) {
        names.push_back(neuron.name);
    }
    EXPECT_THAT(names, testing::ElementsAre("food_bearing", "speed", "bias", "hidden1", "hidden2", "bias", "turn"));
    const auto weight_of = [&](std::size_t from, std::size_t to) {
        const auto line = std::ranges::find_if(
            diagram->lines, [&](const BrainDiagram::Line& of) { return of.from == from && of.to == to; });
        return line == diagram->lines.end() ? 0.f : line->weight;
    };
    EXPECT_EQ(diagram->lines.size(), 9u);
    EXPECT_EQ(weight_of(0, 3), 1);
    EXPECT_EQ(weight_of(1, 3), 2);
    EXPECT_EQ(weight_of(2, 3), 3) << "its bias";
    EXPECT_EQ(weight_of(1, 4), 5);
    EXPECT_EQ(weight_of(2, 4), -6);
    EXPECT_EQ(weight_of(3, 6), 7);
    EXPECT_EQ(weight_of(5, 6), 9) << "the bias of the output";
    EXPECT_EQ(weight_of(2, 5), 0) << "a bias has no inputs";
    EXPECT_EQ(diagram->lines.back().weight, 9) << "strong lines are drawn above weak ones";
    EXPECT_EQ(diagram->lines.back().strength, 1);
    EXPECT_FLOAT_EQ(diagram->lines.front().strength, 1.f / 9);
}

TEST(BrainDiagram, ShowsTheActivations) {
    const auto diagram = brain_diagram(brain(false), std::vector<float>(6, 0.f), 300, {80, 60}, 1);
    ASSERT_TRUE(diagram);
    ASSERT_EQ(diagram->neurons.size(), 5u);
    EXPECT_EQ(diagram->neurons[1].activation, -1);
    EXPECT_EQ(diagram->neurons[3].activation, -0.75f);
    EXPECT_EQ(diagram->neurons[4].kind, BrainDiagram::Kind::Output);
    EXPECT_EQ(diagram->lines[0].strength, 0) << "all weights are 0";
    EXPECT_EQ(activation_colour(0), (Colour{255, 255, 255}));
    EXPECT_EQ(activation_colour(1), palette::series_orange);
    EXPECT_EQ(activation_colour(-1), palette::series_blue);
    EXPECT_EQ(activation_colour(-2), palette::series_blue);
}

TEST(BrainDiagram, OtherNumbersOfWeightsAreNotDrawn) {
    EXPECT_FALSE(brain_diagram(brain(true), std::vector<float>(6, 0.f), 300, {80, 60}, 1));
    EXPECT_FALSE(brain_diagram(brain(false), std::vector<float>(9, 0.f), 300, {80, 60}, 1));
    EXPECT_FALSE(brain_diagram({}, {}, 300, {80, 60}, 1));
}

TEST(BrainDiagram, ManyNeuronsFitIntoTheHeight) {
    evod::v1::Brain large;
    large.mutable_inputs()->Resize(7, 0);
    large.mutable_hidden()->Resize(32, 0);
    large.mutable_outputs()->Resize(2, 0);
    large.set_has_bias(true);
    const auto diagram = brain_diagram(large, std::vector<float>(32 * 8 + 2 * 33, 1.f), 300, {80, 60}, 2);
    ASSERT_TRUE(diagram);
    EXPECT_LE(diagram->height, 2 * 256);
    for (const auto& a : diagram->neurons) {
        EXPECT_GE(a.y - a.radius, 0);
        EXPECT_LE(a.y + a.radius, diagram->height);
        EXPECT_GE(a.radius, 3 * 2) << "large enough to see its colour";
        for (const auto& b : diagram->neurons) {
            EXPECT_TRUE(&a == &b || a.x != b.x || std::abs(a.y - b.y) >= 2 * a.radius) << "neurons do not overlap";
        }
    }
}

TEST(BrainDiagram, DescribesTheNeuronAtTheMouse) {
    const auto diagram = brain_diagram(brain(false), std::vector<float>{1, -2, 0, 0, 0.5f, 3}, 300, {80, 60}, 1);
    ASSERT_TRUE(diagram);
    const BrainDiagram::Neuron& hidden1 = diagram->neurons[2];
    EXPECT_EQ(neuron_at(*diagram, hidden1.x + 1, hidden1.y - 1), 2u);
    EXPECT_EQ(neuron_at(*diagram, 0, 0), std::nullopt);
    EXPECT_EQ(neuron_text(*diagram, 2), "hidden1: 0.25\nspeed × weight −2.00\nfood_bearing × weight 1.00");
    EXPECT_EQ(neuron_text(*diagram, 0), "food_bearing: 0.50");
    const auto with_bias = brain_diagram(brain(true), std::vector<float>(9, 1.f), 300, {80, 60}, 1);
    EXPECT_EQ(neuron_text(*with_bias, 2), "bias: a constant 1");
}

} // namespace
} // namespace evod::viewer
